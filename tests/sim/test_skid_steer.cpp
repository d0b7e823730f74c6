// SPDX-License-Identifier: BSD-3-Clause
#include "sim/autopilot.h"
#include "sim/ground.h"
#include "sim/physics.h"
#include "tests/sim/terrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;
constexpr double g = 9.81;
constexpr double step_s = 1.0 / 240;

World flat() {
  return terrain_world({-10, -10}, {30, 10}, 0.5, [](const Vec2&) { return 0.0; });
}

// Brakes for a while; where it then stands.
Pose settled(Physics& physics, double time_s = 2, double dt_s = step_s) {
  for (int k = 0; k < time_s / dt_s; ++k) physics.step({.brake = true});
  return physics.motion().X_WB;
}

// Mean turn rate and speed of a command after a second of getting under way.
struct Rate {
  double turn_rad_s, speed_mps;
};
Rate achieved(const World& world, const Vehicle& robot, const Intent& intent, double step_hz) {
  Physics physics(world.mesh, robot, pose_of({0, 0, 0}, 0), 1 / step_hz);
  settled(physics, 1, 1 / step_hz);
  const Effort effort = steer(robot, intent, 0);
  for (int k = 0; k < step_hz; ++k) physics.step(effort);
  const double before = flatten(physics.motion().X_WB).yaw_rad;
  double way = 0;
  for (int k = 0; k < 2 * step_hz; ++k) {
    physics.step(effort);
    way += physics.motion().X_WB.linear().col(0).dot(physics.motion().v_W) / step_hz;
  }
  return {wrap_angle(flatten(physics.motion().X_WB).yaw_rad - before) / 2, way / 2};
}

// Four equal tyres that scrub: Coulomb's force lies against each tyre's slip, so in a steady turn the slips stand to each
// other as wheelbase to track, and the sides run 1 + (wheelbase / track)^2 times as far apart as without slip.
TEST(SkidSteer, TurnsAsCoulombFrictionOnFourTyresHasItWhateverTheStep) {
  const World world = flat();
  const Vehicle robot = load_vehicle("groundhog");
  EXPECT_NEAR(robot.motors.turn_gain, 1 + std::pow(1.3 / 0.9, 2), 0.005);
  for (const double speed : {0.0, 0.15})
    for (const double turn : {4 * deg, -8 * deg}) {
      const Intent intent{speed, turn, false};
      const Rate coarse = achieved(world, robot, intent, 240), fine = achieved(world, robot, intent, 1000);
      EXPECT_NEAR(coarse.turn_rad_s / turn, 1, 0.03) << "speed " << speed << " turn " << turn / deg;
      EXPECT_NEAR(coarse.turn_rad_s / fine.turn_rad_s, 1, 0.03) << "speed " << speed << " turn " << turn / deg;
    }
}

TEST(SkidSteer, TurnsOnTheSpotAboutItsMiddle) {
  const World world = flat();
  const Vehicle robot = load_vehicle("groundhog");
  Physics physics(world.mesh, robot, pose_of({0, 0, 0}, 0), step_s);
  settled(physics);
  const Effort effort = steer(robot, {0, 10 * deg, false}, 0);
  for (int k = 0; k < 9 * 240; ++k) physics.step(effort);
  EXPECT_NEAR(flatten(physics.motion().X_WB).yaw_rad, 90 * deg, 3 * deg);
  EXPECT_LT(physics.motion().X_WB.translation().norm(), 0.05);
}

TEST(SkidSteer, RollsAsFarAsItsWheelsTurn) {
  const World world = flat();
  const Rate straight = achieved(world, load_vehicle("groundhog"), {0.3, 0, false}, 240);
  EXPECT_NEAR(straight.speed_mps, 0.3, 0.3 * 0.04);  // the tyres give by 1 cm of 27.5 cm: so much the smaller they roll
  EXPECT_NEAR(straight.turn_rad_s, 0, 0.01 * deg);
}

// Braked wheels slide: v^2 / (2 mu g).
TEST(SkidSteer, StoppingDistanceIsThatOfFriction) {
  const World world = flat();
  Vehicle robot = load_vehicle("groundhog");
  robot.motors.speed_max_mps = 5;
  robot.motors.torque_max_Nm = 2000;
  for (Wheel& wheel : robot.wheels) wheel.brake_Nm = 1e4;
  for (const double friction : {0.3, 0.5}) {
    for (Wheel& wheel : robot.wheels) wheel.friction = friction;
    Physics physics(world.mesh, robot, pose_of({0, 0, 0}, 0), step_s);
    settled(physics, 1);
    for (int k = 0; k < 4 * 240; ++k) physics.step({.left_mps = 0.004 * k, .right_mps = 0.004 * k});
    const double speed = physics.motion().v_W.x(), from = physics.motion().X_WB.translation().x();
    settled(physics, 3);
    const double slid = physics.motion().X_WB.translation().x() - from;
    ASSERT_GT(speed, 2);
    EXPECT_NEAR(slid / (speed * speed / (2 * friction * g)), 1, 0.05) << "friction " << friction;
    EXPECT_LT(physics.motion().v_W.norm(), 1e-3);
  }
}

