// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "base/rig.h"
#include "base/rng.h"
#include "mapper/sparse_solve.h"
#include "mapper/spline.h"
#include "mapper/tilt.h"
#include "tests/support/shapes.h"
#include "tests/support/tube_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;

/// The true path as a planar mapper would give it: level poses that put the horizontal laser where it truly stands.
struct Planar {
  std::vector<double> stamp_s;
  std::vector<Pose2> pose;
};

Planar planar_of(const Log& log, const Trajectory& truth, double noise_m = 0) {
  const int horizontal = find_view(log.rig, View::horizontal);
  const Vec3 p_BH = log.rig.mounts[horizontal].X_BS.translation();
  const Pose2 X_MW = flatten(truth.at(log.scans[horizontal].stamp_s.front())).inverse();
  Planar planar;
  for (size_t n = 0; n < log.scans[horizontal].size(); ++n) {
    const double t = log.scans[horizontal].stamp_s[n];
    const Pose X_WB = truth.at(t);
    Pose2 level = flatten(X_WB);
    const Vec2 shift = (X_WB * p_BH).head<2>() - level * Vec2(p_BH.head<2>());
    level.x_m += shift.x() + noise_m * normal(5, Draw::test, n, 0);
    level.y_m += shift.y() + noise_m * normal(5, Draw::test, n, 1);
    level.yaw_rad += noise_m * normal(5, Draw::test, n, 2);
    planar.stamp_s.push_back(t);
    planar.pose.push_back(X_MW * level);
  }
  return planar;
}

/// Errors of z, pitch and roll as rms, after the plane that fits the error in z best is taken off all three: what no
/// laser can tell is one tilt of the whole.
struct TiltError {
  double z_m, pitch_deg, roll_deg;
};

TiltError error_of(const Trajectory& estimate, const Trajectory& truth) {
  Eigen::Matrix3d H = 0.1 * Eigen::Vector3d(1, 1, 0).asDiagonal();  // keeps a straight path's cross slope at zero
  Vec3 g = Vec3::Zero();
  std::vector<Vec3> off, row;
  for (size_t k = 0; k < estimate.size(); ++k) {
    const Pose &X = estimate.X_WB[k], Y = truth.at(estimate.stamp_s[k]);
    const YawPitchRoll a = yaw_pitch_roll(Y.linear()), b = yaw_pitch_roll(X.linear());
    off.emplace_back(Y.translation().z() - X.translation().z(), a.pitch_rad - b.pitch_rad, a.roll_rad - b.roll_rad);
    row.emplace_back(X.translation().x(), X.translation().y(), 1);
    H += row[k] * row[k].transpose();
    g += row[k] * off[k][0];
  }
  const Vec3 plane = H.ldlt().solve(g);
  Vec3 sum = Vec3::Zero();
  for (size_t k = 0; k < estimate.size(); ++k) {
    const double yaw = yaw_pitch_roll(estimate.X_WB[k].linear()).yaw_rad, c = std::cos(yaw), s = std::sin(yaw);
    const Vec3 gauge(plane.dot(row[k]), -(plane[0] * c + plane[1] * s), -plane[0] * s + plane[1] * c);
    sum += (off[k] - gauge).cwiseAbs2();
  }
  sum = (sum / static_cast<double>(estimate.size())).cwiseSqrt();
  return {sum[0], sum[1] / deg, sum[2] / deg};
}

TEST(LeastSquares, SolvesAnOverdeterminedSystemAndNamesASingularOne) {
  // y = 2 + 3 t through exact points, and one unknown that nothing holds.
  SparseRows rows;
  rows.unknowns = 2;
  for (int t = 0; t < 5; ++t) {
    rows.column.insert(rows.column.end(), {0, 1});
    rows.value.insert(rows.value.end(), {1.0, static_cast<double>(t)});
    rows.offset.push_back(static_cast<int>(rows.column.size()));
    rows.right.push_back(2 + 3.0 * t);
  }
  const SparseSolution solution = solve_least_squares(rows);
  EXPECT_NEAR(solution.x[0], 2, 1e-12);
  EXPECT_NEAR(solution.x[1], 3, 1e-12);
  EXPECT_EQ(solution.covariance.size(), 0);
  // Inverse of [5 10; 10 30].
  const Eigen::MatrixXd covariance = solve_least_squares(rows, {1, 0}).covariance;
  EXPECT_NEAR(covariance(0, 0), 0.1, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 0.6, 1e-12);
  EXPECT_NEAR(covariance(0, 1), -0.2, 1e-12);
  rows.unknowns = 3;
  EXPECT_THROW(solve_least_squares(rows), Error);
}

