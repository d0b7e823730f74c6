// SPDX-License-Identifier: BSD-3-Clause
// The worked cases of docs/metrics.md that no other test holds: each number is arithmetic, told beside it.
#include "eval/grid_error.h"
#include "eval/path_error.h"
#include "tests/eval/exact_case.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;

// 100 m straight on, a pose a metre, the estimate changed pose by pose; laid by its first pose.
double straight(const std::function<Pose(int, const Pose&)>& change, const std::string& metric) {
  Trajectory truth, estimate;
  for (int i = 0; i <= 100; ++i) {
    const Pose X = pose_of({1.0 * i, 0, 0}, 0);
    truth.stamp_s.push_back(i);
    truth.X_WB.push_back(X);
    estimate.stamp_s.push_back(i);
    estimate.X_WB.push_back(change(i, X));
  }
  const PathMatch match = associate(truth, estimate, Pose::Identity(), 2);
  std::vector<Metric> all;
  const MetricList list(all);
  add_ate(list, pose_errors(match, align_first_pose(match).X_WM), "");
  add_rpe(list, match, {10}, "");
  add_length(list, match, "");
  for (const Metric& m : all)
    if (m.name == metric) return m.value;
  ADD_FAILURE() << "no metric " << metric;
  return NAN;
}

Pose shifted(const Vec3& by, const Pose& X) {
  Pose moved = X;
  moved.translation() += by;
  return moved;
}

TEST(Worked, TheSecondHalfAMetreToTheLeft) {
  const auto of = [](const std::string& name) {
    return straight([](int i, const Pose& X) { return shifted({0, i > 50 ? 1.0 : 0.0, 0}, X); }, name);
  };
  EXPECT_NEAR(of("ate_rmse_m"), std::sqrt(50.0 / 101), 1e-12);  // 50 of 101 poses
  EXPECT_NEAR(of("ate_xy_rmse_m"), std::sqrt(50.0 / 101), 1e-12);
  EXPECT_EQ(of("ate_z_rmse_m"), 0);
  EXPECT_NEAR(of("ate_mean_m"), 50.0 / 101, 1e-12);
  EXPECT_EQ(of("ate_median_m"), 0);
  EXPECT_EQ(of("ate_p95_m"), 1);
  EXPECT_EQ(of("ate_max_m"), 1);
  EXPECT_EQ(of("yaw_rmse_deg"), 0);
  EXPECT_NEAR(of("rpe_10m_m"), std::sqrt(10.0 / 91), 1e-12);  // 10 of 91 pairs have the step between them
  EXPECT_NEAR(of("rpe_10m_percent"), 10 * 10.0 / 91, 1e-12);  // each of them 1 m of 10
  EXPECT_NEAR(of("length_ratio"), (99 + std::sqrt(2.0)) / 100, 1e-12);
  EXPECT_NEAR(of("length_error_percent"), std::sqrt(2.0) - 1, 1e-9);
  EXPECT_NEAR(of("length_ratio_worst_50m"), (49 + std::sqrt(2.0)) / 50, 1e-12);
}

TEST(Worked, ARiseOfACentimetreAMetre) {
  const auto of = [](const std::string& name) {
    return straight([](int i, const Pose& X) { return shifted({0, 0, 0.01 * i}, X); }, name);
  };
  EXPECT_NEAR(of("ate_rmse_m"), 0.01 * std::sqrt(100 * 201 / 6.0), 1e-12);  // sum of squares n (n + 1) (2n + 1) / 6
  EXPECT_NEAR(of("ate_z_rmse_m"), of("ate_rmse_m"), 1e-12);
  EXPECT_EQ(of("ate_xy_rmse_m"), 0);
  EXPECT_NEAR(of("ate_mean_m"), 0.5, 1e-12);
  EXPECT_NEAR(of("ate_median_m"), 0.5, 1e-12);
  EXPECT_NEAR(of("ate_p95_m"), 0.95, 1e-12);
  EXPECT_NEAR(of("ate_max_m"), 1, 1e-12);
  EXPECT_NEAR(of("rpe_10m_m"), 0.1, 1e-12);
  EXPECT_NEAR(of("rpe_10m_percent"), 1, 1e-10);
  EXPECT_EQ(of("rpe_10m_deg_per_m"), 0);
  EXPECT_NEAR(of("length_ratio"), std::sqrt(1.0001), 1e-12);
  EXPECT_NEAR(of("length_ratio_worst_50m"), std::sqrt(1.0001), 1e-12);
}

TEST(Worked, APathOnePercentTooLong) {
  const auto of = [](const std::string& name) {
    return straight([](int i, const Pose& X) { return shifted({0.01 * i, 0, 0}, X); }, name);
  };
  EXPECT_NEAR(of("ate_p95_m"), 0.95, 1e-12);
  EXPECT_NEAR(of("length_error_percent"), 1, 1e-9);
  EXPECT_NEAR(of("length_ratio_worst_50m"), 1.01, 1e-12);
  EXPECT_NEAR(of("rpe_10m_percent"), 1, 1e-10);
  EXPECT_EQ(of("pitch_rmse_deg"), 0);
  EXPECT_EQ(of("ate_z_rmse_m"), 0);
}