// What stands by friction stands up to the slope whose tangent is the coefficient.
TEST(SkidSteer, BrakedStandsOnARampBelowTheAngleOfFrictionAndSlidesAboveIt) {
  Vehicle robot = load_vehicle("groundhog");
  for (Wheel& wheel : robot.wheels) wheel.friction = 0.3, wheel.brake_Nm = 1e4;  // atan 0.3 = 16.7 degrees
  for (const double slope : {15 * deg, 18.5 * deg}) {
    const World world = terrain_world({-30, -5}, {30, 5}, 0.5, [=](const Vec2& p) { return p.x() * std::tan(slope); });
    Physics physics(world.mesh, robot, stand_on(height_of(Floor(world.mesh)), robot, {0, 0}, 0), step_s);
    const Vec3 begin = settled(physics, 1).translation();
    const double t = 2, slid = (settled(physics, t).translation() - begin).norm();
    if (slope < 16 * deg)
      EXPECT_LT(slid, 2e-3);
    else  // from the second second on: a (t + t^2 / 2), a = g (sin - mu cos)
      EXPECT_NEAR(slid / (g * (std::sin(slope) - 0.3 * std::cos(slope)) * (t + t * t / 2)), 1, 0.1);
  }
}

TEST(SkidSteer, ClimbsARampAtTheSpeedOfItsWheels) {
  const World world = terrain_world({-30, -5}, {30, 5}, 0.5, [](const Vec2& p) { return p.x() * std::tan(10 * deg); });
  const Vehicle robot = load_vehicle("groundhog");
  Physics physics(world.mesh, robot, stand_on(height_of(Floor(world.mesh)), robot, {0, 0}, 0), step_s);
  settled(physics, 1);
  for (int k = 0; k < 2 * 240; ++k) physics.step({.left_mps = 0.15, .right_mps = 0.15});
  EXPECT_NEAR(physics.motion().v_W.norm() / 0.15, 1, 0.03);
}

TEST(SkidSteer, StandsWithoutATremble) {
  const World world = terrain_world(
      {-5, -5}, {5, 5}, 0.25, [](const Vec2& p) { return 0.05 * p.x() + 0.02 * std::sin(3 * p.x() + 2 * p.y()); });
  const Vehicle robot = load_vehicle("groundhog");
  Physics physics(world.mesh, robot, stand_on(height_of(Floor(world.mesh)), robot, {0.3, 0.2}, 0.7), step_s);
  const Vec3 still = settled(physics, 3).translation();
  for (int k = 0; k < 2 * 240; ++k) {
    physics.step({.brake = true});
    ASSERT_LT((physics.motion().X_WB.translation() - still).norm(), 1e-4) << "step " << k;
    ASSERT_LT(physics.motion().v_W.norm(), 1e-3) << "step " << k;
  }
}

TEST(SkidSteer, PushesALooseBlockAheadAndNothingFliesApart) {
  const World world = flat();
  const Vehicle robot = load_vehicle("groundhog");
  const Loose block{{0.5, 0.8, 0.5}, 60, pose_of({1.8, 0.1, 0.25}, 0.2), 0.5};
  Physics physics(world.mesh, robot, pose_of({0, 0, 0}, 0), step_s, nullptr, {block});
  settled(physics, 1);
  const double begin = physics.energy_J();
  for (int k = 0; k < 6 * 240; ++k) {
    physics.step({.left_mps = 0.3, .right_mps = 0.3});
    ASSERT_LT(physics.motion().v_W.norm(), 0.4) << "step " << k;
    ASSERT_LT(physics.loose_motion(0).v_W.norm(), 0.6) << "step " << k;
  }
  // Kinetic energy of 700 and 60 kg at those speeds is 70 J; nothing rises.
  EXPECT_NEAR(physics.energy_J(), begin, 70);
  const double x = physics.motion().X_WB.translation().x(), ahead = physics.loose_motion(0).X_WB.translation().x() - x;
  EXPECT_NEAR(x, 0.3 * 6, 0.15);
  EXPECT_NEAR(ahead, 0.95 + 0.25, 0.12);  // the block lies against the nose, a little askew
}

TEST(SkidSteer, SteeringIsCutSoThatTheBendStays) {
  const Vehicle robot = load_vehicle("groundhog");
  const Effort fast = steer(robot, {10, 0, false}, 0.005), slow = steer(robot, {0.1, 0, false}, 0.005);
  EXPECT_NEAR(std::max(fast.left_mps, fast.right_mps), robot.motors.speed_max_mps, 1e-12);
  EXPECT_NEAR(fast.left_mps / fast.right_mps, slow.left_mps / slow.right_mps, 1e-12);
  EXPECT_LT(fast.left_mps, fast.right_mps);  // to the left
}

TEST(Autopilot, ATurnGoesOnTheWayThatItBeganWhereTheWayOnLiesBehind) {
  const Motors motors = load_vehicle("groundhog").motors;
  DriveSettings settings;
  settings.lead_in_s = 0;
  Autopilot pilot(settings, motors, 100);
  // Straight behind, now a hair to the left, now a hair to the right, as jolts have it.
  constexpr double step_s = 0.01;
  Intent intent;
  for (int n = 0; n < 1000; ++n) {
    Guide guide;
    guide.bearing_rad = n % 2 == 0 ? 3.14 : -3.14;
    intent = pilot.want(n * step_s, step_s, 10, guide);
    EXPECT_GE(intent.wobble_rad_s, 0) << "after " << n << " steps";
  }
  EXPECT_DOUBLE_EQ(intent.wobble_rad_s, motors.turn_max_rad_s);
  Guide beyond;  // turned past it: the short way back
  beyond.bearing_rad = -0.5;
  for (int n = 1000; n < 1400; ++n) intent = pilot.want(n * step_s, step_s, 10, beyond);
  EXPECT_DOUBLE_EQ(intent.wobble_rad_s, -motors.turn_max_rad_s);
}

}  // namespace
}  // namespace adit
