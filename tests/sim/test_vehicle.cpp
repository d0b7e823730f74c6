// SPDX-License-Identifier: BSD-3-Clause
#include "base/bundled.h"
#include "base/error.h"
#include "base/files.h"
#include "sim/vehicle.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace adit {
namespace {

using testing::HasSubstr;

// A vehicle's file with one text replaced by another, as a file of its own.
std::string error_of_changed(const std::string& from, const std::string& to, const std::string& name = "cart") {
  std::string text(bundled("sim/vehicles/" + name + ".toml"));
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const std::string file = scratch("vehicle_") + std::to_string(std::hash<std::string>{}(to)) + ".toml";
  write_text(file, text);
  std::string what;
  try {
    load_vehicle(file);
  } catch (const Error& error) {
    what = error.what();
  }
  std::filesystem::remove(file);
  return what;
}

TEST(Vehicle, TheCartStandsOnTwoFixedWheelsAndTwoCastors) {
  const Vehicle cart = load_vehicle("cart");
  EXPECT_EQ(cart.wheels.size(), 4u);
  EXPECT_DOUBLE_EQ(cart.axle_x_m(), -0.4);
  EXPECT_DOUBLE_EQ(cart.total_mass_kg(), 97);
  EXPECT_DOUBLE_EQ(cart.width_m(), 0.7);
}

TEST(Vehicle, GroundhogIsDrivenOnFourWheels) {
  const Vehicle robot = load_vehicle("groundhog");
  EXPECT_EQ(robot.drivetrain, Drivetrain::skid_steer);
  EXPECT_DOUBLE_EQ(robot.total_mass_kg(), 700);
  EXPECT_DOUBLE_EQ(robot.axle_x_m(), 0);
  EXPECT_DOUBLE_EQ(robot.track_m(), 0.9);
  EXPECT_DOUBLE_EQ(robot.width_m(), 1.1);
}

TEST(Vehicle, WhatDoesNotGoWithTheKindOfDriveIsNamed) {
  EXPECT_THAT(error_of_changed("kind = \"castor\"", "kind = \"driven\""), HasSubstr("driven"));
  EXPECT_THAT(error_of_changed("drive = \"pushed\"", "drive = \"skid_steer\""), HasSubstr("motors.torque_max_nm"));
  EXPECT_THAT(error_of_changed("drive = \"pushed\"", "drive = \"tracked\""), HasSubstr("drive"));
  EXPECT_THAT(error_of_changed("turn_gain = 3.09", "", "groundhog"), HasSubstr("motors.turn_gain"));
  EXPECT_THAT(error_of_changed("drive = \"skid_steer\"", "drive = \"pushed\"", "groundhog"),
              HasSubstr("push.handle_m"));
}

TEST(Vehicle, ThePusherStandsInTheRaysButDoesNotCollide) {
  const Vehicle cart = load_vehicle("cart");
  int pushers = 0;
  for (const Box& box : cart.hull) pushers += box.label == Label::pusher;
  EXPECT_EQ(pushers, 1);
  for (const Box& box : cart.solid) EXPECT_EQ(box.label, Label::vehicle);
}

TEST(Vehicle, MistakesInTheFileAreNamed) {
  EXPECT_THAT(error_of_changed("mass_kg = 85.0", "mass_kgs = 85.0"), HasSubstr("mass_kgs"));
  EXPECT_THAT(error_of_changed("mass_kg = 85.0", "mass_kg = -85.0"), HasSubstr("mass_kg"));
  EXPECT_THAT(error_of_changed("kind = \"castor\"", "kind = \"caster\""), HasSubstr("kind"));
  EXPECT_THAT(error_of_changed("radius_m = 0.15\n", ""), HasSubstr("radius_m"));
  EXPECT_THAT(error_of_changed("[-0.03, 0.0, 0.45]", "[-0.6, 0.0, 0.45]"), HasSubstr("tip"));
  EXPECT_THAT(error_of_changed("max_m = [0.45, 0.35, 0.45]", "max_m = [-0.6, 0.35, 0.45]"), HasSubstr("max_m"));
}

}  // namespace
}  // namespace adit
