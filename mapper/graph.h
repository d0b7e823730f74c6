// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/pose_graph.h"

#include <Eigen/Core>

#include <span>
#include <utility>
#include <vector>

namespace adit {

/// The matrix that carries a small motion (ex, ey, eyaw) in frame B into frame A: X * e * X^-1, first order.
Eigen::Matrix3d adjoint(const Pose2& X_AB);

/// i to k by way of j: the poses composed, the covariances carried into frame k and added. b.i must be a.j. Both
/// informations must be invertible.
Relative compose(const Relative& a, const Relative& b);

struct GraphSettings {
  int max_iterations = 100;
  double tolerance_m = 1e-9;  // converged when no component of the step is larger (m, rad)
  bool chordal = false;       // the error in yaw is 2 sin(e / 2), the chord of the turn, in place of its angle e
};

struct GraphSolution {
  std::vector<Pose2> node;
  bool converged = false;
  int iterations = 0;
  double chi2 = 0;                  // sum of the squared residuals under the informations, kernels applied
  std::vector<double> edge_chi2;    // (edge) without kernels
  std::vector<double> edge_weight;  // (edge) of the kernel at the solution, 0..1
};

/// Least squares over SE(2) by Levenberg-Marquardt, sparse Cholesky, to full convergence. Robust edges by iterative
/// reweighting: rho(c) = w^2 log(1 + c / w^2) for a squared residual c.
/// Errors: an edge whose nodes do not exist; a part of the graph that hangs on nothing (singular system).
/// Source: Kuemmerle et al., "g2o", ICRA 2011 (error and its derivatives, on the right-hand side of the pose).
GraphSolution solve(const PoseGraph& graph, const GraphSettings& settings = {});

/// Covariance of the pose of node j in node i, about frame j, at the poses of the graph, kernels ignored, for each
/// pair. The cost is one sparse solution of three columns for each node that is named.
std::vector<Eigen::Matrix3d> relative_covariances(const PoseGraph& graph, std::span<const std::pair<int, int>> pairs);

/// Covariance of the pose of every node in that of node 0, about the node's own frame, at the poses of the graph, kernels
/// ignored; zero for node 0. One factorisation and the entries of the inverse that share its pattern, so that the cost
/// grows as the factor does. Source: Takahashi, Fagan, Chin, "Formation of a sparse bus impedance matrix", 1973.
std::vector<Eigen::Matrix3d> covariances(const PoseGraph& graph);

}  // namespace adit
