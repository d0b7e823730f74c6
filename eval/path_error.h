// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/trajectory.h"
#include "eval/metric_list.h"

#include <string>
#include <vector>

namespace adit {

/// Poses of an estimate and the true ones at the same instants.
struct PathMatch {
  std::vector<size_t> index;     // (n) of the pose in the estimate
  std::vector<double> stamp_s;   // (n)
  std::vector<double> along_m;   // (n) true distance driven until then
  std::vector<Pose> X_WB, X_MB;  // (n) truth, estimate
  size_t asked = 0;              // poses that the estimate has
  double widest_s = 0;           // gap that was interpolated, or difference of stamps

  size_t size() const { return index.size(); }
  double share() const { return asked ? static_cast<double>(size()) / static_cast<double>(asked) : 0; }
};

/// The truth interpolated at the estimate's stamps (position linear, rotation slerp). Stamps outside of the truth, or
/// in a gap of it wider than max_gap_s, have no match.
/// @param X_BN  pose of the judged body frame in the true one (the nominal mount's; identity where mounts are exact)
PathMatch associate(const Trajectory& truth, const Trajectory& estimate, const Pose& X_BN, double max_gap_s);

/// The truth's pose that is nearest in time, within max_diff_s; a pose of the truth goes to the nearest of those that ask
/// for it. A truth with fewer poses than the estimate asks for as many as it has.
PathMatch associate_nearest(const Trajectory& truth, const Trajectory& estimate, double max_diff_s);

/// How M is laid on W.
struct Alignment {
  Pose X_WM = Pose::Identity();
  std::string how;  // with the degrees of freedom that it takes away
  std::string warning;
};

/// By the first matched pose alone.
Alignment align_first_pose(const PathMatch& match);
/// Least squares over the positions, rotation and translation, no scale (Umeyama, PAMI 13(4), 1991). A path that leaves
/// its straight line by less than 0.5 m rms fixes no turn about it: then by the mean of position and of orientation,
/// and a warning.
Alignment align_se3(const PathMatch& match);
/// Least squares over the positions, turned about the vertical alone: M's z must be known to be W's.
Alignment align_yaw_xyz(const PathMatch& match);
/// By the mean of position and of orientation (the matrix nearest to the sum of the relative rotations).
Pose align_mean_pose(const PathMatch& match, size_t begin, size_t end);

/// Errors of each matched pose after an alignment.
std::vector<PoseError> pose_errors(const PathMatch& match, const Pose& X_WM);
/// ate_rmse_m, ate_xy_rmse_m, ate_z_rmse_m, ate_mean_m, ate_median_m, ate_p95_m, ate_max_m, yaw_ / pitch_ /
/// roll_rmse_deg.
void add_ate(const MetricList& list, const std::vector<PoseError>& errors, const std::string& why);

/// rpe_<d>m_m, rpe_<d>m_percent, rpe_<d>m_deg_per_m for each distance: over all pairs (i, first j at least d farther
/// along the true path), the error of the relative pose: rmse in m, mean over true distance in percent, mean angle in
/// degrees per metre.
void add_rpe(const MetricList& list, const PathMatch& match, const std::vector<double>& distances_m,
             const std::string& why);
/// length_ratio, length_error_percent, length_ratio_worst_50m: estimated over true length of the chords between poses
/// at least 1 m apart along the true path, so that noise of poses close together does not count as way.
void add_length(const MetricList& list, const PathMatch& match, const std::string& why);

}  // namespace adit
