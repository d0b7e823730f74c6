// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground.h"
#include "sim/physics.h"
#include "tests/sim/terrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;
constexpr double step_s = 1.0 / 240;
constexpr double g = 9.81;

World flat(double cell_m) {
  return terrain_world({-10, -5}, {40, 5}, cell_m, [](const Vec2&) { return 0.0; });
}

World ramp(double slope_rad, double cell_m = 0.5) {  // rises along x
  return terrain_world({-30, -5}, {30, 5}, cell_m, [=](const Vec2& p) { return p.x() * std::tan(slope_rad); });
}

// Wheels of equal load: tilts of the tyres cancel where the hands touch nothing.
Vehicle free_cart() {
  Vehicle cart = load_vehicle("cart");
  for (Wheel& wheel : cart.wheels) wheel.bearing_Nm = 0;
  return cart;
}

double rolling_mass_kg(const Vehicle& cart) {
  double mass = cart.mass_kg;
  for (const Wheel& wheel : cart.wheels) mass += 1.4 * wheel.mass_kg;  // a rolling ball: m + (2/5) m r^2 / r^2
  return mass;
}

Pose settled(Physics& physics, double time_s = 3) {
  for (int k = 0; k < time_s / step_s; ++k) physics.step({.brake = true});
  return physics.motion().X_WB;
}

TEST(Physics, FreeFallIsHalfGTimesTimeSquared) {
  const World world = flat(1);
  const Vehicle cart = free_cart();
  Physics physics(world.mesh, cart, pose_of({0, 0, 8}, 0.3), step_s);
  const int n = 240;
  for (int k = 0; k < n; ++k) physics.step({});
  const double fallen = g * step_s * step_s * n * (n + 1) / 2;  // the sum that steps of equal length make of g t^2 / 2
  EXPECT_NEAR(physics.motion().X_WB.translation().z(), 8 - fallen, 1e-9);
  EXPECT_NEAR(physics.motion().v_W.z(), -g, 1e-9);
  EXPECT_NEAR(fallen, g / 2, 0.03);
}

TEST(Physics, StandsLevelAtHeightZeroOnALevelFloor) {
  const World world = flat(0.3);
  const Vehicle cart = load_vehicle("cart");
  Physics physics(world.mesh, cart, pose_of({0, 0, 0}, 0), step_s);
  const Pose X = settled(physics);
  const YawPitchRoll angles = yaw_pitch_roll(X.linear());
  EXPECT_NEAR(X.translation().z(), 0, 1e-5);  // the tyres' give is that of the statics
  EXPECT_NEAR(X.translation().norm(), 0, 1e-3);
  EXPECT_NEAR(angles.pitch_rad, 0, 0.01 * deg);
  EXPECT_NEAR(angles.roll_rad, 0, 0.01 * deg);
}

TEST(Physics, StandsInAPoolAsOnTheDryFloor) {
  const World dry = flat(0.3);
  World pool = dry;
  // Its surface cuts through the frame.
  const World surface = terrain_world({-2, -2}, {2, 2}, 0.1, [](const Vec2&) { return 0.4; });
  for (const auto& face : surface.mesh.face) {
    std::array<std::uint32_t, 3> corners;
    for (size_t k = 0; k < 3; ++k) corners[k] = face[k] + static_cast<std::uint32_t>(dry.mesh.vertex.size());
    pool.mesh.face.push_back(corners);
    pool.mesh.label.push_back(Label::water);
  }
  pool.mesh.vertex.insert(pool.mesh.vertex.end(), surface.mesh.vertex.begin(), surface.mesh.vertex.end());
  for (const char* name : {"cart", "groundhog"}) {
    const Vehicle vehicle = load_vehicle(name);
    Physics on_floor(dry.mesh, vehicle, pose_of({0, 0, 0}, 0), step_s),
        in_pool(pool.mesh, vehicle, pose_of({0, 0, 0}, 0), step_s);
    const Pose there = settled(on_floor), here = settled(in_pool);
    EXPECT_TRUE(here.matrix().isApprox(there.matrix(), 1e-9)) << name << "\n" << here.matrix();
    EXPECT_FALSE(in_pool.touched_face()) << name;
  }
}

