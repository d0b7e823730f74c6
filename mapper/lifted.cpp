// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/lifted.h"

#include "mapper/isotropic.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <complex>

namespace adit {
namespace {

using Complex = std::complex<double>;
using Sparse = IsotropicForm::Sparse;
using Matrix = Eigen::MatrixXcd;  // (unknowns x rank)

double inner(const Matrix& a, const Matrix& b) {
  return a.cwiseProduct(b.conjugate()).sum().real();
}

/// Riemannian trust regions over free positions and turns of length one (Absil, Baker, Gallivan, 2007).
class Lifted {
 public:
  Lifted(const IsotropicForm& form, Matrix x) : form_(form), x_(std::move(x)) {
    normalise(x_);
    // Q with a little on the turns: close to the second derivative, and positive definite.
    Sparse near = form.Q;
    double sum = 0;
    for (int k = 0; k < form.nodes; ++k) sum += form.Q.coeff(form.turn(k), form.turn(k)).real();
    for (int k = 0; k < form.nodes; ++k) near.coeffRef(form.turn(k), form.turn(k)) += 1e-3 * sum / form.nodes;
    preconditioner_.compute(near);
  }

  const Matrix& x() const { return x_; }

  /// Of the lengths of the turns.
  Eigen::VectorXd multiplier() const { return multiplier(times(x_)).tail(form_.nodes); }

  /// Until the gradient is small or the steps give out.
  void descend(int most_steps) {
    double radius = std::sqrt(static_cast<double>(form_.nodes));
    for (int n = 0; n < most_steps; ++n) {
      const Matrix Qx = times(x_);
      const double value = inner(Qx, x_);
      lambda_ = multiplier(Qx);
      const Matrix gradient = tangent(Qx);
      if (gradient.norm() <= 1e-9 * Qx.norm() + 1e-12 * std::abs(value)) return;
      const Matrix step = solve_model(gradient, radius);
      Matrix next = x_ + step;
      normalise(next);
      const double gain = value - inner(times(next), next);
      const double promised = -2 * inner(gradient, step) - inner(step, second(step));
      const double share = promised > 0 ? gain / promised : -1;
      if (share < 0.25) radius *= 0.25;
      if (share > 0.75) radius = std::min(2 * radius, 100.0 * form_.nodes);
      if (share > 0.05) x_ = std::move(next);
      if (gain < 1e-11 * std::abs(value) && share > 0.05) return;
      if (radius < 1e-10) return;
    }
  }

 private:
  Matrix times(const Matrix& x) const { return form_.Q.selfadjointView<Eigen::Lower>() * x; }

  void normalise(Matrix& x) const {
    for (int k = 0; k < form_.nodes; ++k) x.row(form_.turn(k)).normalize();
  }

  Eigen::VectorXd multiplier(const Matrix& Qx) const {
    Eigen::VectorXd lambda = Eigen::VectorXd::Zero(form_.size());
    for (int k = 0; k < form_.nodes; ++k) {
      const int at = form_.turn(k);
      lambda[at] = Qx.row(at).conjugate().cwiseProduct(x_.row(at)).sum().real();
    }
    return lambda;
  }

  /// The part along the manifold.
  Matrix tangent(Matrix v) const {
    for (int k = 0; k < form_.nodes; ++k) {
      const int at = form_.turn(k);
      v.row(at) -= v.row(at).conjugate().cwiseProduct(x_.row(at)).sum().real() * x_.row(at);
    }
    return v;
  }

  Matrix second(const Matrix& v) const { return tangent(times(v) - lambda_.asDiagonal() * v); }
  Matrix preconditioned(const Matrix& v) const { return tangent(preconditioner_.solve(v)); }

  /// Truncated conjugate gradients for min 2 <g, s> + <s, H s> within the radius (Steihaug).
  Matrix solve_model(const Matrix& gradient, double radius) const {
    Matrix s = Matrix::Zero(gradient.rows(), gradient.cols()), r = gradient, z = preconditioned(r), d = -z;
    double rz = inner(r, z);
    const double first = r.norm();
    for (int n = 0; n < 200; ++n) {
      const Matrix Hd = second(d);
      const double curvature = inner(d, Hd), ss = inner(s, s), sd = inner(s, d), dd = inner(d, d);
      const double alpha = rz / curvature;
      if (curvature <= 0 || ss + 2 * alpha * sd + alpha * alpha * dd >= radius * radius) {
        const double to_edge = (-sd + std::sqrt(sd * sd + dd * (radius * radius - ss))) / dd;
        return s + to_edge * d;
      }
      s += alpha * d;
      r += alpha * Hd;
      if (r.norm() <= first * std::min(0.1, first)) break;
      z = preconditioned(r);
      const double next = inner(r, z);
      d = -z + next / rz * d;
      rz = next;
    }
    return s;
  }

  const IsotropicForm& form_;
  Matrix x_;
  Eigen::VectorXd lambda_;
  Eigen::SimplicialLDLT<Sparse> preconditioner_;
};

}  // namespace

Lift lifted_start(const PoseGraph& graph) {
  const IsotropicForm form = isotropic_form(graph);
  constexpr int rank = 3, most_steps = 200;
  constexpr double golden_rad = 2.399963229728653, push = 0.1;
  Matrix x = Matrix::Zero(form.size(), rank);
  x.col(0) = form.unknowns(graph.node);
  // Out of the plane by a little, each turn its own way: exactly in it a saddle would not be felt.
  for (int k = 0; k < form.nodes; ++k)
    for (int c = 1; c < rank; ++c) x(form.turn(k), c) = std::polar(push, golden_rad * k * (k + c));
  Lifted lifted(form, std::move(x));
  lifted.descend(most_steps);
  const Matrix& found = lifted.x();
  const auto turns = found.bottomRows(form.nodes);
  const Eigen::SelfAdjointEigenSolver<Matrix> axes(turns.adjoint() * turns);
  return {form.poses(found * axes.eigenvectors().col(rank - 1), graph.node[0]), lifted.multiplier()};
}

}  // namespace adit
