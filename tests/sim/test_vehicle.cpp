// SPDX-License-Identifier: BSD-3-Clause
#include "base/bundled.h"
#include "base/error.h"
#include "base/files.h"
#include "sim/vehicle.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

namespace adit {
namespace {

using testing::HasSubstr;

// The cart's file with one text replaced by another, as a file of its own.
std::string error_of_changed(const std::string& from, const std::string& to) {
  std::string text(bundled("sim/vehicles/cart.toml"));
  const size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const std::string file =
      testing::TempDir() + "adit_vehicle_" + std::to_string(std::hash<std::string>{}(to)) + ".toml";
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
