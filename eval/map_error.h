// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/points.h"
#include "base/rig.h"
#include "base/trajectory.h"
#include "eval/metric_list.h"
#include "eval/observable.h"
#include "eval/path_error.h"
#include "eval/volume_error.h"
#include "rays/caster.h"
#include "rays/face_grid.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// The points of a map in M with what laying them on W needs.
struct MapPoints {
  std::vector<Vec3> p_M;        // (n)
  std::vector<Vec3> seen_M;     // (n) unit direction of the beam, or empty where the map does not tell
  std::vector<double> stamp_s;  // (n) or empty
  std::vector<float>
      weight;  // (n) 1 / points in the same cube of patch_m of M: so a dense place counts no more than a thin one

  size_t size() const { return p_M.size(); }
};

/// Beams are looked up by the points' stamps and lasers: they leave from the estimated pose at that instant.
MapPoints map_points(const PointCloud& points, const Trajectory& path_M, const Rig& nominal, double patch_m);

/// Where each point of a map lies with respect to the true surface.
struct LaidPoints {
  std::vector<float>
      error_m;  // (n) signed distance to the nearest face as seen along the beam, + into the void; NaN: no point
  std::vector<std::int32_t> face;     // (n) that face, -1 for none
  std::vector<std::uint32_t> patch;   // (n) where on it
  std::vector<std::uint8_t> phantom;  // (n) 1: in void that a noise-free fan crossed
  std::vector<Vec3> foot_W;           // (n) nearest point of the surface
};

/// A true surface that points are laid on: a grid for those that lie close to it, and for the others a caster, which is made
/// where it is needed and not there.
struct Surface {
  const Mesh& mesh;
  FaceGrid grid;
  std::optional<Caster> caster;

  /// The mesh must outlive it.
  explicit Surface(const Mesh& of) : mesh(of), grid(of) {}
};

/// @param X_WM  of point i
LaidPoints lay(const MapPoints& points, const std::function<const Pose&(size_t)>& X_WM, const Surface& surface,
               const Patches& patches, const VolumeDomain* domain);

/// bias_m, mae_m, rmse_m, p50_m, p95_m, p99_m, within_2cm / 5 / 10 / 20; precision_, recall_, f_ at thresholds;
/// phantom_share, unobserved_share; by_label.<label>. the first ten and recall.
/// A point farther than the threshold from the surface is wrong where its nearest patch was observable or where it lies
/// in void that a fan crossed; elsewhere it is neither right nor wrong. A patch that was observable is recalled when a
/// point within the threshold of the surface has its foot on it.
void add_map(const MetricList& list, const MapPoints& points, const LaidPoints& laid, const Mesh& mesh,
             const Patches& patches, const Observable& observable, const ScoreSettings& settings,
             const std::string& why);

/// The transform of each window of window_m of the true path: mean position and orientation of its poses.
struct Windows {
  std::vector<double> from_s;  // (windows) stamp of the first pose
  std::vector<Pose> X_WM;      // (windows)

  const Pose& at(double stamp_s) const;
};
Windows windows_of(const PathMatch& match, double window_m);

}  // namespace adit
