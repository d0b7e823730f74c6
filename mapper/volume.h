// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/dexels.h"
#include "base/mesh.h"
#include "base/points.h"
#include "base/progress.h"
#include "base/recording.h"

#include <optional>

namespace adit {

struct VolumeSettings {
  double cell_m = 0.075;       // of the columns
  int surface_cells = 2;       // columns along the edge of a voxel of the surface
  int beam_step = 2;           // every beam_step-th beam bounds the void
  double section_m = 0.08;     // least way between two sections
  double section_gap_m = 0.3;  // most way between two sections that are joined
  double jump_m = 0.3;         // ranges of neighbours that differ by more (plus a fifth of the range) are two surfaces
  double close_m = 0.06;       // gaps in height up to this are closed
  double range_m = 20;         // farther echoes bound nothing
  double point_voxel_m = 0.1;  // one point a voxel
};
Fields fields(VolumeSettings& s);

/// Points of the upward, downward and forward vertical lasers in M, each from the pose of its own instant, in the order
/// of time; of those in one voxel of point_voxel_m the first seen is kept.
/// @param X_MB  path of the body; scans that it does not cover wholly are left out
PointCloud map_points(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings);

/// What the fans of the lasers swept.
struct MappedVoid {
  Mesh surface;                     // closed, normals into the rock, labelled by slope; empty without an upward laser
  std::optional<double> volume_m3;  // none without an upward laser
  std::optional<double> volume_sigma_m3;  // from the stated systematic range error, see map_void
};

/// The void between consecutive sections, as wedges (laser, two neighbouring echoes) x (two sections), united on
/// columns. Where the four echoes of a wedge lie on two surfaces (a jump in range) it ends at the nearest; a beam
/// without echo or unreadable bounds nothing. Sections more than section_gap_m apart are not joined, while the laser
/// stands still none is added. Gaps up to close_m in height (between the fans) are filled. The forward lasers add what
/// they sweep at crosscut mouths and in turns. Sigma: the constant error of the upward and the downward laser, half width
/// bias_m taken as uniform, times the surface that each saw; 0.1 % of the volume for the columns. The error of the path is
/// not in it.
MappedVoid map_void(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings,
                    const Progress& progress = {});

/// The columns of map_void before its surface is made; empty without an upward laser.
Dexels swept_void(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings,
                  const Progress& progress = {});

}  // namespace adit
