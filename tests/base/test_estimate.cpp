// SPDX-License-Identifier: BSD-3-Clause
#include "base/damaged_estimate.h"
#include "base/error.h"
#include "base/estimate.h"
#include "base/files.h"
#include "tests/support/scratch.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;

std::string fresh_folder(const std::string& name) {
  const fs::path dir = fs::path(scratch(name));
  fs::remove_all(dir);
  fs::create_directories(dir);
  return dir.string();
}

Grid small_grid() {
  Grid g{0.25, Vec2(-1.5, 2.25), 3, 2, {}};
  g.log_odds = {0, -1, 2, 0.5f, 0, -0.25f};
  return g;
}

Estimate small_estimate() {
  Estimate e;
  e.method = "robust";
  for (int i = 0; i < 3; ++i) {
    e.path.stamp_s.push_back(0.2 * i);
    e.path.X_WB.push_back(pose_of({0.1 * i, -0.05 * i, 0.01 * i}, 0.3 * i, 0.01, -0.02));
    e.open_loop.push_back({0.11 * i, 0, 0.3 * i});
    e.planar.push_back({0.1 * i, -0.05 * i, 0.3 * i});
  }
  e.rounds = {{{Vec2(0, 0), Vec2(5, 0.125)}, {{0, 1}}}};
  e.converged = true;
  e.closures = {{0, 2, {0.5, -0.25, 3.0}, true, true, false}, {1, 2, {}, false, false, true}};
  e.degenerate = {{0.2, 0.4, 0.125}};
  e.grid = small_grid();
  e.points.p = {Vec3(1, 2, 3)};
  e.points.sigma_m = {0.125F};
  e.volume_parts = {{0, 0.25, 2, 8, 0.5}, {0.25, 0.4, 1, 4.5, 0.25}};
  e.range_bias = {{"up", -0.004, 0.001}};
  e.volume_m3 = 12.5;
  e.notes = {"one sentence"};
  return e;
}

TEST(GridFile, CellsOriginAndSizeComeBack) {
  const std::string dir = fresh_folder("grid");
  const Grid g = small_grid();
  write_grid(dir + "/grid.pgm", g);
  const Grid back = read_grid(dir + "/grid.yaml");
  EXPECT_EQ(back.cell_m, g.cell_m);
  EXPECT_EQ(back.origin, g.origin);
  ASSERT_EQ(back.width, g.width);
  ASSERT_EQ(back.height, g.height);
  for (int j = 0; j < g.height; ++j)
    for (int i = 0; i < g.width; ++i) EXPECT_EQ(back.cell(i, j), g.cell(i, j)) << i << ' ' << j;
}

TEST(GridFile, IsWhatMapServerExpects) {
  const std::string dir = fresh_folder("grid_bytes");
  write_grid(dir + "/grid.pgm", small_grid());
  const std::string pgm = read_text(dir + "/grid.pgm");
  const std::string header = "P5\n3 2\n255\n";
  ASSERT_EQ(pgm.size(), header.size() + 6);
  EXPECT_EQ(pgm.substr(0, header.size()), header);
  const std::string upper_row_first{'\0', '\xcd', '\xff', '\xcd', '\xff', '\0'};  // 0 occupied, 205 unknown, 255 free
  EXPECT_EQ(pgm.substr(header.size()), upper_row_first);
  EXPECT_EQ(read_text(dir + "/grid.yaml").substr(0, 16), "image: grid.pgm\n");
}

