// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/config.h"
#include "base/estimate.h"
#include "base/progress.h"
#include "base/recording.h"

namespace adit {

/// Motion from the scans of one horizontal laser alone.
struct Odometry {
  std::vector<double> stamp_s;                // (n) one per scan
  std::vector<Pose2> X_MB;                    // (n) chained steps, first = identity
  std::vector<Pose2> X_step;                  // (n) X_step[i] = pose of body i in body i-1; [0] unused, identity
  std::vector<Eigen::Matrix3d> information;   // (n) of X_step, about frame B_i: of the error e in X_true = X_step * (ex, ey, eyaw)
  std::vector<DegenerateStretch> degenerate;
};

}  // namespace adit
