// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "sensors/beam.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

const Hull hull{{"far", {3, -1, -1}, {4, 1, 1}, Label::vehicle}, {"near", {2, -1, -1}, {2.5, 1, 0.2}, Label::pusher}};

TEST(Beam, MeetsTheNearestBoxAndTellsWhatItIs) {
  const Meeting low = meet_hull(hull, {0, 0, 0}, {1, 0, 0}, 0.3);
  EXPECT_DOUBLE_EQ(low.range_m, 2);
  EXPECT_EQ(low.label, Label::pusher);
  EXPECT_EQ(low.face, -1);
  EXPECT_DOUBLE_EQ(low.reflectivity, 0.3);
  const Meeting high = meet_hull(hull, {0, 0, 0.5}, {1, 0, 0}, 0.3);
  EXPECT_DOUBLE_EQ(high.range_m, 3);
  EXPECT_EQ(high.label, Label::vehicle);
}

TEST(Beam, IncidenceIsTheAngleToTheSidesNormal) {
  const Meeting met = meet_hull(hull, {0, 0, 0}, Vec3(std::cos(0.3), std::sin(0.3), 0), 0.3);
  EXPECT_NEAR(met.incidence_rad(), 0.3, 1e-12);
  EXPECT_NEAR(met.range_m, 2 / std::cos(0.3), 1e-12);
}

TEST(Beam, PassesBoxesBehindBesideAndAroundIt) {
  EXPECT_EQ(meet_hull(hull, {0, 0, 0}, {-1, 0, 0}, 0.3).range_m, INFINITY);
  EXPECT_EQ(meet_hull(hull, {0, 2, 0}, {1, 0, 0}, 0.3).range_m, INFINITY);
  EXPECT_DOUBLE_EQ(meet_hull(hull, {2.2, 0, 0}, {1, 0, 0}, 0.3).range_m, 0.8);  // out of "near", its housing
}

TEST(Beam, MeetsABoxWhereAMeshOfTheSameBoxIsMet) {
  const Vec3 low(-0.4, -0.3, 0.1), high(0.5, 0.2, 0.9);
  const Mesh mesh = box_mesh(low, high);
  const Caster caster(mesh);
  const Hull box{{"box", low, high, Label::vehicle}};
  int met = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const auto draw = [&](std::uint64_t j) { return normal(1, Draw::test, i, j); };
    const Vec3 origin = 3 * Vec3(draw(0), draw(1), draw(2)).normalized();  // outside of the box
    const Vec3 aim = 0.4 * Vec3(draw(3), draw(4), draw(5)) - origin;
    const Ray ray{origin, aim.normalized()};
    const Hit hit = caster.nearest(ray);
    const Meeting by_mesh = meeting_of(mesh, hit, 0.3);
    const Meeting by_box = meet_hull(box, ray.origin, ray.direction, 0.3);
    // A graze within the floats of the tree may go either way; none of these rays does.
    ASSERT_EQ(std::isfinite(by_mesh.range_m), std::isfinite(by_box.range_m)) << i;
    if (!std::isfinite(by_box.range_m)) continue;
    ++met;
    EXPECT_NEAR(by_mesh.range_m, by_box.range_m, 1e-6) << i;
    EXPECT_NEAR(by_mesh.incidence_rad(), by_box.incidence_rad(), 1e-6) << i;
  }
  EXPECT_GT(met, 500);
}

}  // namespace
}  // namespace adit
