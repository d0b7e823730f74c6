// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "sim/sim.h"
#include "tests/sim/terrain.h"
#include "tests/support/shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

using testing::HasSubstr;

constexpr double deg = std::numbers::pi / 180;

DriveSettings brisk() {  // no long stands
  DriveSettings settings;
  settings.lead_in_s = 1;
  settings.stop_gap_min_m = settings.stop_gap_max_m = 12;
  settings.stop_min_s = settings.stop_max_s = 4;
  return settings;
}

World plain(const std::function<double(const Vec2&)>& height, double cell_m = 0.25) {
  return terrain_world({-3, -8}, {33, 8}, cell_m, height);
}
double level(const Vec2&) {
  return 0;
}

std::string error_of(const World& world, const Route& route) {
  try {
    drive(world, route, load_vehicle("cart"), brisk(), 1);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Drive, FollowsARouteWithTightBendsWithinAHandsBreadth) {
  const World world = ring_world(18, 3.6, 2, 0.4);
  const Route route = route_through({{0, -7.2}, {7.2, -7.2}, {7.2, 7.2}, {-7.2, 7.2}, {-7.2, -7.2}, {0, -7.2}}, 1.5);
  for (const std::uint64_t seed : {1, 2}) {
    const Drive d = drive(world, route, load_vehicle("cart"), brisk(), seed);
    EXPECT_EQ(d.end, DriveEnd::finished) << d.cause;
    EXPECT_NEAR(d.driven_m, route.length_m, 0.02);
    // The middle swings out by 0.4^2 / (2 * 1.5) = 5 cm where the axle is on the arc; pursuit 0.9 m ahead cuts about as
    // much.
    EXPECT_LT(cross_track_m(d.path, route), 0.16) << "seed " << seed;
    EXPECT_LT((d.path.X_WB.back().translation().head<2>() - route.line.back()).norm(), 0.1);
  }
}

// A cart is swung round about its axle: its front corners, 0.9 m ahead and 0.35 m aside, reach 0.97 m.
TEST(Drive, TurnsRoundWhereTheRouteRunsBackOnItselfInAPassageOf2600Millimetres) {
  const World tunnel = tunnel_world(12, 2.6, 2, 0.5);
  const Route route = route_through({{2, 0}, {8, 0}, {2, 0}}, 0);
  for (const std::uint64_t seed : {4, 5}) {
    const Drive d = drive(tunnel, route, load_vehicle("cart"), brisk(), seed);
    EXPECT_EQ(d.end, DriveEnd::finished) << d.cause;
    EXPECT_NEAR(d.driven_m, route.length_m, 0.02);
    EXPECT_LT(cross_track_m(d.path, route), 0.6) << "seed " << seed;  // its middle is 0.4 m ahead of the axle
    EXPECT_LT((d.path.X_WB.back().translation().head<2>() - route.line.back()).norm(), 0.15) << "seed " << seed;
    double round = 0;
    for (size_t i = 1; i < d.path.size(); ++i)
      round += wrap_angle(flatten(d.path.X_WB[i]).yaw_rad - flatten(d.path.X_WB[i - 1]).yaw_rad);
    EXPECT_NEAR(std::abs(round), std::numbers::pi, 0.2) << "seed " << seed;  // half a turn, all one way
  }
}

// In passages where an arc of the tightest that can be driven does not fit.
TEST(Drive, TurnsInThreeMovesInADeadEndWithTheMiddleOneTailFirst) {
  struct Case {
    const char* vehicle;
    double width_m, radius_m;
  };
  for (const auto& [name, width_m, radius_m] : {Case{"cart", 2.6, 0.55}, Case{"groundhog", 3.4, 0.8}}) {
    const World tunnel = tunnel_world(12, width_m, 2, 0.5);
    const Route route = three_point_route(1.5, 8.5, radius_m);
    DriveSettings settings = brisk();
    settings.robot_speed_mps = 0.3;
    const Drive d = drive(tunnel, route, load_vehicle(name), settings, 4);
    ASSERT_EQ(d.end, DriveEnd::finished) << d.cause;
    EXPECT_NEAR(d.driven_m, route.length_m, 0.02);
    double back_m = 0, turned_rad = 0;
    for (size_t i = 1; i < d.path.size(); ++i) {
      const Pose& X = d.path.X_WB[i];
      back_m += std::max(0.0, -X.linear().col(0).dot(X.translation() - d.path.X_WB[i - 1].translation()));
      turned_rad += wrap_angle(flatten(X).yaw_rad - flatten(d.path.X_WB[i - 1]).yaw_rad);
    }
    EXPECT_NEAR(back_m, radius_m * std::numbers::pi / 3, 0.15) << name;  // the middle arc alone
    EXPECT_NEAR(turned_rad, std::numbers::pi, 0.1) << name;  // to the left by half a turn, and not back again
    EXPECT_LT((d.path.X_WB.back().translation() - d.path.X_WB.front().translation()).norm(), 0.15) << name;
  }
}

TEST(Drive, BeginsAtRestOnTheRoutesFirstPointHeadingAlongIt) {
  const Route route = route_through({{2, 1}, {8, 4}}, 0);
  const Drive d = drive(plain(level), route, load_vehicle("cart"), brisk(), 5);
  ASSERT_FALSE(d.path.empty());
  EXPECT_EQ(d.path.stamp_s.front(), 0);
  EXPECT_LT((d.path.X_WB.front().translation() - Vec3(2, 1, 0)).norm(), 1e-3);
  EXPECT_NEAR(flatten(d.path.X_WB.front()).yaw_rad, std::atan2(3, 6), 1e-3);
  EXPECT_TRUE(d.path.at(0.9).isApprox(d.path.X_WB.front(), 1e-12));
}

TEST(Drive, PathIsSampledEvenlyAndMovesSmoothly) {
  const Drive d = drive(plain(level), route_through({{0, 0}, {20, 0}}, 0), load_vehicle("cart"), brisk(), 6);
  for (size_t i = 1; i < d.path.size(); ++i) {
    EXPECT_NEAR(d.path.stamp_s[i] - d.path.stamp_s[i - 1], 1.0 / 120, 1e-9);
    EXPECT_LT((d.path.X_WB[i].translation() - d.path.X_WB[i - 1].translation()).norm(), 1.6 / 120);
  }
}

TEST(Drive, StandsStillInItsStops) {
  const World rough = plain([](const Vec2& p) { return 0.03 * p.x() + 0.02 * std::sin(3 * p.x() + 2 * p.y()); });
  const Drive d = drive(rough, route_through({{0, 0}, {28, 1}}, 0), load_vehicle("cart"), brisk(), 7);
  ASSERT_EQ(d.end, DriveEnd::finished) << d.cause;
  int stands = 0;
  for (size_t i = 0, j = 0; i < d.path.size(); i = j) {
    const auto near_i = [&](size_t k) {
      return (d.path.X_WB[k].translation() - d.path.X_WB[i].translation()).norm() < 5e-3;
    };
    for (j = i + 1; j < d.path.size() && near_i(j);) ++j;
    const double begin_s = d.path.stamp_s[i], end_s = d.path.stamp_s[j - 1];
    if (end_s - begin_s < 3) continue;
    ++stands;
    const Pose still = d.path.at(0.5 * (begin_s + end_s));
    for (double t = begin_s + 1.2; t < end_s - 0.3;
         t += 0.02) {  // a second to come to rest; then 0.1 mm and 0.005 degrees
      EXPECT_LT((d.path.at(t).translation() - still.translation()).norm(), 1e-4) << "t " << t;
      EXPECT_LT(Eigen::AngleAxisd(still.linear().transpose() * d.path.at(t).linear()).angle(), 0.005 * deg)
          << "t " << t;
    }
  }
  EXPECT_EQ(stands, 2);  // every 12 m of 28 m
}

TEST(Drive, PitchOnALongRampIsItsSlope) {
  const double slope = 5 * deg;
  const World world = plain([=](const Vec2& p) { return p.x() * std::tan(slope); });
  const Drive d = drive(world, route_through({{0, 0}, {25, 0}}, 0), load_vehicle("cart"), brisk(), 8);
  ASSERT_EQ(d.end, DriveEnd::finished) << d.cause;
  double sum = 0;
  for (const Pose& X : d.path.X_WB) sum += yaw_pitch_roll(X.linear()).pitch_rad;
  EXPECT_NEAR(sum / static_cast<double>(d.path.size()), -slope,
              0.3 * deg);  // the push at the handle tilts it by 0.1 deg
}

TEST(Drive, RoughGroundPitchesAndRollsIt) {
  const World rough = plain([](const Vec2& p) {
    double z = 0;
    for (int k = 0; k < 8; ++k) {
      const double a = 2 * std::numbers::pi * uniform(9, Draw::test, k, 0), q = 2 + 3 * uniform(9, Draw::test, k, 1);
      z += 0.008 * std::sin(q * (p.x() * std::cos(a) + p.y() * std::sin(a)) + 6 * uniform(9, Draw::test, k, 2));
    }
    return z;
  });
  const Drive d = drive(rough, route_through({{0, 0}, {28, 0}}, 0), load_vehicle("cart"), brisk(), 9);
  ASSERT_EQ(d.end, DriveEnd::finished) << d.cause;
  double pitch = 0, roll = 0, heave = 0;
  for (const Pose& X : d.path.X_WB) {
    const YawPitchRoll angles = yaw_pitch_roll(X.linear());
    pitch += angles.pitch_rad * angles.pitch_rad;
    roll += angles.roll_rad * angles.roll_rad;
    heave += X.translation().z() * X.translation().z();
  }
  const double n = static_cast<double>(d.path.size());
  // Ground of 1.6 cm rms with waves of 1.3 to 3 m: slopes of about 3 degrees, which wheelbase and track smooth.
  EXPECT_GT(std::sqrt(pitch / n), 0.5 * deg);
  EXPECT_LT(std::sqrt(pitch / n), 4 * deg);
  EXPECT_GT(std::sqrt(roll / n), 0.5 * deg);
  EXPECT_LT(std::sqrt(roll / n), 4 * deg);
  EXPECT_LT(std::sqrt(heave / n), 0.03);
}

TEST(Drive, SameSeedGivesTheSameBitsAndAnotherSeedDoesNot) {
  const World world = plain([](const Vec2& p) { return 0.02 * std::sin(3 * p.x() + 2 * p.y()); });
  const Route route = route_through({{0, 0}, {10, 0}, {14, 5}}, 1.5);
  const Vehicle cart = load_vehicle("cart");
  const Drive a = drive(world, route, cart, brisk(), 10), b = drive(world, route, cart, brisk(), 10);
  ASSERT_EQ(a.path.size(), b.path.size());
  for (size_t i = 0; i < a.path.size(); ++i)
    ASSERT_EQ(a.path.X_WB[i].matrix(), b.path.X_WB[i].matrix()) << "pose " << i;
  const Drive c = drive(world, route, cart, brisk(), 11);
  EXPECT_NE(a.path.X_WB.back().matrix(), c.path.X_WB.back().matrix());
}

TEST(Drive, ItsStretchesAreTheWholeAndWhatStaysOfALongPathIsItsEnd) {
  const World world = plain(level);
  const Route route = route_through({{0, 0}, {30, 0}}, 1.5);
  DriveSettings slow = brisk();
  slow.stop_min_s = slow.stop_max_s = 60;
  const Drive whole = drive(world, route, load_vehicle("cart"), slow, 10);
  Drive sum;
  size_t stretches = 0, underway = 0;
  const Drive left = drive(world, route, load_vehicle("cart"), slow, 10, [&](Drive&& stretch) {
    ++stretches;
    underway += stretch.end == DriveEnd::underway;
    append(sum, stretch);
  });
  EXPECT_GT(stretches, 12u);
  EXPECT_EQ(underway, stretches - 1);
  EXPECT_EQ(sum.end, DriveEnd::finished);
  EXPECT_EQ(sum.driven_m, whole.driven_m);
  EXPECT_EQ(sum.path.stamp_s, whole.path.stamp_s);
  for (size_t i = 0; i < whole.path.size(); ++i) ASSERT_EQ(sum.path.X_WB[i].matrix(), whole.path.X_WB[i].matrix());
  EXPECT_LT(left.path.size(), whole.path.size());
  EXPECT_GE(left.path.stamp_s.back() - left.path.stamp_s.front(), 59);
  EXPECT_EQ(left.path.stamp_s.back(), whole.path.stamp_s.back());
}

TEST(Drive, DrivesAtTheSameTimeOnSevenThreadsGiveTheBitsOfOneAlone) {
  const World world = plain([](const Vec2& p) { return 0.02 * std::sin(3 * p.x() + 2 * p.y()); });
  const Route route = route_through({{0, 0}, {6, 0}, {9, 3}}, 1.5);
  const auto driven = [&](const char* vehicle) {
    DriveSettings settings = brisk();
    settings.robot_speed_mps = 0.5;
    return drive(world, route, load_vehicle(vehicle), settings, 10).path;
  };
  const Trajectory alone[2] = {driven("cart"), driven("groundhog")};
  set_threads(7);
  std::vector<Trajectory> together(7);
  parallel_for(together.size(), [&](size_t i) { together[i] = driven(i % 2 ? "groundhog" : "cart"); });
  set_threads(0);
  for (size_t i = 0; i < together.size(); ++i) {
    const Trajectory& one = alone[i % 2];
    ASSERT_EQ(together[i].size(), one.size()) << "drive " << i;
    for (size_t k = 0; k < one.size(); ++k)
      ASSERT_EQ(together[i].X_WB[k].matrix(), one.X_WB[k].matrix()) << "drive " << i;
  }
}

TEST(Drive, IsBlockedByAWallAndSaysWhere) {
  World world = plain(level);
  add_wall(world, 6, -8, 8);
  const Drive d = drive(world, route_through({{0, 0}, {20, 0}}, 0), load_vehicle("cart"), brisk(), 12);
  EXPECT_EQ(d.end, DriveEnd::blocked);
  EXPECT_NEAR(d.path.X_WB.back().translation().x(), 5.45, 0.05);  // the front wheels' treads are 0.55 m ahead
  EXPECT_THAT(d.cause, HasSubstr("cart is blocked at (5.4"));
  EXPECT_THAT(d.cause, HasSubstr("against the rib of part 7"));
  EXPECT_THAT(d.cause, testing::ContainsRegex("5.[45] m along the route"));
  EXPECT_NEAR(d.driven_m, 5.45, 0.05);
}

TEST(Drive, IsBlockedWhereItsSideDoesNotPassAndNamesTheRib) {
  World world = plain(level);
  add_wall(world, 6, 0.2, 8);
  const Drive d = drive(world, route_through({{0, 0}, {20, 0}}, 0), load_vehicle("cart"), brisk(), 13);
  EXPECT_EQ(d.end, DriveEnd::blocked);
  EXPECT_THAT(d.cause, HasSubstr("the rib of part 7"));
}

TEST(Drive, FallsWhereTheFloorEndsAndSaysSo) {
  const World world = terrain_world({-2, -3}, {6, 3}, 0.5, level);
  const Drive d = drive(world, route_through({{0, 0}, {20, 0}}, 0), load_vehicle("cart"), brisk(), 14);
  EXPECT_EQ(d.end, DriveEnd::fell);
  EXPECT_THAT(d.cause, HasSubstr("fell at ("));
}

TEST(Drive, TipsOverOnASlopeTooSteepAndSaysSo) {
  const World world = terrain_world({-2, -3}, {30, 3}, 0.25, [](const Vec2& p) {
    return p.y() * std::tan(55 * deg) * std::clamp((p.x() - 4) / 6, 0.0, 1.0);
  });
  const Drive d = drive(world, route_through({{0, 0}, {25, 0}}, 0), load_vehicle("cart"), brisk(), 15);
  EXPECT_NE(d.end, DriveEnd::finished);
  EXPECT_FALSE(d.cause.empty());
}

TEST(Drive, APassageNarrowerThanTheVehicleIsAnError) {
  const World world = tunnel_world(20, 0.6, 2);
  Route route = route_through({{2, 0}, {15, 0}}, 0);
  route.passages = {0};
  EXPECT_THAT(error_of(world, route), HasSubstr("passage 0 is 0.60 m wide and cart 0.70 m"));
}

TEST(Drive, AStartInRockIsAnError) {
  const World world = tunnel_world(20, 3, 2);
  EXPECT_THAT(error_of(world, route_through({{2, 1.4}, {15, 1.4}}, 0)), HasSubstr("would stand in rock"));
  EXPECT_THAT(error_of(world, route_through({{-4, 0}, {15, 0}}, 0)), HasSubstr("would stand in rock"));
}

TEST(Drive, ARouteThroughAPillarIsAnError) {
  const World world = ring_world(18, 3.6, 2, 0.4);
  EXPECT_THAT(error_of(world, route_through({{-7.2, -7.2}, {7.2, 7.2}}, 0)), HasSubstr("lies in the rock"));
}

DriveSettings scanning() {
  DriveSettings settings;
  settings.lead_in_s = 1;
  settings.scan_every_m = 2;
  settings.scan_stop_s = 6;
  settings.robot_speed_mps = 0.3;
  return settings;
}

TEST(Drive, ARobotStopsForAScanEveryFewMetresAndArrives) {
  const Drive d = drive(plain(level), route_through({{0, 0}, {7, 0}}, 0), load_vehicle("groundhog"), scanning(), 1);
  ASSERT_EQ(d.end, DriveEnd::finished) << d.cause;
  for (const double stop_m : {2.0, 4.0, 6.0}) {
    double stood = 0;
    for (const Pose& X : d.path.X_WB) stood += std::abs(X.translation().x() - stop_m) < 0.03 ? 1.0 / 120 : 0;
    EXPECT_NEAR(stood, 6, 1.2) << "at " << stop_m;  // and what it takes to brake and to start
  }
  EXPECT_LT(cross_track_m(d.path, d.route), 0.02);
}

TEST(Drive, ARobotTurnsOnTheSpotInADeadEndAndComesBack) {
  const World tunnel = tunnel_world(12, 2.9, 1.6, 0.5);
  const Route route = route_through({{2, 0}, {9.5, 0}, {2, 0}}, 0);
  DriveSettings settings = scanning();
  settings.scan_every_m = 0;
  const Drive d = drive(tunnel, route, load_vehicle("groundhog"), settings, 1);
  ASSERT_EQ(d.end, DriveEnd::finished) << d.cause;
  EXPECT_LT(cross_track_m(d.path, route), 0.2);
  EXPECT_LT((d.path.X_WB.back().translation() - d.path.X_WB.front().translation()).norm(), 0.2);
  EXPECT_NEAR(std::abs(wrap_angle(flatten(d.path.X_WB.back()).yaw_rad - flatten(d.path.X_WB.front()).yaw_rad)),
              std::numbers::pi, 0.1);
}

// On uneven ground the tyres bear unlike loads, and what turns moves: by 0.7 and 0.8 m in half a turn here, were it let.
TEST(Drive, ARobotThatTurnsOnUnevenGroundKeepsItsPlace) {
  DriveSettings settings = scanning();
  settings.scan_every_m = 0;
  for (const int k : {0, 6}) {
    const World rough = terrain_world({-1, -4}, {10, 4}, 0.25, [=](const Vec2& p) {
      return 0.035 * std::sin(3 * p.x() + k) * std::cos(2.6 * p.y() + 2 * k) +
             0.02 * std::sin(1.3 * p.x() + 2.1 * p.y() + k);
    });
    const Route route = route_through({{4, 0}, {6, 0}, {4, 0}}, 0);
    const Drive d = drive(rough, route, load_vehicle("groundhog"), settings, 1);
    EXPECT_EQ(d.end, DriveEnd::finished) << d.cause;
    EXPECT_LT(cross_track_m(d.path, route), 0.5) << "ground " << k;
  }
}

TEST(Drive, SettingsThatExcludeOneAnotherAreAnError) {
  DriveSettings settings;
  settings.sample_hz = 150;
  EXPECT_THROW(drive(plain(level), route_through({{0, 0}, {5, 0}}, 0), load_vehicle("cart"), settings, 1), Error);
}

}  // namespace
}  // namespace adit
