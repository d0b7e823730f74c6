// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/frames.h"

namespace adit {

/// A measured pose of node j in node i. The information is about frame j, of the error e in X_true = X_ij * (ex, ey, eyaw):
/// the convention of g2o's EDGE_SE2.
struct Relative {
  int i = 0, j = 0;
  Pose2 X_ij;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

}  // namespace adit
