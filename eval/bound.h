// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/metric_list.h"
#include "eval/path_error.h"
#include "eval/true_scans.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace adit {

/// What one noisy scan tells of the pose of its laser in a mine that is known: the information (inverse covariance) of x,
/// y in S's plane and the turn about S's z.
///   I = sum over the beams of g g^T / sigma^2,   g = -(n_x, n_y, r (n . (z x d))) / (n . d)
/// with n the normal of the face met, d the beam, r its range, all in S; sigma the laser's stated noise and the rounding
/// of its range.
/// Source: Censi, On achievable accuracy for range-finder localization, ICRA 2007, Eq. (6).
struct ScanInformation {
  Eigen::Matrix3d I = Eigen::Matrix3d::Zero();
  double roughness_m = 0;  // median distance of what a beam met from the line between its neighbours' ends, along it
  int beams = 0;
};
/// What a scan tells of its laser's position in plan where the heading has to be found too: standard deviations along the
/// directions that it tells least and most of. +inf: it leaves that direction open.
struct PositionBound {
  double least_m, most_m;
};
PositionBound position_bound(const ScanInformation& scan);
ScanInformation information_of(const TrueScans& scans, const Mesh& mesh, size_t laser, size_t scan);

/// The Cramer-Rao bound of the relative pose of consecutive scans of the mapping laser (twice the covariance of the
/// known-map bound: sqrt 2 in the deviation), and what the front end reached:
///   <all|smooth|rough>.<along|across|yaw>.bound_<unit>, measured_<unit> (rms over the pairs), relative_efficiency = bound / measured;
///   relative_efficiency of all three axes: their geometric mean.
/// Along and across are the body's x and y. A pair is smooth when what its first scan met leaves the straight line by less
/// than the laser's noise. Pairs whose scans leave a direction open are not counted.
/// @param open_loop  (estimate) poses of scan matching alone
/// @param X_BS       of the mapping laser in the body that the path is of
void add_bound(const MetricList& list, const TrueScans& scans, const Mesh& mesh, int laser, const Pose& X_BS,
               const PathMatch& match, const std::vector<Pose2>& open_loop, const std::string& why);

}  // namespace adit
