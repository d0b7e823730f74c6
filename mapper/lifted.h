// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/pose_graph.h"

#include <vector>

namespace adit {

/// Poses that the isotropic objective has found no way down from any more after turns were let out of the plane: each
/// turn, a complex number of length one, becomes a vector of two, three ... such numbers, where a local optimum of the
/// plane is a saddle that can be left; what is found there is brought back by its main direction. The poses of the graph
/// are where it starts. What comes back is a start for the search in the plane, not an optimum.
/// Source: Boumal, "A Riemannian low-rank method for optimization over semidefinite matrices", 2015; Rosen et al.,
/// "SE-Sync", IJRR 2019 (the staircase).
struct Lift {
  std::vector<Pose2> node;
  Eigen::VectorXd multiplier;  // (node) of the lengths of the turns where it ended: what `certify` can bound with
};
Lift lifted_start(const PoseGraph& graph);

}  // namespace adit
