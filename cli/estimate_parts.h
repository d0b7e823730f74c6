// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "base/recording.h"

#include <string>
#include <vector>

namespace adit {

/// The files of somebody's result; empty: not given.
struct EstimateParts {
  std::string trajectory, stamps, covariance, points, grid, surface;
  double volume_m3 = -1;  // -1: not given
  std::string laser;      // whose path the trajectory is; empty: the body's

  bool any() const;
};

/// The files that a mapper has left in a folder, by name: trajectory.tum (or trajectory.kitti with stamps.txt),
/// path_covariance.txt, points.ply or .pcd, grid.yaml, surface.ply or .obj, volume.txt (m3).
EstimateParts parts_in(const std::string& folder);

/// The estimate that they make. KITTI poses without stamps take those of the mapping laser's scans, if they are as many.
/// @param log  of the recording that was mapped; its rig says where `laser` sits. Null: neither is to be had
Estimate load_parts(const EstimateParts& parts, const Log* log);

}  // namespace adit
