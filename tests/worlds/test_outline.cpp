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

struct Traced {
  std::vector<Loop> loops;
  Outline whole;
};

Traced outline_of(std::vector<Drift> drifts, double corner_radius_m) {
  const Workings workings(std::move(drifts), {}, corner_radius_m);
  return {workings.ribs(), workings.whole()};
}

double area_of(const Traced& o) {
  double area = 0;
  for (const Loop& loop : o.loops) area += enclosed_area(loop);
  return area;
}

// The contour of a straight rib is exact; corners lose millimetres on a lattice of 0.2 m.
constexpr double line_error_m = 0.005;

TEST(Outline, AStraightPassageIsAsWideAsItIsDriven) {
  const Traced o = outline_of({straight({0, 0}, {40, 0}, 4, true, true)}, 1.2);
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
  const Traced o = outline_of({straight({0, 0}, {40, 0}, 4, true, true)}, 1.2);
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
  const Traced rounded = outline_of({arm(30, 0), arm(-30, 0), arm(0, 30), arm(0, -30)}, r);
  const Traced sharp = outline_of({arm(30, 0), arm(-30, 0), arm(0, 30), arm(0, -30)}, 0.5);
  // Four corners, each a square of the radius less a quarter of a disc.
  const double more = 4 * (1 - std::numbers::pi / 4) * (r * r - 0.25);
  // The lattice cuts the eroded corners by some centimetres over a metre and a half: 8 corners.
  EXPECT_NEAR(area_of(rounded) - area_of(sharp), more, 8 * 0.02 * 1.5);
}

TEST(Outline, ARingHasOnePillarOfTheRightSize) {
  std::vector<Drift> ring;
  const Vec2 c[4] = {{0, 0}, {20, 0}, {20, 30}, {0, 30}};
  for (int k = 0; k < 4; ++k) ring.push_back(straight(c[k], c[(k + 1) % 4], 4, false, false));
  const Traced o = outline_of(ring, 1.2);
  ASSERT_EQ(o.loops.size(), 2u);
  EXPECT_GT(enclosed_area(o.loops[0]), 0);
  const double pillar = 16 * 26 - 4 * (1 - std::numbers::pi / 4) * 1.44;
  EXPECT_NEAR(-enclosed_area(o.loops[1]), pillar, 84 * line_error_m);  // over the pillar's perimeter
}

TEST(Outline, EveryPlaceInTheVoidKnowsItsPassage) {
  const Traced o =
      outline_of({straight({0, 0}, {30, 0}, 4, true, false), straight({30, 0}, {30, 20}, 4, false, true)}, 1.2);
  EXPECT_EQ(passage_at(o.whole, {10, 1.5}), 0);
  EXPECT_EQ(passage_at(o.whole, {31, 15}), 1);
}

// A long entry lies in several blocks: what is traced block by block is what the whole lattice shows, to the bit.
TEST(Outline, BlocksAndWindowsShowTheSameAsTheWhole) {
  const double r = 1.2;
  const Workings workings({straight({0, 0}, {150, 10}, 4, true, false), straight({150, 10}, {240, 60}, 5, false, true),
                           straight({150, 10}, {170, -40}, 3, false, true)},
                          {}, r);
  const Outline whole = workings.whole();
  const std::vector<Loop> expected = contours(whole.depth, 0);
  const std::vector<Loop> ribs = workings.ribs();
  ASSERT_EQ(ribs.size(), expected.size());
  for (size_t l = 0; l < ribs.size(); ++l) {
    ASSERT_EQ(ribs[l].size(), expected[l].size());
    for (size_t i = 0; i < ribs[l].size(); ++i) ASSERT_EQ(ribs[l][i], expected[l][i]);
  }
  const Outline window = workings.window({{140, -20}, {180, 30}});
  ASSERT_LT(window.depth.value.size(), whole.depth.value.size() / 2);
  for (double x = 137.5; x < 183; x += 0.37) {
    for (double y = -22.5; y < 33; y += 0.41) {
      ASSERT_EQ(window.depth.at({x, y}), whole.depth.at({x, y})) << x << ", " << y;
      ASSERT_EQ(passage_at(window, {x, y}), passage_at(whole, {x, y})) << x << ", " << y;
    }
  }
}

TEST(Outline, AThinWallPartsTheVoidAndIsAsThickAsItIsBuilt) {
  for (double angle : {0.0, 0.3, 0.785}) {
    const Vec2 along(std::cos(angle), std::sin(angle));
    Drift d = straight(-20 * along, 20 * along, 4, true, true);
    // The wall is across the middle; the ribs end in round corners 20 m away and more.
    const Workings workings({d, straight(20 * along, 20 * along + Vec2(0, 30), 4, false, true),
                             straight(20 * along + Vec2(0, 30), -20 * along + Vec2(0, 30), 4, false, false),
                             straight(-20 * along + Vec2(0, 30), -20 * along, 4, false, false)},
                            {{Vec2::Zero(), along, 0.3, 5.6}}, 1.2);
    const Lattice depth = workings.whole().depth;
    for (double across : {-1.5, -0.7, 0.0, 1.0, 1.6}) {
      const Vec2 off = across * Vec2(-along.y(), along.x());
      EXPECT_GT(depth.at(off), 0.05) << angle;  // rock in the middle of it
      EXPECT_LT(depth.at(off + 0.35 * along), -0.1) << angle;
      EXPECT_NEAR(depth.at(off + 0.15 * along), 0, 0.06) << angle;  // bilinear across the ridge of a distance
    }
    EXPECT_EQ(workings.ribs().size(), 1u) << angle;  // a ring that is parted has one rim
  }
}

}  // namespace
}  // namespace adit
