// SPDX-License-Identifier: BSD-3-Clause
#include "eval/graph_score.h"
#include "eval/junction_graph.h"
#include "tests/eval/exact_case.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

constexpr double cell_m = 0.2;

// Free rectangles in metres on a plane of 40 x 30 m.
struct Drawn {
  FreeCells cells{cell_m, 200, 150, std::vector<std::uint8_t>(200 * 150, 0)};
  Drawn& fill(double x0, double y0, double x1, double y1, bool free = true) {
    for (int j = 0; j < cells.height; ++j)
      for (int i = 0; i < cells.width; ++i) {
        const double x = cell_m * (i + 0.5), y = cell_m * (j + 0.5);
        if (x > x0 && x < x1 && y > y0 && y < y1) cells.free[cells.index(i, j)] = free;
      }
    return *this;
  }
};

std::vector<int> junctions_of(const JunctionGraph& g) {
  std::vector<int> degrees;
  for (const int d : g.degree)
    if (d >= 3) degrees.push_back(d);
  std::sort(degrees.begin(), degrees.end());
  return degrees;
}

// Two entries of 4 m from (4, 6) to (36, 6) and (4, 22) to (36, 22), joined at both ends and in the middle, at x = 20.
Drawn theta() {
  return Drawn().fill(2, 4, 38, 8).fill(2, 20, 38, 24).fill(2, 4, 6, 24).fill(34, 4, 38, 24).fill(18, 4, 22, 24);
}

World theta_world() {
  World w;
  w.junctions = {{{20, 6, 0}, {0, 1, 2}}, {{20, 22, 0}, {0, 1, 2}}};
  const auto passage = [](const std::vector<Vec3>& line) {
    double length = 0;
    for (size_t k = 1; k < line.size(); ++k) length += (line[k] - line[k - 1]).norm();
    return Passage{0, 1, line, 4, 2, length, 0};
  };
  w.passages = {passage({{20, 6, 0}, {20, 22, 0}}), passage({{20, 6, 0}, {4, 6, 0}, {4, 22, 0}, {20, 22, 0}}),
                passage({{20, 6, 0}, {36, 6, 0}, {36, 22, 0}, {20, 22, 0}})};
  return w;
}

struct Scored {
  std::vector<Metric> all;
  Scored(const Drawn& truth, const Drawn& map) {
    TrueSection s{cell_m, Vec2::Zero(), truth.cells.width, truth.cells.height, {}};
    std::vector<Grid::Cell> cells;
    for (size_t k = 0; k < truth.cells.free.size(); ++k) {
      s.cell.push_back(truth.cells.free[k] ? CellTruth::free : CellTruth::wall);
      cells.push_back(map.cells.free[k] ? Grid::free : Grid::occupied);
    }
    const World world = theta_world();
    add_graph(MetricList(all), world, PassageMap(world), s, cells, Pose::Identity(), {}, "");
  }
  double operator()(const std::string& name) const {
    for (const Metric& m : all)
      if (m.name == name) return m.value;
    ADD_FAILURE() << "no metric " << name;
    return NAN;
  }
};

TEST(JunctionGraph, ACrossIsOneJunctionOfFour) {
  const JunctionGraph g = junction_graph(Drawn().fill(2, 13, 38, 17).fill(18, 2, 22, 28).cells, 4);
  EXPECT_EQ(junctions_of(g), std::vector<int>{4});
  EXPECT_EQ(g.edge.size(), 4u);
}

TEST(JunctionGraph, AnAitchIsTwoJunctionsOfThree) {
  const JunctionGraph g = junction_graph(Drawn().fill(4, 2, 8, 28).fill(30, 2, 34, 28).fill(4, 13, 34, 17).cells, 4);
  EXPECT_EQ(junctions_of(g), (std::vector<int>{3, 3}));
  EXPECT_EQ(g.edge.size(), 5u);
}

TEST(JunctionGraph, ARingHasNoJunctionAndAPassageNone) {
  const JunctionGraph ring = junction_graph(Drawn().fill(5, 5, 30, 25).fill(9, 9, 26, 21, false).cells, 4);
  EXPECT_TRUE(junctions_of(ring).empty());
  EXPECT_EQ(ring.edge.size(), 1u);
  // 21 + 16 m twice, its corners cut by the thinning.
  EXPECT_NEAR(ring.edge.at(0).length_m, 74, 6);
  EXPECT_TRUE(junctions_of(junction_graph(Drawn().fill(2, 13, 38, 17).cells, 4)).empty());
}