TEST(KnotClock, WeightsSumToOneAndKnotsAreSparseAtRest) {
  std::vector<double> stamps;
  std::vector<bool> moving;
  for (int n = 0; n <= 100; ++n) {
    stamps.push_back(0.2 * n);
    moving.push_back(n < 50);
  }
  const KnotClock clock(stamps, moving, 0.2, 2);
  EXPECT_EQ(clock.controls(), 50 + 5 + 4);
  for (double t = 0; t <= 20; t += 0.037) {
    const SplineWeights w = clock.at(t);
    EXPECT_NEAR(w.weight[0] + w.weight[1] + w.weight[2] + w.weight[3], 1, 1e-12);
    EXPECT_GE(w.first, 0);
    EXPECT_LE(w.first + 4, clock.controls());
  }
  EXPECT_EQ(clock.at(19.9).first - clock.at(10.1).first, 4);
}

TEST(PlanarMotion, FollowsATurningVehicleBetweenItsStampsAcrossTheCutOfYaw) {
  const auto truth = [](double t) {
    return Pose2{2 * std::cos(0.5 * t), 2 * std::sin(0.5 * t), wrap_angle(0.5 * t + 1.57)};
  };
  std::vector<double> stamps;
  std::vector<Pose2> poses;
  for (int n = 0; n < 40; ++n) {
    stamps.push_back(0.2 * n);
    poses.push_back(truth(0.2 * n));
  }
  const PlanarMotion motion(stamps, poses);
  for (double t = 0.2; t < 7.6; t += 0.03) {
    const Pose2 error = truth(t).inverse() * motion.at(t);
    EXPECT_LT(error.position().norm(), 1e-4);  // 2 m * (0.1 rad)^3 / 24, slopes by differences
    EXPECT_LT(std::abs(error.yaw_rad), 1e-9);
  }
}

TEST(Tilt, OfAShakenCartInASmoothLevelTunnelIsFoundToAFewHundredthsOfADegree) {
  Ride ride;
  ride.pitch_deg = 2, ride.roll_deg = 1, ride.heave_m = 0.01;
  const Trajectory truth = ride_along(straight_line(2, 20), {}, ride);
  const Log log = tube_log(fine_box_mesh({0, -1.85, 0}, {24, 1.85, 1.9}, 5), load_rig("cart4", 38400), truth, 0.005, 1);
  const Planar planar = planar_of(log, truth);
  const TiltSolution solution = solve_tilt(log, planar.stamp_s, planar.pose, {});
  const TiltError error = error_of(solution.path, truth);
  EXPECT_LT(error.z_m, 0.02);
  EXPECT_LT(error.pitch_deg, 0.2);
  EXPECT_LT(error.roll_deg, 0.2);
  EXPECT_TRUE(solution.note.empty());
  // What beams between the stamps need: the same motion at any time. Linear between poses 20 ms apart.
  EXPECT_LT(error_of(solution.dense, truth).pitch_deg, 0.2);
}

TEST(Tilt, OfARoughRingThatRollsByMetresCloses) {
  Ground ground;
  ground.roll_m = 0.15, ground.rough_m = 0.03;
  Ride ride;
  ride.pitch_deg = 1.5, ride.roll_deg = 1, ride.heave_m = 0.01, ride.stop_s = 5;
  const World ring = ring_world(15, 3.7, 1.9, 0.2);
  const Trajectory truth = ride_along(ring_line(15, 3.7, 1.7, 1.2), ground, ride);
  const Log log = tube_log(bent(ring.mesh, ground), load_rig("cart4", 38400), truth, 0.005, 2);
  const Planar planar = planar_of(log, truth, 0.005);
  const TiltSolution solution = solve_tilt(log, planar.stamp_s, planar.pose, {});
  const TiltError error = error_of(solution.path, truth);
  EXPECT_LT(error.z_m, 0.08);
  EXPECT_LT(error.pitch_deg, 0.5);
  EXPECT_LT(error.roll_deg, 0.7);
}

