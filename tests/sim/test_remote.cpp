// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "sim/remote.h"
#include "sim/sim.h"
#include "tests/sim/terrain.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

namespace adit {
namespace {

using testing::HasSubstr;

// A file that lives as long as this does.
struct TextFile {
  explicit TextFile(const std::string& text)
      : name(scratch("commands_") + std::to_string(std::hash<std::string>{}(text)) + ".csv") {
    write_text(name, text);
  }
  ~TextFile() { std::filesystem::remove(name); }
  std::string name;
};

std::string error_of(const std::string& text) {
  const TextFile file(text);
  try {
    read_commands(file.name);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Remote, ReadsColumnsInAnyOrderAndLeavesCommentsOut) {
  const TextFile file("# a joystick\nturn_rate_rad_s, time_s, button, speed_mps\r\n0.1,0,7,0.5\r\n\n-0.2,1.5,0,0.25\n");
  const std::vector<Command> commands = read_commands(file.name);
  ASSERT_EQ(commands.size(), 2u);
  EXPECT_EQ(commands[1].time_s, 1.5);
  EXPECT_EQ(commands[1].speed_mps, 0.25);
  EXPECT_EQ(commands[0].turn_rate_rad_s, 0.1);
}

TEST(Remote, MistakesAreNamedWithTheirLine) {
  EXPECT_THAT(error_of("time_s,speed_mps\n0,1\n1,1\n"), HasSubstr(":1: has no column turn_rate_rad_s"));
  EXPECT_THAT(error_of("time_s,speed_mps,turn_rate_rad_s\n0,1,0\n1,fast,0\n"), HasSubstr(":3: speed_mps = 'fast'"));
  EXPECT_THAT(error_of("time_s,speed_mps,turn_rate_rad_s\n0,1,0\n1,1\n"), HasSubstr(":3: turn_rate_rad_s is missing"));
  EXPECT_THAT(error_of("time_s,speed_mps,turn_rate_rad_s\n1,1,0\n1,1,0\n"), HasSubstr(":3: time_s must increase"));
  EXPECT_THAT(error_of("time_s,speed_mps,turn_rate_rad_s\n0,1,0\n"), HasSubstr("two commands"));
}

World plain() {
  return terrain_world({-12, -12}, {12, 12}, 0.5, [](const Vec2&) { return 0.0; });
}

// Half a circle at 0.3 m/s and 0.15 rad/s: radius 2 m.
TEST(Remote, EitherVehicleDrivesTheCircleThatIsAskedFor) {
  const TextFile file("time_s,speed_mps,turn_rate_rad_s\n1,0.3,0.15\n22,0,0\n24,0,0\n");
  for (const char* name : {"cart", "groundhog"}) {
    DriveSettings settings;
    settings.commands = file.name;
    const Vehicle vehicle = load_vehicle(name);
    const Drive d = drive(plain(), route_through({{0, 0}, {8, 0}}, 0), vehicle, settings, 1);
    EXPECT_EQ(d.end, DriveEnd::finished) << d.cause;
    EXPECT_NEAR(d.path.stamp_s.back(), 24, 0.01);
    const double turned = flatten(d.path.X_WB.back()).yaw_rad;
    EXPECT_NEAR(turned < 0 ? turned + 2 * M_PI : turned, 21 * 0.15, 0.15) << name;
    // The way of the middle: the axle's, and the swing of an axle behind the middle.
    EXPECT_NEAR(d.driven_m, 21 * 0.3 * std::hypot(1, vehicle.axle_x_m() / 2), 0.3) << name;
    EXPECT_EQ(d.route.line.size() > 10, true);
    EXPECT_NEAR(d.route.length_m, d.driven_m, 1e-9);
    const Pose2 middle = flatten(d.path.X_WB.front()) * Pose2{vehicle.axle_x_m(), 0, 0} * Pose2{0, 2, 0};
    for (double t = 3; t < 20; t += 0.5) {
      const Vec2 axle = flatten(d.path.at(t)) * Vec2(vehicle.axle_x_m(), 0);
      EXPECT_NEAR((axle - middle.position()).norm(), 2, 0.15) << name << " at " << t << " s";
    }
  }
}

TEST(Remote, BacksAwayAndIsBlockedByAWallBehind) {
  const TextFile file("time_s,speed_mps,turn_rate_rad_s\n0,-0.2,0\n60,0,0\n");
  World world = plain();
  add_wall(world, -3, -8, 8);
  DriveSettings settings;
  settings.commands = file.name;
  const Drive d = drive(world, route_through({{0, 0}, {8, 0}}, 0), load_vehicle("groundhog"), settings, 1);
  EXPECT_EQ(d.end, DriveEnd::blocked);
  EXPECT_THAT(d.cause, HasSubstr("groundhog is blocked at (-2.0"));
  EXPECT_THAT(d.cause, HasSubstr("the rib of part 7"));
}

}  // namespace
}  // namespace adit
