// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/isotropic.h"

#include <Eigen/LU>

#include <initializer_list>
#include <utility>

namespace adit {
namespace {

using Complex = std::complex<double>;

}  // namespace

IsotropicWeight isotropic_weight(const Relative& edge) {
  const Eigen::Matrix2d covariance = edge.information.topLeftCorner<2, 2>().inverse();
  return {2 / covariance.trace(), edge.information(2, 2)};
}

PoseGraph isotropic_graph(const PoseGraph& graph) {
  PoseGraph result{graph.node, graph.edge, {}};
  for (Relative& e : result.edge) {
    const IsotropicWeight w = isotropic_weight(e);
    e.information = Eigen::Vector3d(w.tau, w.tau, 2 * w.kappa).asDiagonal();
  }
  return result;
}

IsotropicForm isotropic_form(const PoseGraph& graph) {
  IsotropicForm form;
  form.nodes = static_cast<int>(graph.node.size());
  std::vector<Eigen::Triplet<Complex>> entries;
  const auto add = [&](std::initializer_list<std::pair<int, Complex>> row, double weight) {
    for (const auto& [k, a] : row)
      for (const auto& [l, b] : row)
        if (k >= l && l >= 0) entries.emplace_back(k, l, weight * std::conj(a) * b);
  };
  for (const Relative& e : graph.edge) {
    const IsotropicWeight w = isotropic_weight(e);
    const Complex way(e.X_ij.x_m, e.X_ij.y_m), turn = std::polar(1.0, e.X_ij.yaw_rad);
    add({{form.position(e.j), 1}, {form.position(e.i), -1}, {form.turn(e.i), -way}}, w.tau);
    add({{form.turn(e.j), 1}, {form.turn(e.i), -turn}}, 2 * w.kappa);
  }
  for (int d = 0; d < form.size(); ++d) entries.emplace_back(d, d, 0);
  form.Q = IsotropicForm::Sparse(form.size(), form.size());
  form.Q.setFromTriplets(entries.begin(), entries.end());
  return form;
}

Eigen::VectorXcd IsotropicForm::unknowns(const std::vector<Pose2>& node) const {
  Eigen::VectorXcd x(size());
  for (int k = 0; k < nodes; ++k) {
    const Pose2& X = node[k];
    if (k > 0) x[position(k)] = Complex(X.x_m - node[0].x_m, X.y_m - node[0].y_m);
    x[turn(k)] = std::polar(1.0, X.yaw_rad);
  }
  return x;
}

std::vector<Pose2> IsotropicForm::poses(const Eigen::VectorXcd& x, const Pose2& X_0) const {
  const Pose2 to_0 = X_0 * Pose2{0, 0, std::arg(x[turn(0)])}.inverse();
  std::vector<Pose2> node(nodes, X_0);
  for (int k = 1; k < nodes; ++k) {
    const Complex t = x[position(k)];
    node[k] = to_0 * Pose2{t.real(), t.imag(), std::arg(x[turn(k)])};
  }
  return node;
}

}  // namespace adit
