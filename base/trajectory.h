// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <string>
#include <vector>

namespace adit {

/// Poses over time, stamps strictly increasing.
struct Trajectory {
  std::vector<double> stamp_s;  // (n)
  std::vector<Pose> X_WB;       // (n) or X_MB for an estimate

  size_t size() const { return stamp_s.size(); }
  bool empty() const { return stamp_s.empty(); }
  bool covers(double t_s) const { return !empty() && t_s >= stamp_s.front() && t_s <= stamp_s.back(); }
  /// Pose at any time: position linear, rotation slerp between the neighbours; the end poses outside of the covered
  /// span.
  Pose at(double t_s) const;
  /// Path length over all poses, metres, in space.
  double length_m() const;
};

/// Distance driven up to each pose, metres, first 0. (n)
std::vector<double> distance_along(const Trajectory& path);

/// TUM format, "t x y z qx qy qz qw" a line, '#' comments; of a path in the plane also "t x y yaw". Errors name file and
/// line.
Trajectory read_tum(const std::string& file);
void write_tum(const std::string& file, const Trajectory& path);

}  // namespace adit
