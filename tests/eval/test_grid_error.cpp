// SPDX-License-Identifier: BSD-3-Clause
#include "eval/grid_error.h"
#include "eval/topology.h"
#include "tests/eval/exact_case.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

// The cells of the ring's grid in a box of W; its M begins at (-8, -8, 0) without a turn.
template <typename Change>
Score with_cells(const Vec2& low_W, const Vec2& high_W, const Change& change) {
  ExactCase c = ring_case();
  Grid& g = c.estimate.grid;
  for (int j = 0; j < g.height; ++j)
    for (int i = 0; i < g.width; ++i) {
      const Vec2 p = g.centre(i, j) + Vec2(-8, -8);
      if ((p - low_W).minCoeff() > 0 && (high_W - p).minCoeff() > 0) change(g.log_odds[g.index(i, j)]);
    }
  return score_of(c);
}

TEST(GridError, TheTrueSectionScoresOne) {
  const Score score = score_of(ring_case());
  EXPECT_EQ(value(score, "grid.iou_free"), 1);
  EXPECT_EQ(value(score, "grid.f_occupied"), 1);
  EXPECT_LT(value(score, "grid.brier"), 1e-9);
  EXPECT_EQ(value(score, "grid.pillars_true"), 1);
  EXPECT_EQ(value(score, "grid.pillars_found"), 1);
  EXPECT_EQ(value(score, "grid.loops_true"), 1);
  EXPECT_EQ(value(score, "grid.loops_found"), 1);
  for (const char* fault : {"false_connections", "pillars_split", "pillars_merged", "pillar_area_error_percent"})
    EXPECT_EQ(value(score, std::string("grid.") + fault), 0) << fault;
  // The ring's plan area, less the cells of its walls: 80 m of outer and 48 m of inner wall, up to one and a half cells
  // deep.
  EXPECT_NEAR(0.01 * static_cast<double>(score.find("grid.iou_free")->n), 256, 0.15 * 128);
}

TEST(GridError, AWallOneCellOffIsStillAWall) {
  ExactCase c = ring_case();
  c.estimate.grid.origin += Vec2(0.1, 0);
  const Score score = score_of(c);
  EXPECT_EQ(value(score, "grid.f_occupied"), 1);
  EXPECT_LT(value(score, "grid.iou_free"), 1);
  // Free cells leave and enter along the walls across: 2 x (20 + 12) m of them at 0.1 m, of some 250 m2.
  EXPECT_NEAR(value(score, "grid.iou_free"), 1 - 2 * 3.2 / 250, 0.02);
  c.estimate.grid.origin += Vec2(0.2, 0.3);
  EXPECT_LT(value(score_of(c), "grid.f_occupied"), 0.5);
}

TEST(GridError, AWayThroughThePillarIsAFalseConnection) {
  const Score score = with_cells({-7, -0.3}, {7, 0.3}, [](float& odds) { odds = -1; });
  EXPECT_EQ(value(score, "grid.false_connections"), 1);
  EXPECT_EQ(value(score, "grid.loops_found"), 2);
  EXPECT_EQ(value(score, "grid.pillars_split"), 1);
}

TEST(GridError, ANotchInThePillarIsNone) {
  const Score score = with_cells({-7, -0.3}, {3, 0.3}, [](float& odds) { odds = -1; });
  EXPECT_EQ(value(score, "grid.false_connections"), 0);
  EXPECT_EQ(value(score, "grid.pillars_found"), 1);
  EXPECT_EQ(value(score, "grid.pillars_split"), 0);
  // The notch takes some 9 x 0.6 m (from the pillar's side at -6 to 3) of 144 m2 and its walls.
  EXPECT_NEAR(value(score, "grid.pillar_area_error_percent"), 100 * 5.4 / 144, 0.6);
}

TEST(GridError, ABlockedPassageLosesTheLoopAndThePillar) {
  const Score score = with_cells({-2, -11}, {2, -5}, [](float& odds) { odds = 1; });
  EXPECT_EQ(value(score, "grid.loops_true"), 1);
  EXPECT_EQ(value(score, "grid.loops_found"), 0);
  EXPECT_EQ(value(score, "grid.pillars_found"), 0);
  EXPECT_EQ(value(score, "grid.pillars_merged"), 1);
}

TEST(GridError, AllUnknownOrAllFreeScoresBadly) {
  const Score unknown = with_cells({-99, -99}, {99, 99}, [](float& odds) { odds = 0; });
  EXPECT_EQ(value(unknown, "grid.iou_free"), 0);
  EXPECT_EQ(value(unknown, "grid.f_occupied"), 0);
  EXPECT_EQ(value(unknown, "grid.pillars_found"), 0);
  const Score free = with_cells({-99, -99}, {99, 99}, [](float& odds) { odds = -1; });
  EXPECT_LT(value(free, "grid.iou_free"), 0.75);  // the ring's 256 of at least 400 m2
  EXPECT_EQ(value(free, "grid.f_occupied"), 0);
  EXPECT_EQ(value(free, "grid.pillars_found"), 0);
  EXPECT_EQ(value(free, "grid.false_connections"), 1);
}

TEST(Islands, DiagonalContactHoldsAWallTogether) {
  // A diamond of blocked cells round a free one: free space inside is cut off, the diamond is one island.
  const std::vector<char> free{1, 1, 1, 1, 1,  //
                               1, 1, 0, 1, 1,  //
                               1, 0, 1, 0, 1,  //
                               1, 1, 0, 1, 1,  //
                               1, 1, 1, 1, 1};
  const Islands islands = islands_of(free, 5, 5);
  ASSERT_EQ(islands.cells.size(), 1u);
  EXPECT_EQ(islands.cells[0], 4u);
  EXPECT_TRUE(islands.enclosed[0]);
}

}  // namespace
}  // namespace adit
