// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/pose_graph.h"

#include <Eigen/SparseCore>

#include <complex>
#include <vector>

namespace adit {

/// What the isotropic objective takes of an edge: tau |t_j - t_i - R_i t_ij|^2 + kappa |R_j - R_i R_ij|_F^2, with tau =
/// 2 / trace of the covariance of the translation and kappa = the information of the yaw.
/// Source: Rosen et al., "SE-Sync", IJRR 2019.
struct IsotropicWeight {
  double tau, kappa;
};
IsotropicWeight isotropic_weight(const Relative& edge);

/// The same graph under the isotropic weights. Solved with chordal errors it is the isotropic objective: |R_j - R_i
/// R_ij|_F^2 = 8 sin^2(e / 2) = 2 chord^2.
PoseGraph isotropic_graph(const PoseGraph& graph);

/// The isotropic objective as x^H Q x, positions and turns as complex numbers. Unknowns: positions of nodes 1.. (node 0
/// stands at the origin: only differences count), then the turns of all nodes.
struct IsotropicForm {
  using Sparse = Eigen::SparseMatrix<std::complex<double>>;
  int nodes = 0;
  Sparse Q;  // lower triangle

  int position(int node) const { return node - 1; }  // -1: none
  int turn(int node) const { return nodes - 1 + node; }
  int size() const { return 2 * nodes - 1; }

  /// (size) of poses.
  Eigen::VectorXcd unknowns(const std::vector<Pose2>& node) const;
  /// The poses that they stand for, turns brought to length one, the whole moved so that node 0 stands at X_0.
  std::vector<Pose2> poses(const Eigen::VectorXcd& x, const Pose2& X_0) const;
};
IsotropicForm isotropic_form(const PoseGraph& graph);

}  // namespace adit
