// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/drawing.h"

#include <string>
#include <vector>

namespace adit {

/// What was measured of a quantity, and what was asked for, where anything was.
struct Histogram {
  std::string name;                   // with its unit
  std::vector<double> value, stated;  // no NaN
};

/// A histogram of each that has values, three beside each other: bars for what was measured, and over them a line at
/// what was stated, or the outline of the stated values' own histogram where they differ.
Drawing histogram_sheet(const std::vector<Histogram>& all, const std::string& title);

}  // namespace adit
