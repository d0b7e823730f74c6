// SPDX-License-Identifier: BSD-3-Clause
#include "eval/consistency.h"

#include <Eigen/Cholesky>

#include <cmath>
#include <limits>
#include <optional>

namespace adit {
namespace {

// Chi squared of 3 and 6 degrees of freedom at 0.95.
constexpr double most_3 = 7.814727903, most_6 = 12.591587244;

Eigen::VectorXd error_of(const Pose& truth, const Pose& estimate, Eigen::Index dimension) {
  const Pose X = truth.inverse() * estimate;
  if (dimension == 3) {
    const Pose2 flat = flatten(X);
    return Vec3(flat.x_m, flat.y_m, flat.yaw_rad);
  }
  const Eigen::AngleAxisd turn(X.linear());
  Eigen::VectorXd e(6);
  e << X.translation(), turn.angle() * turn.axis();
  return e;
}

// e^T C^-1 e, where C is positive definite.
std::optional<double> squared_distance(const Eigen::VectorXd& e, const Eigen::MatrixXd& C) {
  const Eigen::LLT<Eigen::MatrixXd> llt(C);
  if (llt.info() != Eigen::Success || !(C.diagonal().minCoeff() > 0)) return std::nullopt;
  return e.dot(llt.solve(e));
}

}  // namespace

void add_consistency(const MetricList& list, const PathMatch& match, const std::vector<Eigen::MatrixXd>& covariance,
                     const std::string& why) {
  double sum = 0;
  std::int64_t n = 0, inside = 0;
  for (size_t k = 1; k < match.size() && !covariance.empty(); ++k) {
    const Eigen::MatrixXd& C = covariance[match.index[k]];
    const Pose truth = match.X_WB[0].inverse() * match.X_WB[k], estimate = match.X_MB[0].inverse() * match.X_MB[k];
    const auto d = squared_distance(error_of(truth, estimate, C.rows()), C);
    if (!d) continue;
    sum += *d / static_cast<double>(C.rows());
    inside += *d <= (C.rows() == 3 ? most_3 : most_6);
    ++n;
  }
  const double count = n ? static_cast<double>(n) : std::numeric_limits<double>::quiet_NaN();
  const std::string reason = !why.empty()         ? why
                             : covariance.empty() ? "the mapper tells no covariances of its poses"
                                                  : "no covariance is positive definite";
  list.add("anees", sum / count, "ratio", Better::lower, n, reason);
  list.add("inside_95", static_cast<double>(inside) / count, "share", Better::higher, n, reason);
}

}  // namespace adit
