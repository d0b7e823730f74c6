// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "mapper/match.h"
#include "mapper/odometry.h"
#include "mapper/rematch.h"
#include "tests/support/plan_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double degree = std::numbers::pi / 180;

// A straight piece of the panel: 40 m of tour with its points undone by the true motion.
struct Stretch {
  PlanLog log;
  std::vector<ScanPoints> points;
  std::vector<Pose2> X_WB;
};

Stretch stretch(double rough_rms_m, std::uint64_t seed, TourSettings tour = {}) {
  const double d = 18;
  const Plan plan = plan_along(panel_lines(2, 3, d), {.rough_rms_m = rough_rms_m}, seed);
  Stretch s{drive_plan(plan, {{2, 0}, {d, 0}, {d, d}, {2, d}}, tour, seed), {}, {}};
  s.X_WB = s.log.X_WB;
  s.points = scan_points(s.log.scans, s.log.mount, s.X_WB);
  return s;
}

// The map of the scans before and after scan i, itself left out.
LocalMap map_around(const Stretch& s, size_t i) {
  std::vector<const ScanPoints*> scans;
  std::vector<Pose2> poses;
  for (size_t k = i > 30 ? i - 30 : 0; k < std::min(s.points.size(), i + 30); k += 3)
    if (k != i) scans.push_back(&s.points[k]), poses.push_back(s.X_WB[k]);
  return LocalMap(scans, poses);
}

Pose2 shifted(const Pose2& X, double m, double rad, std::uint64_t seed, std::uint64_t k) {
  const double way = 2 * std::numbers::pi * uniform(seed, Draw::test, k, 1);
  const double turn = uniform(seed, Draw::test, k, 2) < 0.5 ? -rad : rad;
  return {X.x_m + m * std::cos(way), X.y_m + m * std::sin(way), wrap_angle(X.yaw_rad + turn)};
}

double off_m(const Pose2& a, const Pose2& b) {
  return (a.position() - b.position()).norm();
}
double off_rad(const Pose2& a, const Pose2& b) {
  return std::abs(wrap_angle(a.yaw_rad - b.yaw_rad));
}

Scans scan_of_a_wall(const Mount& mount, double wall_m) {
  Scans scans;
  scans.beams = mount.laser.beams;
  scans.stamp_s = {0};
  for (int k = 0; k < scans.beams; ++k) {
    const double c = std::cos(mount.laser.beam_angle_rad(k));
    scans.range_m.push_back(c > 0.05 ? static_cast<float>(wall_m / c) : std::numeric_limits<float>::infinity());
  }
  return scans;
}

Mount plain_mount() {
  Mount m = plan_mount(181, 0.2, 0.01);
  m.X_BS = Pose::Identity();
  return m;
}

TEST(ScanPoints, AWallAheadGivesPointsOnItWithNormalsTowardsTheLaser) {
  const Scans scans = scan_of_a_wall(plain_mount(), 3);
  const ScanPoints points = scan_points(scans[0], fan_of(plain_mount()), {}, {});
  ASSERT_GT(points.size(), 150u);
  for (size_t k = 0; k < points.size(); ++k) {
    EXPECT_NEAR(points.p_B[k].x(), 3, 1e-5);  // float ranges up to 14 m: 14 * 2^-24 = 1e-6 m
    EXPECT_NEAR(points.normal_B[k].x(), -1, 1e-6);
  }
}

TEST(ScanPoints, DropOutsAndBeamsWithoutEchoGiveNoPoint) {
  Scans scans = scan_of_a_wall(plain_mount(), 3);
  scans.range_m[90] = std::numeric_limits<float>::quiet_NaN();
  scans.range_m[91] = std::numeric_limits<float>::infinity();
  const ScanPoints points = scan_points(scans[0], fan_of(plain_mount()), {}, {});
  for (const std::int32_t beam : points.beam) EXPECT_TRUE(beam != 90 && beam != 91);
  EXPECT_GT(points.size(), 150u);
}

TEST(ScanPoints, AMixedPixelBetweenTwoWallsIsLeftOut) {
  Scans scans = scan_of_a_wall(plain_mount(), 3);
  for (int k = 90; k < 181; ++k) scans.range_m[k] *= 2.5;  // an edge at the middle beam, the far wall behind it
  scans.range_m[90] = 5;                                   // half on either side
  const ScanPoints points = scan_points(scans[0], fan_of(plain_mount()), {}, {});
  for (const std::int32_t beam : points.beam) EXPECT_NE(beam, 90);
}