TEST(JunctionGraph, RaggedWallsAndSpecksMakeNoJunctions) {
  Drawn d = Drawn().fill(2, 13, 38, 17);
  for (int k = 0; k < 12; ++k) d.fill(3 + 3 * k, 17, 3.4 + 3 * k, 17.8);        // notches in the wall
  for (int k = 0; k < 5; ++k) d.fill(5 + 6 * k, 14.5, 5.6 + 6 * k, 15, false);  // cells of dust in the way
  EXPECT_TRUE(junctions_of(junction_graph(d.cells, 4)).empty());
}

TEST(GraphScore, TheTrueSectionFindsEverything) {
  const Scored s(theta(), theta());
  EXPECT_EQ(s("junctions_true"), 2);
  EXPECT_EQ(s("junction_recall"), 1);
  EXPECT_EQ(s("junction_precision"), 1);
  EXPECT_EQ(s("passages_true"), 3);
  EXPECT_EQ(s("passage_recall"), 1);
  EXPECT_EQ(s("passage_precision"), 1);
  EXPECT_EQ(s("broken_connections"), 0);
  EXPECT_EQ(s("path_ratio"), 1);
  EXPECT_EQ(s("path_ratio_worst"), 1);
  EXPECT_EQ(s("unreachable"), 0);
}

TEST(GraphScore, ABlockedPassageIsBrokenAndMakesADetour) {
  const Scored s(theta(), theta().fill(18, 13, 22, 14, false));
  EXPECT_EQ(s("passages_found"), 2);
  EXPECT_EQ(s("broken_connections"), 1);
  // 16 m through the middle; round either end 48 m along the centre lines, less where corners are cut.
  EXPECT_GT(s("path_ratio"), 2.2);
  EXPECT_LE(s("path_ratio"), 3);
  EXPECT_EQ(s("junction_recall"), 1);  // the stubs still show both
}

TEST(GraphScore, AMissingPassageLosesItsJunctions) {
  const Scored s(theta(), theta().fill(17, 8.01, 23, 19.99, false));
  EXPECT_EQ(s("junctions_found"), 0);
  EXPECT_EQ(s("junction_recall"), 0);
  EXPECT_EQ(s("broken_connections"), 1);
}

TEST(GraphScore, AFalseWayCostsPrecisionAndShortensPaths) {
  // A second way beside the true one, through the left pillar, at x = 10.
  const Scored s(theta(), theta().fill(9, 4, 13, 24));
  EXPECT_NEAR(s("junction_precision"), 0.5, 1e-9);  // two of four
  EXPECT_EQ(s("junction_recall"), 1);
  EXPECT_LT(s("passage_precision"), 1);
  EXPECT_EQ(s("broken_connections"), 0);
}

TEST(GraphScore, NothingFreeFindsNothing) {
  const Scored s(theta(), Drawn());
  EXPECT_EQ(s("junctions_found"), 0);
  EXPECT_EQ(s("passages_found"), 0);
  EXPECT_EQ(s("unreachable"), 2);  // the pair of junctions, from either end
  EXPECT_TRUE(std::isnan(s("path_ratio")));
}

TEST(GraphScore, TheRingOfAWholeCaseHasItsFourPassages) {
  const Score score = score_of(ring_case());
  EXPECT_EQ(value(score, "grid.passages_true"), 4);
  EXPECT_EQ(value(score, "grid.passages_found"), 4);
  EXPECT_EQ(value(score, "grid.passage_precision"), 1);
  EXPECT_EQ(value(score, "grid.pillars_split"), 0);
  EXPECT_EQ(value(score, "grid.pillars_merged"), 0);
  EXPECT_EQ(value(score, "grid.pillar_area_error_percent"), 0);
  EXPECT_EQ(value(score, "grid.extraction_ratio"), value(score, "grid.extraction_ratio_true"));
  // 256 m2 of 400, walls being a cell or so of rock: they count to the pillar and to what lies outside.
  EXPECT_NEAR(value(score, "grid.extraction_ratio_true"), 256.0 / 400, 0.03);
}

}  // namespace
}  // namespace adit
