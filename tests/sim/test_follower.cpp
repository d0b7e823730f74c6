// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "sim/follower.h"
#include "tests/sim/terrain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

TEST(Follower, OnACircleItSteersTheCirclesCurvature) {
  const double radius = 4;
  Route route;
  for (int i = 0; i <= 600; ++i) route.line.push_back(radius * Vec2(std::cos(0.01 * i), std::sin(0.01 * i)));
  Follower follower(route);
  for (double a = 0; a < 5; a += 0.01) {
    const Guide guide = follower.look({radius * std::cos(a), radius * std::sin(a), a + std::numbers::pi / 2}, 0.9);
    EXPECT_NEAR(guide.curvature, 1 / radius, 1e-3);  // chords of 4 cm
    EXPECT_NEAR(guide.curvature_ahead, 1 / radius, 0.02);
    EXPECT_NEAR(guide.along_m, radius * a, 0.01);
  }
}

TEST(Follower, BesideAStraightRouteItSteersBackToIt) {
  Follower follower(route_through({{0, 0}, {20, 0}}, 0));
  const Guide left = follower.look({1, 0.2, 0}, 0.9);
  EXPECT_NEAR(left.along_m, 1, 1e-9);
  EXPECT_NEAR(left.cross_m, 0.2, 1e-9);
  EXPECT_NEAR(left.curvature, -2 * 0.2 / (0.9 * 0.9 + 0.2 * 0.2), 1e-9);  // Coulter's arc through the goal
}

TEST(Follower, KeepsToItsStretchWhereTheRouteCrossesItself) {
  const Route route = route_through({{0, 0}, {10, 0}, {10, 10}, {5, 10}, {5, -10}}, 1.5);
  Follower follower(route);
  double last = 0;
  for (double x = 0; x < 8; x += 0.01) {
    const Guide guide = follower.look({x, 0, 0}, 0.9);
    EXPECT_NEAR(guide.along_m, x, 1e-6);
    last = guide.along_m;
  }
  EXPECT_NEAR(last, 8, 0.02);
}

TEST(Follower, GoesStraightOnBeyondBothEnds) {
  const Follower follower(route_through({{1, 1}, {1, 5}}, 0));
  EXPECT_TRUE(follower.point(-1).isApprox(Vec2(1, 0), 1e-12));
  EXPECT_TRUE(follower.point(6).isApprox(Vec2(1, 7), 1e-12));
}

TEST(Follower, ARouteOfOnePointIsAnError) {
  Route route;
  route.line = {{1, 2}, {1, 2}};
  EXPECT_THROW(Follower{route}, Error);
}

}  // namespace
}  // namespace adit
