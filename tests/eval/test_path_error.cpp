// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "eval/path_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi, deg = pi / 180;

// 100 m along x, then 100 m along y, a pose every 0.5 m and 0.5 s.
Trajectory corner_path() {
  Trajectory path;
  for (int i = 0; i <= 400; ++i) {
    const double s = 0.5 * i;
    path.stamp_s.push_back(s);
    path.X_WB.push_back(s <= 100 ? pose_of({s, 0, 0}, 0) : pose_of({100, s - 100, 0}, pi / 2));
  }
  return path;
}

template <typename Change>
Trajectory changed(Trajectory path, const Change& change) {
  for (size_t i = 0; i < path.size(); ++i) path.X_WB[i] = change(i, path.X_WB[i]);
  return path;
}

struct Said {
  std::vector<Metric> metrics;
  double operator()(const std::string& name) const {
    for (const Metric& m : metrics)
      if (m.name == name) return m.value;
    ADD_FAILURE() << "no metric " << name;
    return NAN;
  }
  std::int64_t n(const std::string& name) const {
    for (const Metric& m : metrics)
      if (m.name == name) return m.n;
    return -1;
  }
};

Said ate(const Trajectory& truth, const Trajectory& estimate, bool fitted) {
  const PathMatch match = associate(truth, estimate, Pose::Identity(), 1);
  Said said;
  add_ate(MetricList(said.metrics), pose_errors(match, fitted ? align_se3(match).X_WM : align_first_pose(match).X_WM),
          "");
  return said;
}

TEST(PathError, ARigidMotionOfTheWholePathIsNoError) {
  const Trajectory truth = corner_path();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto u = [&](int k) { return 2 * uniform(seed, Draw::test, k) - 1; };
    const Pose X = pose_of({100 * u(0), 100 * u(1), 10 * u(2)}, 3 * u(3), 0.3 * u(4), 0.3 * u(5));
    const Trajectory estimate = changed(truth, [&](size_t, const Pose& p) { return X * p; });
    for (const bool fitted : {false, true}) {
      const Said said = ate(truth, estimate, fitted);
      EXPECT_LT(said("ate_max_m"), 1e-10) << "seed " << seed;  // doubles at 200 m
      EXPECT_LT(said("yaw_rmse_deg") + said("pitch_rmse_deg") + said("roll_rmse_deg"), 1e-5) << "seed " << seed;
    }
  }
}

TEST(PathError, APathOnePercentTooLongIsOffByOnePercentOfTheWayFromItsStart) {
  const Trajectory truth = corner_path();
  const Trajectory estimate = changed(truth, [](size_t, Pose p) {
    p.translation() *= 1.01;
    return p;
  });
  const Said said = ate(truth, estimate, false);
  EXPECT_NEAR(said("ate_max_m"), std::sqrt(2.0), 1e-9);  // 1 % of (100, 100)
  // Along x the error is s / 100; along y sqrt(1 + (s / 100)^2): mean square (1/3 + 4/3) / 2 by integration; 401 poses.
  EXPECT_NEAR(said("ate_rmse_m"), std::sqrt(5.0 / 6), 0.005);
  EXPECT_NEAR(said("ate_xy_rmse_m"), said("ate_rmse_m"), 1e-12);
  EXPECT_EQ(said("ate_z_rmse_m"), 0);
}

TEST(PathError, FittingTakesHalfOfAStepAndSplitsItByAxis) {
  // Every other pose is 0.2 m too high: the best height is in the middle, 0.1 m from each.
  const Trajectory truth = corner_path();
  const Trajectory estimate = changed(truth, [](size_t i, Pose p) {
    p.translation().z() += i % 2 ? 0.2 : 0;
    return p;
  });
  const Said said = ate(truth, estimate, true);
  EXPECT_NEAR(said("ate_z_rmse_m"), 0.1, 1e-4);  // 401 poses are not half and half
  EXPECT_NEAR(said("ate_rmse_m"), 0.1, 1e-4);
  EXPECT_LT(said("ate_xy_rmse_m"), 1e-3);
}

TEST(PathError, AConstantTiltOfTheBodyIsARollErrorAndNoPositionError) {
  const Trajectory truth = corner_path();
  const Trajectory estimate =
      changed(truth, [](size_t, const Pose& p) { return p * pose_of(Vec3::Zero(), 0, 0, 2 * deg); });
  const Said said = ate(truth, estimate, true);
  EXPECT_NEAR(said("roll_rmse_deg"), 2, 1e-9);
  EXPECT_LT(said("yaw_rmse_deg"), 1e-9);
  EXPECT_LT(said("ate_max_m"), 1e-10);
}