// A row of twelve cells, walls at 0, 4 and 8; the map has walls where it is told, of certainty, and is free elsewhere.
std::vector<double> row_of_cells(const std::vector<int>& walls, float certain = 30) {
  TrueSection section{.cell_m = 1, .width = 12, .height = 1, .cell = std::vector<CellTruth>(12, CellTruth::free)};
  for (const int i : {0, 4, 8}) section.cell[static_cast<size_t>(i)] = CellTruth::wall;
  Grid grid;
  grid.cell_m = 1, grid.width = 12, grid.height = 1;
  grid.log_odds.assign(12, -certain);
  for (const int i : walls) grid.log_odds[static_cast<size_t>(i)] = certain;
  std::vector<Metric> all;
  add_grid(MetricList(all), section, grid, "");
  std::vector<double> values;
  for (const char* name : {"iou_free", "precision_occupied", "recall_occupied", "f_occupied", "brier"})
    for (const Metric& m : all)
      if (m.name == name) values.push_back(m.value);
  return values;
}

TEST(Worked, WallsOfARowOfCells) {
  const auto expect = [](const std::vector<double>& found, const std::vector<double>& wanted) {
    ASSERT_EQ(found.size(), wanted.size());
    for (size_t k = 0; k < wanted.size(); ++k) EXPECT_NEAR(found[k], wanted[k], 1e-9) << k;
  };
  expect(row_of_cells({0, 4, 8}), {1, 1, 1, 1, 0});
  // 0 and, as a neighbour, 5 are right, 11 is none and 8 is missed; 4 of 12 cells say the wrong thing.
  expect(row_of_cells({0, 5, 11}), {7.0 / 11, 2.0 / 3, 2.0 / 3, 2.0 / 3, 4.0 / 12});
  // Eight cells are walls or their neighbours.
  expect(row_of_cells({0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11}), {0, 8.0 / 12, 1, 0.8, 9.0 / 12});
}

TEST(Worked, EveryOtherBodyTurnedByOneTwoAndThreeDegrees) {
  const auto of = [](const std::string& name) {
    return straight(
        [](int i, const Pose& X) { return i % 2 ? X * pose_of(Vec3::Zero(), 1 * deg, 2 * deg, 3 * deg) : X; }, name);
  };
  EXPECT_NEAR(of("yaw_rmse_deg"), std::sqrt(50.0 / 101), 1e-9);
  EXPECT_NEAR(of("pitch_rmse_deg"), 2 * std::sqrt(50.0 / 101), 1e-9);
  EXPECT_NEAR(of("roll_rmse_deg"), 3 * std::sqrt(50.0 / 101), 1e-9);
  EXPECT_NEAR(of("ate_max_m"), 0, 1e-12);
  EXPECT_NEAR(of("rpe_10m_deg_per_m"), 0, 1e-6);  // ten metres on a body is turned as it was
  EXPECT_NEAR(of("length_ratio"), 1, 1e-12);
}

TEST(Worked, WithGravityTheHeadingIsFittedAndATiltStays) {
  // Turned by 40 deg about the vertical: none; tilted by 1 deg across the way: what a rigid fit would take stays.
  ExactCase c = ring_case();
  ScoreSettings s;
  s.gravity = true;
  const auto with = [&](const Pose& X) {
    ExactCase turned = c;
    for (Pose& X_MB : turned.estimate.path.X_WB) X_MB = X * X_MB;
    turned.estimate.points = {}, turned.estimate.grid = {}, turned.estimate.surface = {};
    return score_of(turned, s);
  };
  EXPECT_LT(value(with(pose_of({9, 8, 7}, 40 * deg)), "trajectory.yaw_xyz.ate_max_m"), 1e-9);
  const Score tilted = with(pose_of({0, 0, 0}, 0, 0, 1 * deg));
  EXPECT_LT(value(tilted, "trajectory.se3.ate_max_m"), 1e-9);
  EXPECT_NEAR(value(tilted, "trajectory.yaw_xyz.ate_max_m"), 8 * std::sin(1 * deg), 0.03);  // 8 m from the middle line
  EXPECT_NEAR(value(tilted, "trajectory.yaw_xyz.roll_rmse_deg"), 0.8,
              0.4);  // as seen from a body that turns with the ring
  EXPECT_EQ(score_of(c).find("trajectory.yaw_xyz.ate_max_m"), nullptr);
}

TEST(Worked, PointsWhereNothingCouldBeSeenAreNeitherRightNorWrong) {
  // A metre of rock behind the tunnel's rear end, which no beam met.
  ExactCase c = tunnel_case();
  const Score before = score_of(c);
  for (int i = 0; i < 100; ++i) {
    c.estimate.points.p.push_back({-5, -1 + 0.02 * i, 1});
    c.estimate.points.stamp_s.push_back(1);
    c.estimate.points.laser.push_back(0);
  }
  const Score after = score_of(c);
  EXPECT_EQ(value(before, "map.se3.unobserved_share"), 0);
  EXPECT_GT(value(after, "map.se3.unobserved_share"), 0);
  EXPECT_EQ(value(after, "map.se3.precision_5cm"), 1);
  EXPECT_EQ(value(after, "map.se3.phantom_share"), 0);
}