TEST(Physics, PitchOnARampIsItsSlope) {
  for (const double slope : {-10 * deg, 4 * deg, 10 * deg}) {
    const World world = ramp(slope);
    const Vehicle cart = load_vehicle("cart");
    Physics physics(world.mesh, cart, stand_on(height_of(Floor(world.mesh)), cart, {0.2, 0.1}, 0), step_s);
    const Pose X = settled(physics);
    // Load moves from the upper to the lower axle by m g sin(slope) h / wheelbase and presses two tyres of 60 kN/m in.
    const double sag = cart.mass_kg * g * std::sin(slope) * 0.45 / 0.8 / (2 * 60e3) * 2 / 0.8;
    EXPECT_NEAR(yaw_pitch_roll(X.linear()).pitch_rad, -slope - sag, 0.05 * deg) << "slope " << slope / deg;
    EXPECT_LT(physics.motion().v_W.norm(), 1e-3) << "slope " << slope / deg;
  }
}

TEST(Physics, RollOnASideSlopeIsTheSlope) {
  const double slope = 6 * deg;
  const World world = terrain_world({-5, -5}, {5, 5}, 0.5, [=](const Vec2& p) { return p.y() * std::tan(slope); });
  const Vehicle cart = load_vehicle("cart");
  Physics physics(world.mesh, cart, stand_on(height_of(Floor(world.mesh)), cart, {0, 0}, 0), step_s);
  const Pose X = settled(physics);
  const double sag = cart.mass_kg * g * std::sin(slope) * 0.45 / 0.65 / (2 * 60e3) * 2 / 0.65;
  EXPECT_NEAR(yaw_pitch_roll(X.linear()).roll_rad, slope + sag, 0.05 * deg);
}

// Front wheels, or those of one side, on a tie or rail of 0.10 to 0.15 m: 4 to 11 degrees of pitch, 6 to 13 of roll.
TEST(Physics, ATieOrRailUnderTwoWheelsTipsAVehicleByItsHeightOverWheelbaseOrTrack) {
  for (const char* name : {"cart", "groundhog"})
    for (const double height_m : {0.10, 0.15}) {
      const Vehicle vehicle = load_vehicle(name);
      const Vec2 half = vehicle.wheels[0].position_B.cwiseAbs();
      for (const bool ahead : {true, false}) {
        const World world = terrain_world(
            {-2, -2}, {2, 2}, 0.1, [=](const Vec2& p) { return (ahead ? p.x() : p.y()) > 0.04 ? height_m : 0.0; });
        Physics physics(world.mesh, vehicle, stand_on(height_of(Floor(world.mesh)), vehicle, {0, 0}, 0), step_s);
        const YawPitchRoll a = yaw_pitch_roll(settled(physics).linear());
        // The hubs' heights differ by the tie's; tyres of the lower wheels, which bear more, give way by 0.2 degrees.
        EXPECT_NEAR(ahead ? -a.pitch_rad : a.roll_rad, std::asin(height_m / (2 * (ahead ? half.x() : half.y()))),
                    0.35 * deg)
            << name << " " << height_m;
        EXPECT_NEAR(ahead ? a.roll_rad : a.pitch_rad, 0, 0.1 * deg) << name << " " << height_m;
      }
    }
}

TEST(Physics, RollsDownARampWithTheAccelerationOfItsMassAndItsTurningWheels) {
  const double slope = 5 * deg;
  const World world = ramp(slope);
  const Vehicle cart = free_cart();
  Physics physics(world.mesh, cart, stand_on(height_of(Floor(world.mesh)), cart, {20, 0}, std::numbers::pi), step_s);
  settled(physics);
  physics.rest();
  const Vec3 start = physics.motion().X_WB.translation();
  const double time_s = 3;
  for (int k = 0; k < time_s / step_s; ++k) physics.step({});
  const double rolled = (physics.motion().X_WB.translation() - start).norm();
  const double a = cart.total_mass_kg() * g * std::sin(slope) / rolling_mass_kg(cart);
  EXPECT_NEAR(rolled / (0.5 * a * time_s * time_s), 1, 0.01);
}