TEST(PathError, AStraightPathIsLaidByItsOrientationToo) {
  Trajectory truth;
  for (int i = 0; i <= 100; ++i) {
    truth.stamp_s.push_back(i);
    truth.X_WB.push_back(pose_of({1.0 * i, 0, 0}, 0));
  }
  const Pose X = pose_of({5, 6, 7}, 0.4, 0, 0.7);
  const Trajectory estimate = changed(truth, [&](size_t, const Pose& p) { return X * p; });
  const PathMatch match = associate(truth, estimate, Pose::Identity(), 2);
  const Alignment aligned = align_se3(match);
  EXPECT_FALSE(aligned.warning.empty());
  EXPECT_TRUE((aligned.X_WM * X).isApprox(Pose::Identity(), 1e-9));  // the turn about the line too
}

TEST(PathError, RelativeErrorIsPerWayDriven) {
  const Trajectory truth = corner_path();
  // The heading turns by 0.02 deg per metre of way too much, positions 1 % too long.
  const Trajectory estimate = changed(truth, [](size_t i, Pose p) {
    p.translation() *= 1.01;
    return p * pose_of(Vec3::Zero(), 0.02 * deg * 0.5 * static_cast<double>(i));
  });
  Said said;
  add_rpe(MetricList(said.metrics), associate(truth, estimate, Pose::Identity(), 1), {1, 10, 500}, "");
  EXPECT_NEAR(said("rpe_10m_deg_per_m"), 0.02, 1e-6);
  EXPECT_EQ(said.n("rpe_10m_m"), 381);  // poses 0 .. 380 have one 20 poses on
  EXPECT_TRUE(std::isnan(said("rpe_500m_m")));
  // With the headings right only the length is wrong: 1 % of the chord, that is of the way but for the corner.
  const Trajectory longer = changed(truth, [](size_t, Pose p) {
    p.translation() *= 1.01;
    return p;
  });
  Said only;
  add_rpe(MetricList(only.metrics), associate(truth, longer, Pose::Identity(), 1), {1}, "");
  EXPECT_NEAR(only("rpe_1m_percent"), 1, 0.002);  // one pair of 399 cuts the corner, 0.707 of the way
}

TEST(PathError, LengthRatioSeesASlipAndItsWorstStretch) {
  // From 50 m to 75 m along the corridor the estimate moves by half only.
  const Trajectory truth = corner_path();
  const Trajectory estimate = changed(truth, [](size_t i, Pose p) {
    p.translation().x() -= 0.5 * std::clamp(0.5 * static_cast<double>(i) - 50, 0.0, 25.0);
    return p;
  });
  Said said;
  add_length(MetricList(said.metrics), associate(truth, estimate, Pose::Identity(), 1), "");
  EXPECT_NEAR(said("length_ratio"), 187.5 / 200, 1e-9);
  EXPECT_NEAR(said("length_error_percent"), -6.25, 1e-9);
  EXPECT_NEAR(said("length_ratio_worst_50m"), 0.75, 1e-9);
}

TEST(PathError, TruthIsInterpolatedAndGapsAreNot) {
  Trajectory truth;
  truth.stamp_s = {0, 1, 5};
  truth.X_WB = {pose_of({0, 0, 0}, 0), pose_of({1, 0, 0}, pi / 2), pose_of({5, 0, 0}, pi / 2)};
  Trajectory estimate;
  for (const double t : {-0.5, 0.25, 1.0, 3.0, 5.0, 6.0}) {
    estimate.stamp_s.push_back(t);
    estimate.X_WB.push_back(Pose::Identity());
  }
  const PathMatch match = associate(truth, estimate, Pose::Identity(), 2);
  ASSERT_EQ(match.index, (std::vector<size_t>{1, 2, 4}));  // before the truth, in its gap and after it: none
  EXPECT_NEAR(match.X_WB[0].translation().x(), 0.25, 1e-12);
  EXPECT_NEAR(flatten(match.X_WB[0]).yaw_rad, pi / 8, 1e-12);
  EXPECT_DOUBLE_EQ(match.share(), 0.5);
}

TEST(PathError, QuantilesLieBetweenNeighbours) {
  std::vector<double> v{4, 1, 3, 2};
  EXPECT_DOUBLE_EQ(quantile(v, 0), 1);
  EXPECT_DOUBLE_EQ(quantile(v, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile(v, 1), 4);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace adit
