// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/chain.h"

#include "base/error.h"

namespace adit {
namespace {

constexpr double counted_m =
    0.05;  // a step that counts as way: above a standing laser's jitter, below a driving one's step

std::vector<double> way(const std::vector<Pose2>& X) {
  std::vector<double> along_m(X.size(), 0.0);
  size_t last = 0;
  for (size_t i = 1; i < X.size(); ++i) {
    const double d = (X[i].position() - X[last].position()).norm();
    along_m[i] = along_m[last];
    if (d < counted_m) continue;
    along_m[i] += d;
    last = i;
  }
  return along_m;
}

Relative step_between(const Odometry& odometry, int from, int to, int node) {
  Relative total{node, node, odometry.X_step[from + 1], odometry.information[from + 1]};
  for (int i = from + 2; i <= to; ++i)
    total = compose(total, {node, node, odometry.X_step[i], odometry.information[i]});
  total.j = node + 1;
  return total;
}

}  // namespace

Chain chain_of(const Odometry& odometry, double spacing_m) {
  const int n = static_cast<int>(odometry.X_MB.size());
  ADIT_CHECK(n > 0 && odometry.X_step.size() == odometry.X_MB.size() &&
             odometry.information.size() == odometry.X_MB.size());
  Chain chain{way(odometry.X_MB), {0}, {}};
  for (int i = 1; i < n; ++i)
    if (chain.along_m[i] - chain.along_m[chain.scan.back()] >= spacing_m) chain.scan.push_back(i);
  if (chain.scan.back() != n - 1) chain.scan.push_back(n - 1);
  for (size_t k = 0; k + 1 < chain.scan.size(); ++k)
    chain.step.push_back(step_between(odometry, chain.scan[k], chain.scan[k + 1], static_cast<int>(k)));
  return chain;
}

std::vector<int> node_before(const Chain& chain) {
  std::vector<int> node(chain.along_m.size(), 0);
  for (size_t k = 0; k < chain.scan.size(); ++k) node[chain.scan[k]] = static_cast<int>(k);
  for (size_t i = 1; i < node.size(); ++i) node[i] = std::max(node[i], node[i - 1]);
  return node;
}

Pose2 blend(const Pose2& A, const Pose2& B, double s) {
  return {A.x_m + s * (B.x_m - A.x_m), A.y_m + s * (B.y_m - A.y_m),
          wrap_angle(A.yaw_rad + s * wrap_angle(B.yaw_rad - A.yaw_rad))};
}

namespace {

/// How far along the way scan i lies between two nodes.
double share_of(const Chain& chain, int a, int b, int i) {
  const double length_m = chain.along_m[b] - chain.along_m[a];
  return length_m > 0 ? (chain.along_m[i] - chain.along_m[a]) / length_m : double(i - a) / (b - a);
}

}  // namespace

std::vector<Eigen::Matrix3d> spread_covariances(const Chain& chain, const std::vector<Pose2>& X_MB,
                                                const std::vector<Eigen::Matrix3d>& node) {
  ADIT_CHECK(node.size() == chain.scan.size() && X_MB.size() == chain.along_m.size());
  std::vector<Eigen::Matrix3d> C(X_MB.size(), Eigen::Matrix3d::Zero());
  for (size_t k = 0; k + 1 < node.size(); ++k) {
    const int a = chain.scan[k], b = chain.scan[k + 1];
    for (int i = a + 1; i <= b; ++i) {
      const double s = share_of(chain, a, b, i);
      const Eigen::Matrix3d A = adjoint(X_MB[i].inverse() * X_MB[a]), B = adjoint(X_MB[i].inverse() * X_MB[b]);
      C[i] = (1 - s) * A * node[k] * A.transpose() + s * B * node[k + 1] * B.transpose();
    }
  }
  return C;
}

std::vector<Pose2> spread(const Chain& chain, const std::vector<Pose2>& open_loop, const std::vector<Pose2>& node) {
  ADIT_CHECK(node.size() == chain.scan.size() && open_loop.size() == chain.along_m.size());
  std::vector<Pose2> X(open_loop.size());
  X[0] = node[0];
  for (size_t k = 0; k + 1 < node.size(); ++k) {
    const int a = chain.scan[k], b = chain.scan[k + 1];
    const Pose2 from_a = node[k] * open_loop[a].inverse(), from_b = node[k + 1] * open_loop[b].inverse();
    for (int i = a + 1; i <= b; ++i) {
      const double s = share_of(chain, a, b, i);
      X[i] = i == b ? node[k + 1] : blend(from_a * open_loop[i], from_b * open_loop[i], s);
    }
  }
  return X;
}

}  // namespace adit
