// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/certificate.h"

#include "mapper/graph.h"
#include "mapper/isotropic.h"

#include <Eigen/SparseCholesky>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>

namespace adit {
namespace {

using Sparse = IsotropicForm::Sparse;
using Vector = Eigen::VectorXcd;

Vector times(const Sparse& lower, const Vector& x) {
  return lower.selfadjointView<Eigen::Lower>() * x;
}

/// S + shift on the turns, factored again and again with the same pattern.
class Dual {
 public:
  /// @param multiplier  (node) Lambda
  Dual(const IsotropicForm& form, const Eigen::VectorXd& multiplier)
      : form_(form), S_(form.Q), value_(multiplier.sum()) {
    for (int k = 0; k < form.nodes; ++k) S_.coeffRef(form.turn(k), form.turn(k)) -= multiplier[k];
    factor_.analyzePattern(S_);
  }

  /// How far x is from being stationary.
  double residual(const Vector& x) const { return times(S_, x).lpNorm<Eigen::Infinity>(); }

  /// The least shift, by factors of 4 from `first` up to `most`, that leaves no negative eigenvalue.
  double least_shift(double first, double most) {
    double shift = first;
    while (!positive(shift) && shift < most) shift *= 4;
    return shift;
  }

  /// No poses have a lower value, where positive(shift).
  double bound(double shift) const { return value_ - form_.nodes * shift; }

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
  const IsotropicForm& form_;
  Sparse S_;
  double value_;
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

Certificate certify(const PoseGraph& graph, const Eigen::VectorXd& multiplier) {
  Certificate c;
  c.node = graph.node;
  if (graph.node.size() < 2 || graph.edge.empty()) {
    c.stationary = c.certified = true;
    return c;
  }
  const GraphSolution solution =
      solve(isotropic_graph(graph), {.max_iterations = 200, .tolerance_m = 1e-10, .chordal = true});
  c.node = solution.node;
  const IsotropicForm form = isotropic_form(graph);
  const Vector given = form.unknowns(graph.node), x = form.unknowns(c.node);
  c.given_objective = given.dot(times(form.Q, given)).real();
  c.objective = x.dot(times(form.Q, x)).real();
  measure_distance(graph, c);

  const Vector y = times(form.Q, x);
  Eigen::VectorXd own(form.nodes);
  for (int k = 0; k < form.nodes; ++k) own[k] = (std::conj(x[form.turn(k)]) * y[form.turn(k)]).real();
  Dual dual(form, own);
  double largest = 0;
  for (int k = 0; k < form.size(); ++k) largest = std::max(largest, form.Q.coeff(k, k).real());
  // What rounding leaves of a zero eigenvalue, or a ten-millionth of the value a node: whichever is more.
  c.threshold = std::max(1e-14 * largest, 1e-7 * c.objective / form.nodes);
  c.stationary = solution.converged && dual.residual(x) <= 1e-7 * largest;
  const double shift = dual.least_shift(c.threshold, 1e3 * largest);
  c.smallest_eigenvalue = dual.least_eigenvalue();
  c.certified = shift == c.threshold && c.stationary;
  c.gap_bound = c.objective - dual.bound(shift);
  if (multiplier.size() > 0 && !c.certified) {
    Dual lifted(form, multiplier);
    c.gap_bound = std::min(c.gap_bound, c.objective - lifted.bound(lifted.least_shift(c.threshold, 1e3 * largest)));
  }
  return c;
}

std::string verdict(const Certificate& c) {
  if (c.certified) return "certified: no poses have a lower one";
  if (!c.stationary) return "not certified: it was not brought to a stationary point";
  return fmt::format("not certified: other poses may have a lower one, by {:.3g} % at most",
                     100 * c.gap_bound / std::max(c.objective, std::numeric_limits<double>::min()));
}

}  // namespace adit
