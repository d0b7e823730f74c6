// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/graph.h"

#include "base/error.h"
#include "base/parallel.h"

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <string>

namespace adit {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;
using Sparse = Eigen::SparseMatrix<double>;
using Factor = Eigen::SimplicialLDLT<Sparse>;

Matrix3 turn(double yaw_rad) {
  Matrix3 T = Matrix3::Identity();
  T.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(yaw_rad).toRotationMatrix();
  return T;
}

struct Residual {
  Vector3 e;    // X_ij^-1 X_i^-1 X_j as (x, y, yaw)
  Matrix3 J_i;  // by a small motion of node i in its own frame
  Matrix3 J_j;
};

double turned(double yaw_rad, bool chordal) {
  return chordal ? 2 * std::sin(yaw_rad / 2) : yaw_rad;
}

Vector3 error_of(const Relative& edge, const Pose2& X_i, const Pose2& X_j, bool chordal) {
  const Pose2 E = edge.X_ij.inverse() * (X_i.inverse() * X_j);
  return {E.x_m, E.y_m, turned(E.yaw_rad, chordal)};
}

Residual residual_of(const Relative& edge, const Pose2& X_i, const Pose2& X_j, bool chordal) {
  const Pose2 P = X_i.inverse() * X_j, E = edge.X_ij.inverse() * P;
  Residual r{{E.x_m, E.y_m, turned(E.yaw_rad, chordal)}, Matrix3::Zero(), turn(E.yaw_rad)};
  Matrix3 D = -Matrix3::Identity();
  D(0, 2) = P.y_m;
  D(1, 2) = -P.x_m;
  r.J_i = turn(-edge.X_ij.yaw_rad) * D;
  if (chordal) r.J_i.row(2) *= std::cos(E.yaw_rad / 2), r.J_j.row(2) *= std::cos(E.yaw_rad / 2);
  return r;
}

double kernel_width(const PoseGraph& graph, size_t k) {
  return graph.kernel.empty() ? 0 : graph.kernel[k];
}

double cost_of(const PoseGraph& graph, const std::vector<Pose2>& node, bool chordal) {
  double cost = 0;
  for (size_t k = 0; k < graph.edge.size(); ++k) {
    const Relative& edge = graph.edge[k];
    const Vector3 e = error_of(edge, node[edge.i], node[edge.j], chordal);
    const double c = e.dot(edge.information * e), w = kernel_width(graph, k);
    cost += w > 0 ? w * w * std::log1p(c / (w * w)) : c;
  }
  return cost;
}

void check(const PoseGraph& graph) {
  const int n = static_cast<int>(graph.node.size());
  for (size_t k = 0; k < graph.edge.size(); ++k) {
    const auto [i, j] = std::pair(graph.edge[k].i, graph.edge[k].j);
    if (i < 0 || j < 0 || i >= n || j >= n || i == j)
      throw Error("pose graph: edge " + std::to_string(k) + " joins nodes " + std::to_string(i) + " and " +
                  std::to_string(j) + "; it must join two different ones of the " + std::to_string(n) + " there are");
  }
  ADIT_CHECK(graph.kernel.empty() || graph.kernel.size() == graph.edge.size());
}

/// The normal equations (lower triangle) at the given poses; node 0 has no columns.
struct Normal {
  Sparse A;
  Eigen::VectorXd b;
};

Normal normal_equations(const PoseGraph& graph, const std::vector<Pose2>& node, bool use_kernels, bool chordal) {
  const int n = 3 * (static_cast<int>(node.size()) - 1);
  Normal normal{Sparse(n, n), Eigen::VectorXd::Zero(n)};
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(graph.edge.size() * 24 + n);
  const auto add = [&](int row_node, int column_node, const Matrix3& block) {
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r) {
        const int row = 3 * (row_node - 1) + r, column = 3 * (column_node - 1) + c;
        if (row >= column) entries.emplace_back(row, column, block(r, c));
      }
  };
  for (int d = 0; d < n; ++d) entries.emplace_back(d, d, 0.0);  // the diagonal is there, whatever the edges are
  for (size_t k = 0; k < graph.edge.size(); ++k) {
    const Relative& edge = graph.edge[k];
    const Residual r = residual_of(edge, node[edge.i], node[edge.j], chordal);
    const double w = use_kernels ? kernel_width(graph, k) : 0;
    const double weight = w > 0 ? 1 / (1 + r.e.dot(edge.information * r.e) / (w * w)) : 1;
    const Matrix3 H = weight * edge.information;
    const int i = edge.i, j = edge.j;
    if (i > 0)
      add(i, i, r.J_i.transpose() * H * r.J_i), normal.b.segment<3>(3 * (i - 1)) -= r.J_i.transpose() * (H * r.e);
    if (j > 0)
      add(j, j, r.J_j.transpose() * H * r.J_j), normal.b.segment<3>(3 * (j - 1)) -= r.J_j.transpose() * (H * r.e);
    if (i > 0 && j > i) add(j, i, r.J_j.transpose() * H * r.J_i);
    if (j > 0 && i > j) add(i, j, r.J_i.transpose() * H * r.J_j);
  }
  normal.A.setFromTriplets(entries.begin(), entries.end());
  return normal;
}

