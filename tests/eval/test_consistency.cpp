// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "eval/consistency.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

// A path whose poses after the first err by e(k) in their own frame.
template <typename Error>
PathMatch erring(size_t n, const Error& e) {
  PathMatch m;
  for (size_t k = 0; k <= n; ++k) {
    m.index.push_back(k);
    m.stamp_s.push_back(static_cast<double>(k));
    m.along_m.push_back(static_cast<double>(k));
    m.X_WB.push_back(pose_of({static_cast<double>(k), 2, 1}, 0.1 * static_cast<double>(k)));
    m.X_MB.push_back(pose_of({5, 6, 7}, 1) * m.X_WB.back() * (k == 0 ? Pose::Identity() : e(k)));
  }
  m.asked = n + 1;
  return m;
}

Metric found(const PathMatch& match, const std::vector<Eigen::MatrixXd>& C, const std::string& name) {
  std::vector<Metric> all;
  add_consistency(MetricList(all), match, C, "");
  return all.at(name == "anees" ? 0 : 1);
}

std::vector<Eigen::MatrixXd> always(size_t n, const Eigen::VectorXd& variances) {
  return std::vector<Eigen::MatrixXd>(n, variances.asDiagonal().toDenseMatrix());
}

const Vec3 variances(0.04, 0.01, 0.0001);

TEST(Consistency, OneSigmaInEachAxisIsHonest) {
  const PathMatch m = erring(7, [](size_t) { return pose_of({0.2, -0.1, 0}, 0.01); });
  EXPECT_NEAR(found(m, always(8, variances), "anees").value, 1, 1e-9);
  EXPECT_EQ(found(m, always(8, variances), "anees").n, 7);  // the first pose is known by definition
  EXPECT_EQ(found(m, always(8, variances), "inside_95").value, 1);
}

TEST(Consistency, AHalfOfTheTrueSigmaScoresFour) {
  const PathMatch m = erring(7, [](size_t) { return pose_of({0.2, -0.1, 0}, 0.01); });
  EXPECT_NEAR(found(m, always(8, variances / 4), "anees").value, 4, 1e-9);
  EXPECT_EQ(found(m, always(8, variances / 4), "inside_95").value, 0);  // 12 is beyond 7.81
}

TEST(Consistency, InSpaceAllSixCount) {
  Eigen::VectorXd six(6);
  six << 0.01, 0.01, 0.01, 0.01, 0.01, 0.01;
  // 0.1 m up alone: one of six.
  const PathMatch m = erring(3, [](size_t) { return pose_of({0, 0, 0.1}, 0); });
  EXPECT_NEAR(found(m, always(4, six), "anees").value, 1.0 / 6, 1e-9);
  EXPECT_NEAR(found(m, always(4, variances), "anees").value, 0, 1e-12);  // in the plane it is none
}

TEST(Consistency, ErrorsDrawnFromTheCovarianceScoreOne) {
  constexpr size_t n = 4000;
  const PathMatch m = erring(n, [](size_t k) {
    const auto z = [&](std::uint64_t axis) { return normal(5, Draw::test, k, axis); };
    return pose_of({0.2 * z(0), 0.1 * z(1), 0}, 0.01 * z(2));
  });
  // A chi squared of 3 over 3 has variance 2/3: five standard errors; shares of a coin of 0.95 likewise.
  EXPECT_NEAR(found(m, always(n + 1, variances), "anees").value, 1, 5 * std::sqrt(2.0 / 3 / n));
  EXPECT_NEAR(found(m, always(n + 1, variances), "inside_95").value, 0.95, 5 * std::sqrt(0.95 * 0.05 / n));
}

TEST(Consistency, WithoutCovariancesItSaysSo) {
  const PathMatch m = erring(3, [](size_t) { return Pose::Identity(); });
  EXPECT_EQ(found(m, {}, "anees").why, "the mapper tells no covariances of its poses");
  EXPECT_EQ(found(m, always(4, Vec3(0, 0, 0)), "anees").why, "no covariance is positive definite");
}

}  // namespace
}  // namespace adit