TEST(GridFile, ACutPictureAMissingKeyAndATurnedMapAreErrorsThatNameTheFile) {
  const std::string dir = fresh_folder("grid_bad");
  write_grid(dir + "/grid.pgm", small_grid());
  const std::string pgm = read_text(dir + "/grid.pgm"), yaml = read_text(dir + "/grid.yaml");
  write_text(dir + "/grid.pgm", pgm.substr(0, pgm.size() - 2));
  EXPECT_THROW(read_grid(dir + "/grid.yaml"), Error);
  write_text(dir + "/grid.pgm", "P2\n");
  EXPECT_THROW(read_grid(dir + "/grid.yaml"), Error);
  write_text(dir + "/grid.pgm", pgm);
  write_text(dir + "/none.yaml", "image: grid.pgm\n");
  EXPECT_THROW(read_grid(dir + "/none.yaml"), Error);
  write_text(dir + "/turned.yaml", "image: grid.pgm\nresolution: 0.1\norigin: [0, 0, 0.5]\n");
  EXPECT_THROW(read_grid(dir + "/turned.yaml"), Error);
  write_text(dir + "/flat.yaml", "image: grid.pgm\nresolution: 0\norigin: [0, 0, 0]\n");
  EXPECT_THROW(read_grid(dir + "/flat.yaml"), Error);
}

TEST(GridFile, CellsOutsideAreUnknown) {
  EXPECT_EQ(small_grid().cell(-1, 0), Grid::unknown);
  EXPECT_EQ(small_grid().cell(3, 0), Grid::unknown);
}

TEST(EstimateFolder, WhatIsSavedComesBack) {
  const std::string dir = fresh_folder("estimate");
  const Estimate e = small_estimate();
  save_estimate(dir, e);
  const Estimate back = load_estimate(dir);
  EXPECT_EQ(back.method, e.method);
  ASSERT_EQ(back.path.size(), e.path.size());
  for (size_t i = 0; i < e.path.size(); ++i) {
    EXPECT_NEAR((back.path.X_WB[i].matrix() - e.path.X_WB[i].matrix()).norm(), 0, 1e-8);  // nine decimals
    EXPECT_NEAR((back.planar[i].position() - e.planar[i].position()).norm(), 0, 1e-8);
    EXPECT_NEAR(back.open_loop[i].yaw_rad, e.open_loop[i].yaw_rad, 1e-8);
  }
  ASSERT_EQ(back.rounds.size(), 1u);
  EXPECT_EQ(back.rounds[0].nodes, e.rounds[0].nodes);
  EXPECT_EQ(back.rounds[0].correspondences, e.rounds[0].correspondences);
  EXPECT_TRUE(back.converged);
  ASSERT_EQ(back.closures.size(), 2u);
  EXPECT_EQ(back.closures[0].X_ij.yaw_rad, 3.0);
  EXPECT_TRUE(back.closures[0].accepted && back.closures[0].measured && back.closures[1].ambiguous);
  ASSERT_EQ(back.degenerate.size(), 1u);
  EXPECT_EQ(back.degenerate[0].sigma_m, 0.125);
  EXPECT_EQ(back.volume_m3, e.volume_m3);
  EXPECT_FALSE(back.volume_sigma_m3.has_value());
  EXPECT_EQ(back.notes, e.notes);
  EXPECT_EQ(back.points.size(), 1u);
  EXPECT_EQ(back.points.sigma_m, e.points.sigma_m);
  ASSERT_EQ(back.volume_parts.size(), 2u);
  EXPECT_EQ(back.volume_parts[1].from_s, 0.25);
  EXPECT_EQ(back.volume_parts[1].volume_m3, 4.5);
  EXPECT_EQ(back.volume_parts[1].sigma_m3, 0.25);
  ASSERT_EQ(back.range_bias.size(), 1u);
  EXPECT_EQ(back.range_bias[0].laser, "up");
  EXPECT_EQ(back.range_bias[0].sigma_m, 0.001);
}

TEST(EstimateFolder, AMapJsonFromBeforePartsAndRangeErrorsIsRead) {
  const std::string dir = fresh_folder("estimate_old");
  Estimate e = small_estimate();
  e.volume_parts.clear(), e.range_bias.clear();
  save_estimate(dir, e);
  std::string text = read_text(dir + "/map.json");
  for (const std::string line : {"  \"volume_parts\": [],\n", "  \"range_bias\": [],\n"}) {
    const size_t at = text.find(line);
    ASSERT_NE(at, std::string::npos) << line;
    text.erase(at, line.size());
  }
  write_text(dir + "/map.json", text);
  EXPECT_EQ(load_estimate(dir).volume_m3, e.volume_m3);
}