std::vector<Pose2> moved(const std::vector<Pose2>& node, const Eigen::VectorXd& step) {
  std::vector<Pose2> result = node;
  for (size_t i = 1; i < node.size(); ++i) {
    const Vector3 d = step.segment<3>(3 * (i - 1));
    result[i] = node[i] * Pose2{d.x(), d.y(), d.z()};
  }
  return result;
}

/// Factor of A with its diagonal raised by (1 + damping); none where it is not positive definite.
bool factorise(Factor& factor, Sparse A, double damping) {
  if (damping > 0)
    for (int d = 0; d < A.rows(); ++d) A.coeffRef(d, d) *= 1 + damping;
  factor.factorize(A);
  return factor.info() == Eigen::Success && factor.vectorD().minCoeff() > 0;
}

void describe(const PoseGraph& graph, bool chordal, GraphSolution& solution) {
  solution.chi2 = cost_of(graph, solution.node, chordal);
  for (size_t k = 0; k < graph.edge.size(); ++k) {
    const Relative& edge = graph.edge[k];
    const Vector3 e = error_of(edge, solution.node[edge.i], solution.node[edge.j], chordal);
    const double c = e.dot(edge.information * e), w = kernel_width(graph, k);
    solution.edge_chi2.push_back(c);
    solution.edge_weight.push_back(w > 0 ? 1 / (1 + c / (w * w)) : 1);
  }
}

/// The entries of A^-1 where the factor L D L^T of A has entries, laid out as L's columns (diagonal left out), and its
/// diagonal; all in the factor's order of unknowns.
struct SelectedInverse {
  std::vector<double> below, diagonal;
};

SelectedInverse selected_inverse(const Factor& factor) {
  const Sparse L = factor.matrixL();
  const Eigen::VectorXd D = factor.vectorD();
  const int n = static_cast<int>(L.cols());
  const auto *start = L.outerIndexPtr(), *row = L.innerIndexPtr();
  const double* value = L.valuePtr();
  SelectedInverse Z{std::vector<double>(L.nonZeros()), std::vector<double>(n)};
  const auto entry = [&](int i, int j) {  // i >= j, within the pattern
    if (i == j) return Z.diagonal[j];
    return Z.below[std::lower_bound(row + start[j], row + start[j + 1], i) - row];
  };
  for (int j = n - 1; j >= 0; --j) {
    const int first = start[j] + (row[start[j]] == j), last = start[j + 1];
    for (int a = first; a < last; ++a) {
      double sum = 0;
      for (int k = first; k < last; ++k) sum -= value[k] * entry(std::max(row[a], row[k]), std::min(row[a], row[k]));
      Z.below[a] = sum;
    }
    double sum = 1 / D[j];
    for (int k = first; k < last; ++k) sum -= value[k] * Z.below[k];
    Z.diagonal[j] = sum;
  }
  return Z;
}

[[noreturn]] void singular() {
  throw Error(
      "pose graph: the system is singular; every node must be joined to node 0 by edges with positive definite "
      "information");
}

}  // namespace

Matrix3 adjoint(const Pose2& X_AB) {
  Matrix3 A = turn(X_AB.yaw_rad);
  A(0, 2) = X_AB.y_m;
  A(1, 2) = -X_AB.x_m;
  return A;
}

Relative compose(const Relative& a, const Relative& b) {
  ADIT_CHECK(a.j == b.i);
  const Matrix3 A = adjoint(b.X_ij.inverse());
  const Matrix3 covariance = A * a.information.inverse() * A.transpose() + b.information.inverse();
  Relative c{a.i, b.j, a.X_ij * b.X_ij, covariance.inverse()};
  c.information = (0.5 * (c.information + c.information.transpose())).eval();
  return c;
}

