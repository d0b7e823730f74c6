// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/points.h"
#include "base/recording.h"

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// Points of a recording with what each of them is.
struct LabelledCloud {
  PointCloud points;
  std::vector<std::uint8_t> label;  // (n) Label
  std::vector<std::int32_t> part;   // (n) passage or pillar, -1 none
};

/// Every range of a recording as a point in W, each beam from where its laser truly was, in the order of lasers, scans
/// and beams. The ranges are the measured ones: what is off is the laser's error alone.
/// @param every  takes every so many scans of each laser
LabelledCloud true_cloud(const Log& log, const Truth& truth, size_t every = 1);

/// PCD of the Point Cloud Library, version 0.7, binary: float x y z, double stamp_s, uint8 laser, float sigma_m as far as present.
void write_pcd(const std::string& file, const PointCloud& points);
/// PCD, ascii or binary (not binary_compressed), any fields beside x, y, z of 4 or 8 bytes. Errors name file and cause.
PointCloud read_pcd(const std::string& file);

/// Points of any file that adit reads: .pcd, else PLY. A file without points is an Error.
PointCloud read_cloud(const std::string& file);

/// A folder in the layout of SemanticKITTI: velodyne/NNNNNN.bin (float x y z remission) and labels/NNNNNN.label (uint32:
/// label, and part + 1 in the upper 16 bits) for every scan of the horizontal laser, with what all lasers of the rig
/// measured until its next one, in B at that scan; poses.txt (3 x 4 rows of X_WB), times.txt, calib.txt (Tr = identity).
/// @return the number of frames
/// @throws Error where no laser is horizontal
size_t write_kitti(const std::string& dir, const Log& log, const Truth& truth);

}  // namespace adit
