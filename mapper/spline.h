// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <array>
#include <vector>

namespace adit {

/// Four neighbouring control points and their weights at one instant.
struct SplineWeights {
  int first;
  std::array<double, 4> weight;
};

/// Time as a cubic B-spline counts it: a knot every knot_s while the vehicle moves, every rest_knot_s while it stands.
class KnotClock {
 public:
  /// @param stamp_s  (n >= 2) rising
  /// @param moving   (n) whether the vehicle moves after the stamp
  KnotClock(std::vector<double> stamp_s, const std::vector<bool>& moving, double knot_s, double rest_knot_s);

  int controls() const { return controls_; }
  /// At a time within the stamps; outside, that of the nearer end.
  SplineWeights at(double t_s) const;

 private:
  std::vector<double> stamp_s_, knot_;  // knots gone by at each stamp
  int controls_;
};

/// Planar poses at any time between their stamps: cubic Hermite in x, y and yaw, slopes from the neighbours.
class PlanarMotion {
 public:
  /// Stamps rising, at least two.
  PlanarMotion(std::vector<double> stamp_s, std::vector<Pose2> pose);

  const std::vector<double>& stamp_s() const { return stamp_s_; }
  Pose2 at(double t_s) const;
  /// Whether the vehicle comes 3 cm or 1 deg away from where it is within half a second of the stamp.
  bool moves(size_t stamp) const;

 private:
  std::vector<double> stamp_s_;
  std::vector<Vec3> value_, slope_;  // x, y, unwrapped yaw, and by time
};

}  // namespace adit
