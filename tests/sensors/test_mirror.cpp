// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/mirror.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

TEST(Mirror, WaterReflectsTwoPercentHeadOnAndAllOfItAtAGraze) {
  EXPECT_NEAR(water_reflectance(1), std::pow(0.33 / 2.33, 2), 1e-12);
  EXPECT_NEAR(water_reflectance(1e-9), 1, 1e-6);
  EXPECT_NEAR(water_reflectance(std::cos(60 * M_PI / 180)), 0.0594, 5e-4);  // a textbook's 6 %
}

TEST(Mirror, TheRoofAppearsAsFarBelowTheFloorAsItIsAbove) {
  const Mesh tunnel = box_mesh({0, -2, 0}, {40, 2, 2});
  const Caster caster(tunnel);
  // From 1 m up, down at 45 deg: the floor at 1.414 m, then up to the roof 2 m higher.
  const Ray ray{{5, 0, 1}, Vec3(1, 0, -1).normalized()};
  const Meeting floor = meeting_of(tunnel, caster.nearest(ray), 0.5), seen = seen_in_water(caster, ray, floor, 0.5);
  EXPECT_NEAR(seen.range_m, 3 * std::sqrt(2), 1e-3);
  EXPECT_NEAR((ray.origin + seen.range_m * ray.direction).z(), -2, 1e-3);  // the ghost
  const double share = water_reflectance(std::sqrt(0.5));
  EXPECT_NEAR(seen.effective_reflectivity(), floor.reflectivity * std::sqrt(0.5) * share * share, 1e-9);
}

TEST(Mirror, LookedAtFromAboveWaterIsSeenItself) {
  const Mesh tunnel = box_mesh({0, -2, 0}, {40, 2, 2});
  const Caster caster(tunnel);
  const Ray ray{{5, 0, 1}, Vec3(0.1, 0, -1).normalized()};
  const Meeting floor = meeting_of(tunnel, caster.nearest(ray), 0.5);
  EXPECT_EQ(seen_in_water(caster, ray, floor, 0.5).range_m, floor.range_m);
}

}  // namespace
}  // namespace adit
