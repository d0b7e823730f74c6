// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/picture.h"

#include <optional>
#include <string>

namespace adit {

/// Colours of a quantity. Both kinds are perceptually even and can be told apart by colour-blind people.
/// diverging: blue - light grey - red (Moreland, "Diverging color maps for scientific visualization", ISVC 2009);
/// sequential: pale yellow - orange - dark brown (Harrower and Brewer, "ColorBrewer.org", The Cartographic Journal
/// 2003).
struct Ramp {
  enum class Kind { diverging, sequential };
  Kind kind = Kind::diverging;
  double low = -1, high = 1;  // values of the ends; what lies beyond takes the colour of the end
  std::string quantity;       // "signed error", for the bar
  std::string unit;           // "m"

  Colour colour(double value) const;
  /// The value whose colour is nearest, to 1/512 of the range.
  double value(Colour colour) const;
};

/// The end of a symmetric range that holds most of the values: the q-quantile of |v|, rounded up to 1, 2 or 5 times a
/// power of ten; within [least, most].
double round_range(std::vector<double> values, double q, double least, double most);
/// The greatest of 1, 2, 5 times a power of ten that is <= value (> 0): lengths of scale bars, steps of axes.
double round_down_125(double value);

}  // namespace adit