TEST(ScanPoints, MotionWithinAScanIsUndone) {
  // Towards a wall at 1 m/s, turning: each beam measures from where the laser then is.
  const Mount mount = plain_mount();
  const BeamFan fan = fan_of(mount);
  const Twist2 twist{1.0, 0.1, 0.5};
  std::vector<float> range_m;
  for (int k = 0; k < mount.laser.beams; ++k) {
    const Pose2 X = pose_after(twist, fan.offset_s[k]);
    const double c = std::cos(X.yaw_rad + mount.laser.beam_angle_rad(k));
    range_m.push_back(c > 0.05 ? static_cast<float>((3 - X.x_m) / c) : std::numeric_limits<float>::infinity());
  }
  const ScanPoints points = scan_points(range_m, fan, twist, {});
  ASSERT_GT(points.size(), 150u);
  // Within a scan of 13 ms x and y are taken for straight: 0.5 rad/s * (13 ms)^2 * 1 m/s / 2 = 0.05 mm.
  for (const Vec2& p : points.p_B) EXPECT_NEAR(p.x(), 3, 1e-4);
}

TEST(Twist, PoseAfterTheTwistOfAMotionIsThatMotion) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Pose2 X{normal(seed, Draw::test, 1), normal(seed, Draw::test, 2), 0.8 * normal(seed, Draw::test, 3)};
    const Pose2 back = pose_after(twist_of(X, 0.3), 0.3);
    EXPECT_NEAR(off_m(X, back), 0, 1e-12) << "seed " << seed;
    EXPECT_NEAR(off_rad(X, back), 0, 1e-12) << "seed " << seed;
  }
}

TEST(Match, AScanIsPlacedWithinMillimetresOnRoughRibs) {
  const Stretch s = stretch(0.05, 100);
  double squares = 0;
  int n = 0;
  for (size_t i = 20; i + 20 < s.points.size(); i += 10, ++n) {
    const Match m = match_scan(s.points[i], map_around(s, i), shifted(s.X_WB[i], 0.05, 1 * degree, 100, i), {});
    EXPECT_TRUE(m.converged) << "scan " << i;
    EXPECT_FALSE(m.degenerate) << "scan " << i;
    squares += std::pow(off_m(m.X_AB, s.X_WB[i]), 2);
    EXPECT_LT(off_rad(m.X_AB, s.X_WB[i]), 0.2 * degree) << "scan " << i;
  }
  // 300 beams of 10 mm on ribs that lean by 0.1 along the way: 10 mm / sqrt(300) / 0.1 = 6 mm along, 1 mm across.
  EXPECT_LT(std::sqrt(squares / n), 0.006);
}

TEST(Match, TheStatedUncertaintyCoversTheError) {
  double nees = 0;
  int n = 0;
  for (std::uint64_t seed = 100; seed < 102; ++seed) {
    const Stretch s = stretch(0.05, seed);
    for (size_t i = 20; i + 20 < s.points.size(); i += 5, ++n) {
      const Match m = match_scan(s.points[i], map_around(s, i), s.X_WB[i], {});
      const Pose2 e = m.X_AB.inverse() * s.X_WB[i];
      const Vec3 error(e.x_m, e.y_m, e.yaw_rad);
      nees += error.dot(m.information * error) / 3;
    }
  }
  EXPECT_LT(nees / n, 2);  // not certain beyond reason
  EXPECT_GT(nees / n, 0.1);
}

TEST(Match, SmoothRibsLeaveTheWayAlongOpenAndItIsSaidAndKept) {
  // Between two straight ribs, seen no farther than they run: nothing tells the place along them.
  const Mount mount = plain_mount();
  Scans scans;
  scans.beams = mount.laser.beams;
  for (int i = 0; i < 12; ++i) {
    scans.stamp_s.push_back(0.2 * i);
    for (int k = 0; k < scans.beams; ++k) {
      const double side = std::abs(std::sin(mount.laser.beam_angle_rad(k)));
      const double noise = 0.01 * normal(7, Draw::test, i, k);
      scans.range_m.push_back(side > 0.15 ? static_cast<float>(1.85 / side + noise)
                                          : std::numeric_limits<float>::infinity());
    }
  }
  std::vector<Pose2> X;
  for (int i = 0; i < 12; ++i) X.push_back({0.14 * i, 0, 0});
  const std::vector<ScanPoints> points = scan_points(scans, mount, X);
  std::vector<const ScanPoints*> before;
  for (int i = 0; i < 11; ++i) before.push_back(&points[i]);
  const LocalMap map(before, std::span(X).first(11));
  const Match m = match_scan(points[11], map, {X[11].x_m + 0.2, 0.03, 0.01}, {});
  EXPECT_TRUE(m.converged);
  EXPECT_TRUE(m.degenerate);
  EXPECT_GT(std::abs(m.weak_direction.x()), 0.99);
  EXPECT_NEAR(m.X_AB.x_m, X[11].x_m + 0.2, 0.03);  // stays at the guess: noise may not pull it farther than it leans
  EXPECT_NEAR(m.X_AB.y_m, 0, 0.005);               // 10 mm over 150 beams, a map of eleven scans: 1 mm; five of them
  EXPECT_NEAR(m.X_AB.yaw_rad, 0, 0.002);
}