TEST(EstimateFolder, WhatAnEstimateLacksHasNoFileEvenOverAnEarlierOne) {
  const std::string dir = fresh_folder("estimate_less");
  Estimate e = small_estimate();
  save_estimate(dir, e);
  e.grid = {};
  e.points = {};
  e.open_loop.clear();
  save_estimate(dir, e);
  for (const char* file : {"/grid.pgm", "/grid.yaml", "/points.ply", "/open_loop.tum"})
    EXPECT_FALSE(fs::exists(dir + file)) << file;
  EXPECT_TRUE(load_estimate(dir).open_loop.empty());
}

TEST(EstimateFolder, AForeignMapJsonAndPathsOfOtherLengthAreErrors) {
  const std::string dir = fresh_folder("estimate_bad");
  save_estimate(dir, small_estimate());
  Trajectory two = small_estimate().path;
  two.stamp_s.pop_back(), two.X_WB.pop_back();
  write_tum(dir + "/planar.tum", two);
  EXPECT_THROW(load_estimate(dir), Error);
  write_text(dir + "/map.json", "{\"method\": 3}");
  EXPECT_THROW(load_estimate(dir), Error);
  write_text(dir + "/map.json", "{");
  EXPECT_THROW(load_estimate(dir), Error);
  EXPECT_THROW(load_estimate(dir + "/nowhere"), Error);
}

TEST(DamagedEstimate, EachFileThatCannotBeReadIsNamedAndTheOthersAreThere) {
  const std::string dir = fresh_folder("damaged");
  const Estimate e = small_estimate();
  save_estimate(dir, e);
  write_text(dir + "/points.ply", "ply\nnonsense");
  write_text(dir + "/open_loop.tum", "0 1 2\n");
  EXPECT_THROW(load_estimate(dir), Error);
  std::vector<std::string> damaged;
  const Estimate left = load_what_is_whole(dir, damaged);
  ASSERT_EQ(damaged.size(), 2u);
  EXPECT_NE(damaged[0].find("open_loop.tum"), std::string::npos);
  EXPECT_NE(damaged[1].find("points.ply"), std::string::npos);
  EXPECT_EQ(left.path.size(), e.path.size());
  EXPECT_EQ(left.planar.size(), e.planar.size());
  EXPECT_EQ(left.closures.size(), e.closures.size());
  EXPECT_EQ(left.grid.width, e.grid.width);
  EXPECT_TRUE(left.open_loop.empty());
  EXPECT_EQ(left.points.size(), 0u);
}

TEST(DamagedEstimate, WithoutItsPathAMapKeepsWhatDoesNotHangOnIt) {
  const std::string dir = fresh_folder("pathless");
  save_estimate(dir, small_estimate());
  fs::remove(dir + "/trajectory.tum");
  std::vector<std::string> damaged;
  const Estimate left = load_what_is_whole(dir, damaged);
  EXPECT_EQ(damaged.size(), 3u);  // the path, and the two that have a pose for each of its poses
  EXPECT_TRUE(left.planar.empty());
  EXPECT_EQ(left.points.size(), 1u);
  EXPECT_EQ(left.volume_m3, 12.5);
}

TEST(DamagedEstimate, OfAWholeMapNothingIsSaid) {
  const std::string dir = fresh_folder("whole");
  save_estimate(dir, small_estimate());
  std::vector<std::string> damaged;
  EXPECT_EQ(load_what_is_whole(dir, damaged).path.size(), 3u);
  EXPECT_TRUE(damaged.empty());
}

}  // namespace
}  // namespace adit
