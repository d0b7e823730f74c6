// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// Measured points in one frame, each with the instant and the laser that measured it. Optional columns may be empty.
struct PointCloud {
  std::vector<Vec3> p;              // (n x 3) metres
  std::vector<double> stamp_s;      // (n) or empty: when the beam left; with the path this gives p in B
  std::vector<std::uint8_t> laser;  // (n) or empty: index in the rig
  std::vector<float> sigma_m = {};  // (n) or empty: 1 sd along the beam

  size_t size() const { return p.size(); }
};

/// Binary little-endian PLY: float x y z, and what there is of double stamp_s, uchar laser, float sigma_m.
void write_points(const std::string& file, const PointCloud& points);
/// Any PLY with x, y, z.
PointCloud read_points(const std::string& file);

}  // namespace adit
