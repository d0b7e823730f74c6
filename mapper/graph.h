// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <Eigen/Core>

#include <span>
#include <utility>
#include <vector>

namespace adit {

/// A measured pose of node j in node i. The information is about frame j, of the error e in X_true = X_ij * (ex, ey,
/// eyaw): the convention of g2o's EDGE_SE2.
struct Relative {
  int i = 0, j = 0;
  Pose2 X_ij;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

/// The matrix that carries a small motion (ex, ey, eyaw) in frame B into frame A: X * e * X^-1, first order.
Eigen::Matrix3d adjoint(const Pose2& X_AB);

/// i to k by way of j: the poses composed, the covariances carried into frame k and added. b.i must be a.j. Both
/// informations must be invertible.
Relative compose(const Relative& a, const Relative& b);

/// Poses to be found and what was measured between them. Node 0 stays where it is.
struct PoseGraph {
  std::vector<Pose2> node;  // start values
  std::vector<Relative> edge;
  std::vector<double> kernel;  // (edge) or empty: width of the Cauchy kernel in standard deviations; 0 = quadratic
};

struct GraphSettings {
  int max_iterations = 100;
  double tolerance_m = 1e-9;  // converged when no component of the step is larger (m, rad)
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

}  // namespace adit