TEST(Worked, AFloorThreeCentimetresTooHighIsTheFloorsAlone) {
  ExactCase c = tunnel_case();
  const Score exact = score_of(c);
  for (size_t i = 0; i < c.estimate.points.size(); ++i)
    if (exact.point_label[i] == static_cast<std::uint8_t>(Label::floor)) c.estimate.points.p[i].z() += 0.03;
  const Score s = score_of(c);
  EXPECT_NEAR(value(s, "map.se3.by_label.floor.bias_m"), 0.03, 1e-3);
  EXPECT_NEAR(value(s, "map.se3.by_label.floor.p50_m"), 0.03, 1e-6);
  EXPECT_NEAR(value(s, "map.se3.by_label.floor.rmse_m"), 0.03, 1e-3);
  EXPECT_EQ(value(s, "map.se3.by_label.floor.within_2cm"), 0);
  EXPECT_NEAR(value(s, "map.se3.by_label.roof.mae_m"), 0, 1e-9);
  EXPECT_EQ(value(s, "map.se3.by_label.roof.within_2cm"), 1);
}

TEST(Worked, BrierIsTheSquareOfWhatItIsUnsure) {
  const auto brier = [](float odds_of_right) {
    ExactCase c = tunnel_case();
    for (float& odds : c.estimate.grid.log_odds) odds = odds > 0 ? odds_of_right : odds < 0 ? -odds_of_right : 0;
    return value(score_of(c), "grid.brier");
  };
  EXPECT_NEAR(brier(std::log(3.0f)), 0.0625, 1e-6);   // 0.75 for what is, 0.25 for what is not
  EXPECT_NEAR(brier(-std::log(3.0f)), 0.5625, 1e-6);  // the other way round
  EXPECT_NEAR(brier(-30), 1, 1e-6);
}

TEST(Worked, AClaimIsHeldAgainstWhatCouldBeSeenByItsOwnSigma) {
  ExactCase c = tunnel_case();
  const Score bare = score_of(c);
  const double seen = value(bare, "volume.observable_m3") + value(bare, "volume.unseen_void_m3");
  c.estimate.volume_sigma_m3 = 2;
  for (const auto& [off_m3, holds] : std::vector<std::pair<double, double>>{{-2, 1}, {3.9, 1}, {4, 0}, {-20, 0}}) {
    c.estimate.volume_m3 = seen + off_m3;
    const Score s = score_of(c);
    EXPECT_NEAR(value(s, "volume.claim_sigmas"), off_m3 / 2, 1e-9);
    EXPECT_EQ(value(s, "volume.claim_holds_95"), holds) << off_m3;
    EXPECT_EQ(value(s, "volume.claimed_m3"), seen + off_m3);
    EXPECT_NEAR(value(s, "volume.sigma_percent"), 200 / (seen + off_m3), 1e-9);
  }
}

TEST(Worked, VoidThatAMapClaimsBeyondWhatWasSeenIsNoErrorOfItsClaim) {
  ExactCase c = tunnel_case();
  const double claimed_m3 = enclosed_volume(c.estimate.surface);
  c.estimate.volume_m3 = claimed_m3;
  c.estimate.volume_sigma_m3 = 1;
  const Score s = score_of(c);
  const double seen = value(s, "volume.observable_m3"), unseen = value(s, "volume.unseen_void_m3");
  EXPECT_GT(unseen, 0);
  // Columns of 0.1 m on the faces of the tunnel.
  EXPECT_NEAR(value(s, "volume.claim_sigmas"), claimed_m3 - seen - unseen, 1e-6);
  EXPECT_NEAR(seen + unseen, claimed_m3, 0.01 * claimed_m3);
}

TEST(Worked, PassagesShareTheVolumeAmongThem) {
  const Score s = score_of(ring_case());
  double observable = 0, mapped = 0;
  for (const PassageScore& p : s.passages) {
    observable += p.observable_m3, mapped += p.mapped_m3;
    // A quarter of the ring each: by symmetry of the mine, not of the path, whose first side is driven one and a half times.
    EXPECT_NEAR(p.observable_m3, value(s, "volume.observable_m3") / 4, 12) << p.passage;
  }
  EXPECT_NEAR(observable, value(s, "volume.observable_m3"), 1e-6);
  EXPECT_NEAR(mapped, value(s, "volume.mapped_m3"), 1e-6);
  ASSERT_EQ(s.pillars.size(), 1u);
  EXPECT_EQ(s.pillars[0].true_m2, s.pillars[0].found_m2);
  EXPECT_NEAR(s.pillars[0].true_m2, 144, 0.15 * 48);  // 12 x 12 m, its wall cells count to it
}

}  // namespace
}  // namespace adit
