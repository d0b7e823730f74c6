// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/dexels.h"
#include "base/estimate.h"
#include "base/mesh.h"
#include "base/points.h"
#include "base/progress.h"
#include "base/recording.h"

#include <optional>

namespace adit {

struct VolumeSettings {
  double cell_m = 0.075;        // of the columns
  int surface_cells = 2;        // columns along the edge of a voxel of the surface
  int beam_step = 2;            // every beam_step-th beam bounds the void
  double section_m = 0.08;      // least way between two sections
  double section_gap_m = 0.3;   // most way between two sections that are joined
  double jump_m = 0.3;          // ranges of neighbours that differ by more (plus a fifth of the range) are two surfaces
  double close_m = 0.06;        // gaps in height up to this are closed
  double range_m = 20;          // farther echoes bound nothing
  double point_voxel_m = 0.1;   // one point a voxel
  double common_percent = 0.1;  // sd of the volume by carving and path, the same everywhere
  double local_sigma = 0.06;  // sd for a cubic metre of what differs from place to place; grows with the volume's root
  double end_sigma_m3 = 1.5;  // sd of a stretch's volume by where it is said to begin and to end
};
Fields fields(VolumeSettings& s);

/// Points of the upward, downward and forward vertical lasers in M, each from the pose of its own instant, in the order
/// of time; of those in one voxel of point_voxel_m the first seen is kept.
/// @param X_MB  path of the body; scans that it does not cover wholly are left out
/// @param bias_covariance  (lasers x lasers) m^2 of the constant range errors; empty: each within its sheet's band.
///         It and the sheet's noise make sigma_m; the path's error is not in it
PointCloud map_points(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings,
                      const Eigen::MatrixXd& bias_covariance = {});

/// What the fans of the lasers swept.
struct MappedVoid {
  Mesh surface;                     // closed, normals into the rock, labelled by slope; empty without an upward laser
  std::optional<double> volume_m3;  // enclosed by the surface; none without an upward laser
  std::optional<double> volume_sigma_m3;
  Dexels solid;                  // that the surface bounds
  double relative_variance = 0;  // of the volume, by the lasers' constant errors
};

/// The void between consecutive sections, as wedges (laser, two neighbouring echoes) x (two sections), united on
/// columns. Where the four echoes of a wedge lie on two surfaces (a jump in range) it ends at the nearest; a beam
/// without echo or unreadable bounds nothing. Sections more than section_gap_m apart are not joined, while the laser
/// stands still none is added. Gaps up to close_m in height (between the fans) are filled. The forward lasers add what
/// they sweep at crosscut mouths and in turns. Sigma: the lasers' constant errors, as bias_covariance says, times the surface
/// that each of the upward and the downward laser saw; common_percent of the volume; local_sigma times its root. The last
/// two are calibrated over runs (docs/mapper.md): they stand for path, roughness between the beams and columns. What was
/// never seen is not in it.
/// @param bias_covariance  (lasers x lasers) m^2; empty: each within its sheet's band
MappedVoid map_void(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings,
                    const Progress& progress = {}, const Eigen::MatrixXd& bias_covariance = {});

/// The volume by the stretches of a path (mapper/stretches.h): each column goes to the nearest. Sigma as of the whole, and
/// end_sigma_m3 for where a stretch begins and ends. Empty where nothing is mapped.
std::vector<VolumePart> volume_parts(const MappedVoid& mapped, const Trajectory& X_MB, const VolumeSettings& settings);

/// The columns of map_void before its surface is made; empty without an upward laser.
Dexels swept_void(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings,
                  const Progress& progress = {});

}  // namespace adit
