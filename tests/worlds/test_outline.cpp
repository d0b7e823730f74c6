// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

Drift straight(const Vec2& a, const Vec2& b, double width, bool flat_a, bool flat_b) {
  Drift d;
  const int n = std::max(1, static_cast<int>(std::lround((b - a).norm() / 0.5)));
  for (int k = 0; k <= n; ++k) d.line.push_back(a + (b - a) * k / n);
  d.left.assign(d.line.size(), width / 2);
  d.right = d.left;
  d.flat_a = flat_a;
  d.flat_b = flat_b;
  return d;
}

double area_of(const Outline& o) {
  double area = 0;
  for (const Loop& loop : o.loops) area += enclosed_area(loop);
  return area;
}

// The contour of a straight rib is exact; corners lose millimetres on a lattice of 0.2 m.
constexpr double line_error_m = 0.005;

TEST(Outline, AStraightPassageIsAsWideAsItIsDriven) {
  const Outline o = outline_of({straight({0, 0}, {40, 0}, 4, true, true)}, 1.2);
  ASSERT_EQ(o.loops.size(), 1u);
  int seen = 0;
  for (const Vec2& p : o.loops[0]) {
    if (p.x() < 5 || p.x() > 35) continue;
    EXPECT_NEAR(std::abs(p.y()), 2, line_error_m);
    ++seen;
  }
  EXPECT_GT(seen, 200);
}

TEST(Outline, ADeadEndClosesOneMetreBehindItsNode) {
  const Outline o = outline_of({straight({0, 0}, {40, 0}, 4, true, true)}, 1.2);
  double east = -1e9, west = 1e9;
  for (const Vec2& p : o.loops[0]) {
    east = std::max(east, p.x());
    west = std::min(west, p.x());
  }
  EXPECT_NEAR(east, 41, line_error_m);
  EXPECT_NEAR(west, -1, line_error_m);
}

TEST(Outline, AtACrossingTheRockIsRoundedByTheRadiusAskedFor) {
  const double r = 1.2;
  const auto arm = [](double x, double y) { return straight({0, 0}, {x, y}, 4, false, true); };
  const Outline rounded = outline_of({arm(30, 0), arm(-30, 0), arm(0, 30), arm(0, -30)}, r);
  const Outline sharp = outline_of({arm(30, 0), arm(-30, 0), arm(0, 30), arm(0, -30)}, 0.5);
  // Four corners, each a square of the radius less a quarter of a disc.
  const double more = 4 * (1 - std::numbers::pi / 4) * (r * r - 0.25);
  // The lattice cuts the eroded corners by some centimetres over a metre and a half: 8 corners.
  EXPECT_NEAR(area_of(rounded) - area_of(sharp), more, 8 * 0.02 * 1.5);
}

TEST(Outline, ARingHasOnePillarOfTheRightSize) {
  std::vector<Drift> ring;
  const Vec2 c[4] = {{0, 0}, {20, 0}, {20, 30}, {0, 30}};
  for (int k = 0; k < 4; ++k) ring.push_back(straight(c[k], c[(k + 1) % 4], 4, false, false));
  const Outline o = outline_of(ring, 1.2);
  ASSERT_EQ(o.loops.size(), 2u);
  EXPECT_GT(enclosed_area(o.loops[0]), 0);
  const double pillar = 16 * 26 - 4 * (1 - std::numbers::pi / 4) * 1.44;
  EXPECT_NEAR(-enclosed_area(o.loops[1]), pillar, 84 * line_error_m);  // over the pillar's perimeter
}

TEST(Outline, EveryPlaceInTheVoidKnowsItsPassage) {
  const Outline o =
      outline_of({straight({0, 0}, {30, 0}, 4, true, false), straight({30, 0}, {30, 20}, 4, false, true)}, 1.2);
  EXPECT_EQ(passage_at(o, {10, 1.5}), 0);
  EXPECT_EQ(passage_at(o, {31, 15}), 1);
}

}  // namespace
}  // namespace adit
