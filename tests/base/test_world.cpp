// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/world.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace adit {
namespace {

TEST(World, AFolderGivesTheSameWorldBack) {
  World world = ring_world(20, 3, 2, 0.7);
  world.passages[2].blocked = true;
  save_world(scratch("ring"), world);
  const World back = load_world(scratch("ring"));
  EXPECT_EQ(world_hash(back), world_hash(world));
  EXPECT_EQ(back.name, world.name);
  EXPECT_EQ(back.numbers.volume_m3, world.numbers.volume_m3);
  EXPECT_EQ(back.numbers.loops, 1);
  ASSERT_EQ(back.passages.size(), 4u);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(back.passages[i].a, world.passages[i].a);
    EXPECT_EQ(back.passages[i].width_m, world.passages[i].width_m);
    EXPECT_EQ(back.passages[i].blocked, i == 2);
    EXPECT_EQ(back.passages[i].centre_line, world.passages[i].centre_line);
    EXPECT_EQ(back.junctions[i].passages, world.junctions[i].passages);
    EXPECT_EQ(back.junctions[i].p_W, world.junctions[i].p_W);
  }
  ASSERT_EQ(back.pillars.size(), world.pillars.size());
  EXPECT_EQ(back.pillars[0].outline, world.pillars[0].outline);
}

TEST(World, TheSameWorldIsTheSameBytes) {
  save_world(scratch("one"), ring_world(20, 3, 2, 0.7));
  save_world(scratch("two"), ring_world(20, 3, 2, 0.7));
  for (const char* name : {"/mine.ply", "/mine.glb", "/truth.json"})
    EXPECT_EQ(read_text(scratch("one") + name), read_text(scratch("two") + name)) << name;
}

TEST(World, TheHashTellsAWorldThatDiffersInOneVertexOrLabel) {
  const World world = ring_world(20, 3, 2, 1e9);
  World moved = world, relabelled = world;
  moved.mesh.vertex[3].z() += 1e-12;
  relabelled.mesh.label[3] = Label::cap;
  EXPECT_NE(world_hash(moved), world_hash(world));
  EXPECT_NE(world_hash(relabelled), world_hash(world));
}

TEST(World, TheFloorHasTheAreaOfTheVoidInPlan) {
  const World world = tunnel_world(30, 4, 2, 0.5);
  const Mesh floor = floor_of(world);
  double area = 0;
  for (size_t f = 0; f < floor.face.size(); ++f) {
    EXPECT_EQ(floor.label[f], Label::floor);
    area += floor.area(f);
  }
  EXPECT_NEAR(area, 120, 1e-9);  // rounding over 960 faces
}

TEST(World, TruthTellsTheAreaOfEachLabel) {
  save_world(scratch("tunnel"), tunnel_world(30, 4, 2, 1e9));
  const auto truth = nlohmann::json::parse(read_text(scratch("tunnel") + "/truth.json"));
  EXPECT_NEAR(truth["materials"]["roof"]["area_m2"].get<double>(), 120, 1e-9);
  EXPECT_EQ(truth["labels"]["rib"], 3);
}

TEST(World, BrokenTruthNamesItsFile) {
  const std::string dir = scratch("broken");
  save_world(dir, tunnel_world(30, 4, 2, 1e9));
  const std::string whole = read_text(dir + "/truth.json");
  std::string wrong_junction = whole;
  wrong_junction.replace(wrong_junction.find("\"b\":1"), 5, "\"b\":9");
  for (const std::string& text : {whole.substr(0, whole.size() / 2), std::string("{}"), wrong_junction}) {
    write_text(dir + "/truth.json", text);
    try {
      load_world(dir);
      FAIL() << "no error";
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("truth.json"), std::string::npos) << e.what();
      EXPECT_EQ(e.fault(), Fault::bad_input);
    }
  }
}

}  // namespace
}  // namespace adit