GraphSolution solve(const PoseGraph& graph, const GraphSettings& settings) {
  check(graph);
  GraphSolution solution{graph.node, false, 0, 0, {}, {}};
  if (graph.node.size() < 2) {
    solution.converged = true;
    return solution;
  }
  double cost = cost_of(graph, solution.node, settings.chordal), damping = 0;
  Factor factor;
  while (solution.iterations < settings.max_iterations && !solution.converged) {
    const Normal normal = normal_equations(graph, solution.node, true, settings.chordal);
    if (solution.iterations == 0) factor.analyzePattern(normal.A);
    ++solution.iterations;
    // Gauss-Newton as long as it descends; else shorter and shorter steps down the gradient.
    for (bool accepted = false; !accepted && !solution.converged;) {
      if (!factorise(factor, normal.A, damping)) singular();
      const Eigen::VectorXd step = factor.solve(normal.b);
      const std::vector<Pose2> next = moved(solution.node, step);
      const double next_cost = cost_of(graph, next, settings.chordal);
      if (!std::isfinite(next_cost)) singular();
      accepted = next_cost <= cost;
      solution.converged = step.cwiseAbs().maxCoeff() < settings.tolerance_m || damping > 1e12;
      if (accepted) {
        solution.node = next;
        cost = next_cost;
        damping = damping < 1e-6 ? 0 : damping / 10;
      } else {
        damping = std::max(10 * damping, 1e-4);
      }
    }
  }
  describe(graph, settings.chordal, solution);
  return solution;
}

std::vector<Matrix3> covariances(const PoseGraph& graph) {
  check(graph);
  std::vector<Matrix3> result(graph.node.size(), Matrix3::Zero());
  if (graph.node.size() < 2) return result;
  const Normal normal = normal_equations(graph, graph.node, false, false);
  Factor factor;
  factor.analyzePattern(normal.A);
  if (!factorise(factor, normal.A, 0)) singular();
  const SelectedInverse Z = selected_inverse(factor);
  const Sparse L = factor.matrixL();
  const auto *start = L.outerIndexPtr(), *row = L.innerIndexPtr();
  const auto& order = factor.permutationP().indices();  // of an unknown in the factor
  for (size_t k = 1; k < result.size(); ++k)
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c <= r; ++c) {
        const int a = order[3 * (k - 1) + r], b = order[3 * (k - 1) + c], i = std::max(a, b), j = std::min(a, b);
        const double z =
            i == j ? Z.diagonal[i] : Z.below[std::lower_bound(row + start[j], row + start[j + 1], i) - row];
        result[k](r, c) = result[k](c, r) = z;
      }
  return result;
}

std::vector<Matrix3> relative_covariances(const PoseGraph& graph, std::span<const std::pair<int, int>> pairs) {
  check(graph);
  std::vector<Matrix3> result(pairs.size(), Matrix3::Zero());
  if (graph.node.size() < 2) return result;
  const Normal normal = normal_equations(graph, graph.node, false, false);
  Factor factor;
  factor.analyzePattern(normal.A);
  if (!factorise(factor, normal.A, 0)) singular();

  std::vector<int> named;  // nodes whose columns of the inverse are needed
  for (const auto& [i, j] : pairs) named.insert(named.end(), {i, j});
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  std::vector<int> slot(graph.node.size(), -1);
  for (size_t k = 0; k < named.size(); ++k) slot[named[k]] = static_cast<int>(k);
  std::vector<std::vector<size_t>> asked(named.size());  // pairs by their first node
  std::vector<Matrix3> own(named.size(), Matrix3::Zero()), cross(pairs.size(), Matrix3::Zero());
  for (size_t k = 0; k < pairs.size(); ++k) asked[slot[pairs[k].first]].push_back(k);
  parallel_for(named.size(), [&](size_t k) {
    if (named[k] == 0) return;
    Eigen::MatrixXd unit = Eigen::MatrixXd::Zero(normal.A.rows(), 3);
    unit.block<3, 3>(3 * (named[k] - 1), 0).setIdentity();
    const Eigen::MatrixXd column = factor.solve(unit);
    own[k] = column.block<3, 3>(3 * (named[k] - 1), 0);
    for (size_t pair : asked[k]) {
      const int j = pairs[pair].second;
      if (j > 0) cross[pair] = column.block<3, 3>(3 * (j - 1), 0);  // cov(j, i)
    }
  });
  for (size_t k = 0; k < pairs.size(); ++k) {
    const auto [i, j] = pairs[k];
    // The error of X_ij about frame j is e_j - Ad(X_ji) e_i.
    const Matrix3 A = adjoint(graph.node[j].inverse() * graph.node[i]);
    const Matrix3 mixed = cross[k] * A.transpose();
    result[k] = own[slot[j]] + A * own[slot[i]] * A.transpose() - mixed - mixed.transpose();
  }
  return result;
}

}  // namespace adit