TEST(Physics, RollsOverTheEdgesOfAFineMeshAsOverOnePlane) {
  const Vehicle cart = free_cart();
  for (const double cell_m : {50.0, 0.3, 0.05}) {
    const World world = flat(cell_m);
    Physics physics(world.mesh, cart, pose_of({0, 0, 0}, 0.02), step_s);
    settled(physics);
    for (int k = 0; k < 240; ++k) physics.step({.force_N = 80});
    double highest = 0, steepest = 0;
    for (int k = 0; k < 1200; ++k) {
      physics.step({});
      const Pose X = physics.motion().X_WB;
      if (k < 240) continue;  // the frame swings on its tyres when the push ends
      highest = std::max(highest, std::abs(X.translation().z()));
      steepest = std::max(steepest, std::abs(yaw_pitch_roll(X.linear()).pitch_rad));
    }
    EXPECT_LT(highest, 2e-4) << "cell " << cell_m;
    EXPECT_LT(steepest, 0.03 * deg) << "cell " << cell_m;
    EXPECT_GT(physics.motion().v_W.norm(), 0.5) << "cell " << cell_m;
  }
}

TEST(Physics, EnergyDoesNotGrowOnRoughGround) {
  const World world = terrain_world({-25, -6}, {25, 6}, 0.25, [](const Vec2& p) {
    return 0.02 * p.x() + 0.03 * std::sin(4 * p.x() + p.y()) + 0.02 * std::sin(7 * p.y() - 3 * p.x());
  });
  Vehicle cart = load_vehicle("cart");
  Physics physics(world.mesh, cart, stand_on(height_of(Floor(world.mesh)), cart, {15, 0}, std::numbers::pi), step_s);
  settled(physics);
  double least = physics.energy_J();
  for (int k = 0; k < 2400; ++k) {
    physics.step({});
    EXPECT_LT(physics.energy_J(), least + 5)
        << "step " << k;  // what four tyres can store: 4 * (2 * 250 N)^2 / (2 * 60 kN/m) = 8 J
    least = std::min(least, physics.energy_J());
  }
}

TEST(Physics, FloorsBeyondAMillionFacesCarry) {
  const World world = terrain_world({0, 0}, {80, 80}, 0.1, [](const Vec2&) { return 1.5; });
  ASSERT_GT(world.mesh.face.size(), size_t{1} << 20);
  const Vehicle cart = load_vehicle("cart");
  // In the last part of the mesh, for Bullet counts triangles in parts.
  Physics physics(world.mesh, cart, pose_of({75, 75, 1.5}, 0), step_s);
  EXPECT_NEAR(settled(physics, 0.5).translation().z(), 1.5, 1e-3);
}

TEST(Physics, TheFrameIsStoppedByAWallAndNamesItsFace) {
  World world = flat(1);
  add_wall(world, 3, -5, 5);
  Vehicle cart = free_cart();
  for (Box& box : cart.solid) box.max_B.x() = 0.7;  // a frame that reaches farther than its wheels
  Physics physics(world.mesh, cart, pose_of({0, 0, 0}, 0), step_s);
  settled(physics);
  EXPECT_FALSE(physics.touched_face().has_value());
  for (int k = 0; k < 1200; ++k) physics.step({.force_N = 60});
  EXPECT_NEAR(physics.motion().X_WB.translation().x(), 2.3, 0.03);
  ASSERT_TRUE(physics.touched_face().has_value());
  EXPECT_EQ(world.mesh.label[*physics.touched_face()], Label::rib);
}

}  // namespace
}  // namespace adit