// Rings across the way lie as well on floor and roof if the body dives into them: what does not see pitch must not invent it.
TEST(Tilt, StaysNearLevelAndSaysSoWhereNoLaserSeesPitch) {
  Ground ground;
  ground.roll_m = 0.03, ground.rough_m = 0.03;
  Ride ride;
  ride.pitch_deg = 2, ride.roll_deg = 1, ride.heave_m = 0.01;
  const World ring = ring_world(15, 3.7, 1.9, 0.2);
  const Trajectory truth = ride_along(ring_line(15, 3.7, 1.7, 1.2), ground, ride);
  Rig rig = load_rig("cart4", 38400);
  rig.mounts.erase(rig.mounts.begin() + find_view(rig, View::forward_vertical));
  const Log log = tube_log(bent(ring.mesh, ground), rig, truth, 0.005, 2);
  const Planar planar = planar_of(log, truth, 0.005);
  const TiltSolution solution = solve_tilt(log, planar.stamp_s, planar.pose, {});
  const TiltError error = error_of(solution.path, truth);
  EXPECT_LT(error.z_m, 0.3);
  EXPECT_LT(error.pitch_deg, 4);  // a cart that is shaken by 2 deg on a floor that rolls by 1 deg
  EXPECT_LT(error.roll_deg, 2.5);
  EXPECT_THAT(solution.note, testing::HasSubstr("pitch is not seen"));
}

TEST(Tilt, RangeErrorsOfTheLasersAreFound) {
  Ride ride;
  ride.pitch_deg = 1.5;
  const Trajectory truth = ride_along(straight_line(2, 16), {}, ride);
  Log log = tube_log(fine_box_mesh({0, -1.85, 0}, {20, 1.85, 1.9}, 5), load_rig("cart4", 38400), truth, 0.003, 3);
  const int ahead = find_view(log.rig, View::forward_vertical), up = find_view(log.rig, View::up);
  for (float& r : log.scans[ahead].range_m) r += 0.012F;
  for (float& r : log.scans[up].range_m) r -= 0.008F;
  const Planar planar = planar_of(log, truth);
  const TiltSolution solution = solve_tilt(log, planar.stamp_s, planar.pose, {});
  EXPECT_NEAR(solution.range_bias_m[ahead], 0.012, 0.004);
  EXPECT_NEAR(solution.range_bias_m[up], -0.008, 0.004);
  EXPECT_LT(error_of(solution.path, truth).pitch_deg, 0.25);
}

TEST(Tilt, RangeErrorsAreTakenOffWhatWasSeenAndNothingElse) {
  Log log{load_rig("groundhog2", 38400), {}};
  constexpr float none = std::numeric_limits<float>::infinity();
  for (size_t m = 0; m < log.rig.mounts.size(); ++m) log.scans.push_back({3, {0.5}, {2.0F, none, 0.005F}});
  std::vector<double> bias(log.scans.size(), 0);
  bias[1] = 0.01;
  const Log corrected = without_bias(log, bias);
  EXPECT_EQ(corrected.scans[0].range_m, log.scans[0].range_m);
  EXPECT_EQ(corrected.scans[1].range_m, (std::vector<float>{2.0F - 0.01F, none, 0.0F}));
}

TEST(Tilt, IsTheSameOnAnyNumberOfThreads) {
  Ride ride;
  ride.pitch_deg = 2;
  const Trajectory truth = ride_along(straight_line(2, 8), {}, ride);
  const Log log = tube_log(fine_box_mesh({0, -1.85, 0}, {10, 1.85, 1.9}, 5), load_rig("cart4", 38400), truth, 0.005, 1);
  const Planar planar = planar_of(log, truth);
  std::vector<Trajectory> paths;
  for (const int n : {1, 2, 7}) {
    set_threads(n);
    paths.push_back(estimate_tilt(log, planar.stamp_s, planar.pose, {}));
  }
  set_threads(0);
  for (const Trajectory& path : paths)
    for (size_t k = 0; k < path.size(); ++k) EXPECT_EQ(path.X_WB[k].matrix(), paths[0].X_WB[k].matrix());
}

TEST(Tilt, StaysPlanarAndSaysSoWhereNoLaserTellsIt) {
  const Trajectory truth = ride_along(straight_line(2, 6), {}, {});
  const Log log =
      tube_log(fine_box_mesh({0, -1.85, 0}, {10, 1.85, 1.9}, 5), load_rig("groundhog2", 38400), truth, 0, 4);
  const Planar planar = planar_of(log, truth);
  const TiltSolution solution = solve_tilt(log, planar.stamp_s, planar.pose, {});
  EXPECT_FALSE(solution.note.empty());
  ASSERT_EQ(solution.path.size(), planar.stamp_s.size());
  EXPECT_TRUE(solution.path.X_WB.back().isApprox(lift(planar.pose.back())));
}

}  // namespace
}  // namespace adit
