// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/world_writer.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

namespace adit {
namespace {

WorldSettings district(double tile_m) {
  WorldSettings s;
  s.kind = "district";
  s.mesh_edge_m = 0.6;
  s.tile_m = tile_m;
  s.district.length_m = 600;
  return s;
}

WorldSettings panel(double tile_m) {
  WorldSettings s;
  s.kind = "panel";
  s.mesh_edge_m = 0.5;
  s.tile_m = tile_m;
  s.panel.entries = 3;
  return s;
}

std::vector<MinePart> parts_of(const WorldSettings& s, std::uint64_t seed) {
  std::vector<MinePart> parts;
  make_parts(s, seed, [&](MinePart&& part) { parts.push_back(std::move(part)); });
  return parts;
}

WorldCheck check_of(const std::vector<MinePart>& parts) {
  PartsCheck check;
  for (const MinePart& part : parts) check.add(part);
  return check.finish();
}

TEST(Tiles, AMineInTilesIsSoundAsAWholeAndTheMineThatItIsInOnePiece) {
  for (const auto& of : {district, panel}) {
    const World whole = make_world(of(0), 4), tiled = make_world(of(50), 4);
    const WorldCheck check = check_world(tiled);
    EXPECT_TRUE(check.ok()) << check.what();
    const auto faults = check_truth(tiled);
    EXPECT_TRUE(faults.empty()) << faults.front();
    // The ribs are the same points; floor and roof between them have other triangles, but on the same surface.
    ASSERT_EQ(tiled.pillars.size(), whole.pillars.size());
    for (size_t i = 0; i < whole.pillars.size(); ++i) EXPECT_EQ(tiled.pillars[i].outline, whole.pillars[i].outline);
    EXPECT_EQ(tiled.outline, whole.outline);
    EXPECT_EQ(tiled.numbers.floor_area_m2, whole.numbers.floor_area_m2);
    EXPECT_NEAR(tiled.numbers.volume_m3, whole.numbers.volume_m3, 1e-4 * whole.numbers.volume_m3);
    for (size_t i = 0; i < whole.passages.size(); ++i)
      EXPECT_EQ(tiled.passages[i].centre_line, whole.passages[i].centre_line) << i;
  }
}

TEST(Tiles, PartsAreManyAndTheirChecksAreThoseOfTheWhole) {
  const std::vector<MinePart> parts = parts_of(district(50), 2);
  ASSERT_GT(parts.size(), 8u);
  World whole;
  size_t largest = 0;
  for (const MinePart& part : parts) {
    append(part, whole.mesh);
    largest = std::max(largest, part.mesh.face.size());
    EXPECT_GT(open_edges(part.mesh), 0u);  // towards its neighbours
    for (const Vec3& v : part.mesh.vertex)
      EXPECT_TRUE((v.head<2>().array() >= part.frame.low.array()).all() &&
                  (v.head<2>().array() <= part.frame.high.array()).all());
  }
  EXPECT_LT(3 * largest, whole.mesh.face.size());
  const WorldCheck check = check_of(parts), expected = check_world(whole);
  EXPECT_TRUE(check.ok()) << check.what();
  EXPECT_TRUE(expected.ok()) << expected.what();
  EXPECT_EQ(check.volume_m3, expected.volume_m3);  // the same sum in the same order
}

TEST(Tiles, WhatIsWrongInAPartOrBetweenTwoIsFound) {
  const std::vector<MinePart> sound = parts_of(panel(50), 1);
  ASSERT_GT(sound.size(), 1u);
  std::vector<MinePart> parts = sound;
  parts[1].mesh.face.pop_back();
  parts[1].mesh.label.pop_back();
  EXPECT_EQ(check_of(parts).open_edges, 3u);
  parts = sound;
  parts.pop_back();
  EXPECT_GT(check_of(parts).open_edges, 10u);
  parts = sound;
  for (auto& face : parts[0].mesh.face) std::swap(face[0], face[1]);
  EXPECT_FALSE(check_of(parts).closed);
}

MinePart box_part(size_t index, const Vec3& low, const Vec3& high, std::uint32_t first_vertex) {
  MinePart part;
  part.index = index;
  part.mesh = box_mesh(low, high);
  for (size_t v = 0; v < part.mesh.vertex.size(); ++v)
    part.vertex_id.push_back(first_vertex + static_cast<std::uint32_t>(v));
  part.frame = {index, low.head<2>(), high.head<2>()};
  return part;
}

TEST(Tiles, TwoPartsThatRunIntoEachOtherAreFoundAsInTheWhole) {
  MinePart a = box_part(0, {0, 0, 0}, {5, 4, 2}, 0);
  const MinePart b = box_part(1, {4, 1, 0.5}, {9, 3, 1.5}, static_cast<std::uint32_t>(a.mesh.vertex.size()));
  a.later = {b.frame};
  World both;
  append(a, both.mesh);
  append(b, both.mesh);
  const size_t expected = check_world(both).self_intersections;
  ASSERT_GT(expected, 0u);
  EXPECT_EQ(check_of({a, b}).self_intersections, expected);
}

TEST(Tiles, FilesWrittenPartByPartAreThoseOfTheWhole) {
  const std::string whole = scratch("tiles_whole"), tiled = scratch("tiles_parts");
  save_world(whole, make_world(panel(50), 3));
  {
    WorldWriter writer(tiled);
    writer.close(make_parts(panel(50), 3, [&](MinePart&& part) { writer.add(part.mesh, part.vertex_id); }));
  }
  for (const char* file : {"/mine.ply", "/mine.glb", "/truth.json"})
    EXPECT_TRUE(read_text(whole + file) == read_text(tiled + file)) << file;
  for (const auto& entry : std::filesystem::directory_iterator(tiled))
    EXPECT_NE(entry.path().filename().string().front(), '.') << entry.path();  // nothing is left behind
}

TEST(Tiles, SettingsThatCannotBeAreRefused) {
  const auto error_of = [](const WorldSettings& s) -> std::string {
    try {
      make_world(s, 1);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_NE(error_of(panel(10)).find("world.tile_m = 10.00"), std::string::npos);
  WorldSettings s = panel(0);
  s.panel.entries = 50;
  s.panel.crosscuts = 40;
  s.mesh_edge_m = 0.1;
  s.panel.entry_spacing_m = s.panel.crosscut_spacing_m = 200;
  EXPECT_NE(error_of(s).find("million triangles, at most 100 million"), std::string::npos) << error_of(s);
}

}  // namespace
}  // namespace adit
