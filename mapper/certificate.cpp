// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/certificate.h"

#include "mapper/graph.h"
#include "mapper/graph_start.h"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <optional>

namespace adit {
namespace {

using Complex = std::complex<double>;
using Sparse = Eigen::SparseMatrix<Complex>;
using Vector = Eigen::VectorXcd;

/// The same graph under the isotropic weights. Solved with chordal errors it is the isotropic objective: |R_j - R_i
/// R_ij|_F^2 = 8 sin^2(e / 2) = 2 chord^2.
PoseGraph isotropic(const PoseGraph& graph) {
  PoseGraph result{graph.node, graph.edge, {}};
  for (Relative& e : result.edge) {
    const IsotropicWeight w = isotropic_weight(e);
    e.information = Eigen::Vector3d(w.tau, w.tau, 2 * w.kappa).asDiagonal();
  }
  return result;
}

/// The objective as x^H Q x. Unknowns: positions of nodes 1.. (node 0 stands at the origin: only differences count),
/// then the turns of all nodes. Lower triangle.
struct Form {
  int nodes = 0;
  Sparse Q;

  int position(int node) const { return node - 1; }  // -1: none
  int turn(int node) const { return nodes - 1 + node; }
  int size() const { return 2 * nodes - 1; }
};

Form form_of(const PoseGraph& graph) {
  Form form;
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
  form.Q = Sparse(form.size(), form.size());
  form.Q.setFromTriplets(entries.begin(), entries.end());
  return form;
}

Vector unknowns_of(const Form& form, const std::vector<Pose2>& node) {
  Vector x(form.size());
  for (int k = 0; k < form.nodes; ++k) {
    const Pose2& X = node[k];
    if (k > 0) x[form.position(k)] = Complex(X.x_m - node[0].x_m, X.y_m - node[0].y_m);
    x[form.turn(k)] = std::polar(1.0, X.yaw_rad);
  }
  return x;
}

Vector times(const Sparse& lower, const Vector& x) {
  return lower.selfadjointView<Eigen::Lower>() * x;
}

/// S + shift on the turns, factored again and again with the same pattern.
class Dual {
 public:
  Dual(const Form& form, const Vector& x) : form_(form), S_(form.Q) {
    const Vector y = times(form.Q, x);
    for (int k = 0; k < form.nodes; ++k) {
      const int at = form.turn(k);
      S_.coeffRef(at, at) -= (std::conj(x[at]) * y[at]).real();
    }
    residual_ = times(S_, x).lpNorm<Eigen::Infinity>();
    factor_.analyzePattern(S_);
  }

  /// How far x is from being stationary.
  double residual() const { return residual_; }

  /// No eigenvalue lies below -shift: all pivots are positive.
  bool positive(double shift) {
    Sparse shifted = S_;
    for (int k = 0; k < form_.nodes; ++k) shifted.coeffRef(form_.turn(k), form_.turn(k)) += shift;
    factor_.factorize(shifted);
    return factor_.info() == Eigen::Success && factor_.vectorD().real().minCoeff() > 0;
  }

  /// The least eigenvalue of S over the turns, by inverse iteration about -shift, which the last call of positive()
  /// was true for.
  double least_eigenvalue() {
    Vector v = Vector::Zero(form_.size());
    constexpr double golden_rad = 2.399963229728653;  // no eigenvector looks like its multiples' squares
    for (int k = 0; k < form_.nodes; ++k) v[form_.turn(k)] = std::polar(1.0, golden_rad * k * k);
    double value = std::numeric_limits<double>::infinity();
    for (int n = 0; n < 500; ++n) {
      const Vector w = factor_.solve(v);
      const auto turns = w.tail(form_.nodes);
      const double next = w.dot(times(S_, w)).real() / turns.squaredNorm();
      const bool settled = std::abs(next - value) <= 1e-10 * std::abs(next);
      value = next;
      if (settled) break;
      v.setZero();
      v.tail(form_.nodes) = turns / turns.norm();
    }
    return value;
  }

 private:
  const Form& form_;
  Sparse S_;
  double residual_ = 0;
  Eigen::SimplicialLDLT<Sparse> factor_;
};

void measure_distance(const PoseGraph& graph, Certificate& c) {
  double squares = 0;
  for (size_t k = 0; k < graph.node.size(); ++k) {
    const Pose2 D = graph.node[k].inverse() * c.node[k];
    squares += D.position().squaredNorm();
    c.distance_max_m = std::max(c.distance_max_m, D.position().norm());
    c.distance_max_rad = std::max(c.distance_max_rad, std::abs(D.yaw_rad));
  }
  c.distance_rms_m = std::sqrt(squares / static_cast<double>(graph.node.size()));
}

}  // namespace

Certificate certify(const PoseGraph& graph) {
  Certificate c;
  c.node = graph.node;
  if (graph.node.size() < 2 || graph.edge.empty()) {
    c.stationary = c.certified = true;
    return c;
  }
  const GraphSolution solution =
      solve(isotropic(graph), {.max_iterations = 200, .tolerance_m = 1e-10, .chordal = true});
  c.node = solution.node;
  const Form form = form_of(graph);
  const Vector given = unknowns_of(form, graph.node), x = unknowns_of(form, c.node);
  c.given_objective = given.dot(times(form.Q, given)).real();
  c.objective = x.dot(times(form.Q, x)).real();
  measure_distance(graph, c);

  Dual dual(form, x);
  double largest = 0;
  for (int k = 0; k < form.size(); ++k) largest = std::max(largest, form.Q.coeff(k, k).real());
  const double n = form.nodes;
  // What rounding leaves of a zero eigenvalue, or a ten-millionth of the value a node: whichever is more.
  c.threshold = std::max(1e-14 * largest, 1e-7 * c.objective / n);
  c.stationary = solution.converged && dual.residual() <= 1e-7 * largest;
  const bool positive = dual.positive(c.threshold);
  double shift = c.threshold;
  while (!dual.positive(shift) && shift < 1e3 * largest) shift *= 4;
  c.smallest_eigenvalue = dual.least_eigenvalue();
  c.certified = positive && c.stationary;
  c.gap_bound = n * shift;
  return c;
}

std::string verdict(const Certificate& c) {
  if (c.certified) return "no poses have a lower value of the isotropic objective, up to gap_bound";
  if (!c.stationary) return "not certified: the isotropic objective was not brought to a stationary point";
  return "not certified: the dual matrix has a negative eigenvalue, so that poses with a lower value may exist";
}

}  // namespace adit
