// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/metric_list.h"
#include "eval/path_error.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace adit {

/// Do the covariances that a mapper tells of its poses fit the errors that it makes?
///   anees      mean over the poses of e^T C^-1 e / dimension: 1 is honest, more is overconfident; e is the error of the
///              pose relative to the first one, in its own frame, in the plane (3) or in space (6)
///   inside_95  share of the poses whose error lies in the ellipsoid that should hold 95 % of them
/// Poses whose covariance is 0 or worse say nothing; the first pose is known by definition.
/// @param covariance  (estimate) as base/path_file.h has them, or empty
/// Source: Bar-Shalom, Li, Kirubarajan, Estimation with Applications to Tracking and Navigation, 5.4.2.
void add_consistency(const MetricList& list, const PathMatch& match, const std::vector<Eigen::MatrixXd>& covariance,
                     const std::string& why);

}  // namespace adit
