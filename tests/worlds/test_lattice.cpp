// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace adit {
namespace {

Lattice sampled(double cell, int n, const std::function<double(const Vec2&)>& f) {
  Lattice lattice{cell, Vec2::Constant(-0.5 * cell * (n - 1)), n, n, {}};
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) lattice.value.push_back(static_cast<float>(f(lattice.node(i, j))));
  return lattice;
}

TEST(Contours, ACircleRunsCounterClockwiseRoundItsArea) {
  const Lattice f = sampled(0.2, 101, [](const Vec2& p) { return p.norm() - 5; });
  const std::vector<Loop> loops = contours(f, 0);
  ASSERT_EQ(loops.size(), 1u);
  // Chords of at most 0.28 m lie up to c^2 / 8R = 2 mm inside, as does the linear interpolation.
  EXPECT_NEAR(enclosed_area(loops[0]), 25 * std::numbers::pi, 2 * std::numbers::pi * 5 * 0.004);
  for (const Vec2& p : loops[0]) EXPECT_NEAR(p.norm(), 5, 0.002);
}

TEST(Contours, ARingHasAnOuterLoopAndOneThatRunsClockwise) {
  const Lattice f = sampled(0.2, 121, [](const Vec2& p) { return std::abs(p.norm() - 7) - 2; });
  const std::vector<Loop> loops = contours(f, 0);
  ASSERT_EQ(loops.size(), 2u);
  const double sum = enclosed_area(loops[0]) + enclosed_area(loops[1]);
  EXPECT_NEAR(sum, std::numbers::pi * (81 - 25), 2 * std::numbers::pi * 14 * 0.004);  // as above, on both circles
}

TEST(Contours, InASaddleTheCornersBelowAreJoined) {
  Lattice f{1, Vec2::Zero(), 4, 4, std::vector<float>(16, 1.0f)};
  f.value[f.index(1, 1)] = f.value[f.index(2, 2)] = -1;
  EXPECT_EQ(contours(f, 0).size(), 1u);
}

TEST(Contours, NothingBelowTheLevelGivesNoLine) {
  EXPECT_TRUE(contours(sampled(1, 5, [](const Vec2&) { return 1.0; }), 0).empty());
}

TEST(Lattice, InterpolationIsExactForAPlane) {
  const Lattice f = sampled(0.5, 9, [](const Vec2& p) { return 1 + 2 * p.x() - 3 * p.y(); });
  EXPECT_NEAR(f.at({0.123, -0.77}), 1 + 2 * 0.123 + 3 * 0.77, 1e-6);  // values are floats
}

}  // namespace
}  // namespace adit
