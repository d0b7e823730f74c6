// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "base/polyline.h"
#include "base/rib_lines.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cmath>

namespace adit {
namespace {

/// 20 x 12 m of rock with free space where `is_free` says, sure of everything.
template <typename IsFree>
Grid grid_where(const IsFree& is_free, double cell_m = 0.1) {
  Grid grid;
  grid.cell_m = cell_m;
  grid.origin = {-3, 5};
  grid.width = static_cast<int>(20 / cell_m), grid.height = static_cast<int>(12 / cell_m);
  for (int j = 0; j < grid.height; ++j)
    for (int i = 0; i < grid.width; ++i) grid.log_odds.push_back(is_free(grid.centre(i, j)) ? -4 : 4);
  return grid;
}

bool within(const Vec2& p, double x0, double x1, double y0, double y1) {
  return p.x() > x0 && p.x() < x1 && p.y() > y0 && p.y() < y1;
}

TEST(RibLines, ARoomWithAPillarHasTwoRingsOfTheirAreas) {
  const Grid grid = grid_where([](const Vec2& p) { return within(p, 0, 14, 7, 15) && !within(p, 4, 9, 9, 12); });
  const auto rings = rib_lines(grid, {});
  ASSERT_EQ(rings.size(), 2u);
  // The line lies half a cell between the centres, on the wall; marching squares cut half a cell off each corner.
  EXPECT_NEAR(signed_area(rings[0]), 14 * 8, 4 * 0.05 * 0.05);
  EXPECT_NEAR(signed_area(rings[1]), -5 * 3, 4 * 0.05 * 0.05);
}

TEST(RibLines, ARoundRoomIsRound) {
  const Vec2 middle(6, 11);
  const auto rings = rib_lines(grid_where([&](const Vec2& p) { return (p - middle).norm() < 4; }), {});
  ASSERT_EQ(rings.size(), 1u);
  for (const Vec2& p : rings[0]) EXPECT_NEAR((p - middle).norm(), 4, 0.1);  // a cell
  EXPECT_NEAR(signed_area(rings[0]), M_PI * 16, 0.05 * 2 * M_PI * 4);       // half a cell along the rim
}

TEST(RibLines, SpecksAndWhatWasNeverSeenAreNoFreeSpace) {
  Grid grid = grid_where([](const Vec2& p) { return within(p, 0, 6, 7, 10) || within(p, 10, 11, 7, 8); });
  EXPECT_EQ(rib_lines(grid, {}).size(), 1u);  // a square metre is a speck
  EXPECT_EQ(rib_lines(grid, {.least_m2 = 0.5}).size(), 2u);
  std::fill(grid.log_odds.begin(), grid.log_odds.end(), 0.0F);
  EXPECT_TRUE(rib_lines(grid, {}).empty());
}

TEST(RibLines, RoomsThatTouchAtACornerStayTwo) {
  const auto rings =
      rib_lines(grid_where([](const Vec2& p) { return within(p, 0, 4, 7, 10) || within(p, 4, 8, 10, 14); }), {});
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_NEAR(signed_area(rings[0]) + signed_area(rings[1]), 16 + 12, 0.05);
}

TEST(RibLines, FreeSpaceUpToTheBorderOfTheGridStillCloses) {
  const auto rings = rib_lines(grid_where([](const Vec2&) { return true; }), {});
  ASSERT_EQ(rings.size(), 1u);
  EXPECT_NEAR(signed_area(rings[0]), 20 * 12, 2 * 0.2 * 32);
}

TEST(RibLines, FilesHoldEachVoidWithItsOwnPillars) {
  const Grid grid = grid_where([](const Vec2& p) {
    return (within(p, -2, 6, 6, 14) && !within(p, 1, 3, 9, 11)) ||
           (within(p, 8, 16, 6, 14) && !within(p, 10, 14, 8, 12));
  });
  const std::string file = scratch("ribs");
  write_rib_lines(file, rib_lines(grid));
  const auto all = nlohmann::json::parse(read_text(file + ".geojson"));
  ASSERT_EQ(all["features"].size(), 2u);
  for (const auto& feature : all["features"]) {
    const auto& rings = feature["geometry"]["coordinates"];
    ASSERT_EQ(rings.size(), 2u);  // the rim and one hole
    EXPECT_EQ(rings[0].front(), rings[0].back());
    const bool left = rings[0][0][0].get<double>() < 7;
    EXPECT_EQ(rings[1][0][0].get<double>() < 7, left) << "a pillar in the other void";
  }
  const std::string dxf = read_text(file + ".dxf");
  EXPECT_THAT(dxf, ::testing::HasSubstr("PILLARS"));
  EXPECT_TRUE(dxf.ends_with("EOF\n"));
}

}  // namespace
}  // namespace adit