TEST(Match, APriorDecidesWhereTheScanIsSilentAndYieldsWhereItSpeaks) {
  const Stretch s = stretch(0.05, 101);
  const size_t i = 60;
  const Pose2 wrong = s.X_WB[i] * Pose2{0.1, 0, 0};
  const LocalMap map = map_around(s, i);
  const Eigen::Matrix3d loose = Vec3(1, 1, 1).asDiagonal(), tight = Vec3(1e10, 1e10, 1e10).asDiagonal();
  EXPECT_LT(off_m(match_scan(s.points[i], map, wrong, {}, PosePrior{wrong, loose}).X_AB, s.X_WB[i]), 0.01);
  EXPECT_LT(off_m(match_scan(s.points[i], map, wrong, {}, PosePrior{wrong, tight}).X_AB, wrong), 0.001);
}

TEST(Match, AnEmptyMapAndAnEmptyScanGiveNoMatch) {
  const Stretch s = stretch(0.05, 100);
  EXPECT_FALSE(match_scan(s.points[20], LocalMap{}, {}, {}).converged);
  EXPECT_FALSE(match_scan(ScanPoints{}, map_around(s, 20), s.X_WB[20], {}).converged);
  EXPECT_FALSE(search_scan(ScanPoints{}, map_around(s, 20), s.X_WB[20], {}, {}).best.converged);
}

TEST(Search, FindsThePlaceFromOneMetreAndThirtyDegreesOff) {
  const Stretch s = stretch(0.05, 102);
  for (size_t i = 20; i + 20 < s.points.size(); i += 24) {
    const Pose2 guess = shifted(s.X_WB[i], 1.0, 30 * degree, 102, i);
    const WideMatch w = search_scan(s.points[i], map_around(s, i), guess, {1.0, 30 * degree}, {});
    EXPECT_TRUE(w.best.converged) << "scan " << i;
    EXPECT_LT(off_m(w.best.X_AB, s.X_WB[i]), 0.03) << "scan " << i;
    EXPECT_LT(off_rad(w.best.X_AB, s.X_WB[i]), 0.3 * degree) << "scan " << i;
    EXPECT_GT(w.score, w.runner_up_score) << "scan " << i;
  }
}

TEST(Search, JoinedScansAreOneScanInTheFrameAskedFor) {
  const Stretch s = stretch(0.05, 100);
  const std::vector<const ScanPoints*> three{&s.points[40], &s.points[43], &s.points[46]};
  const std::vector<Pose2> poses{s.X_WB[40], s.X_WB[43], s.X_WB[46]};
  const ScanPoints joined = join_scans(three, poses, s.X_WB[43]);
  EXPECT_GT(joined.size(), 100u);
  const Match m = match_scan(joined, map_around(s, 43), s.X_WB[43] * Pose2{0.03, -0.03, 0.01}, {});
  EXPECT_TRUE(m.converged);
  EXPECT_LT(off_m(m.X_AB, s.X_WB[43]), 0.01);
}

TEST(Rematch, BringsPosesBackToTheMapThatTheirNeighboursMake) {
  const Stretch s = stretch(0.05, 103);
  std::vector<Pose2> shaken = s.X_WB;
  double before = 0, after = 0;
  for (size_t i = 0; i < shaken.size(); ++i) {
    shaken[i] = shaken[i] * Pose2{0.01 * normal(103, Draw::test, i, 4), 0.01 * normal(103, Draw::test, i, 5), 0};
    before += std::pow(off_m(shaken[i], s.X_WB[i]), 2);
  }
  const std::vector<Pose2> placed = rematch(s.points, shaken, {}, {});
  for (size_t i = 0; i < shaken.size(); ++i) after += std::pow(off_m(placed[i], s.X_WB[i]), 2);
  EXPECT_LT(after, 0.4 * before);  // a map of some twenty shaken scans errs by a quarter of one of them, and more along
}

}  // namespace
}  // namespace adit
