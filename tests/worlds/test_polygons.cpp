// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/grid.h"
#include "tests/support/scratch.h"
#include "worlds/polygons.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

std::string file_with(const std::string& name, const std::string& text) {
  const std::string file = scratch(name + ".geojson");
  write_text(file, text);
  return file;
}

std::string polygon(const std::string& rings) {
  return R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {},
            "geometry": {"type": "Polygon", "coordinates": [)" +
         rings + "]}}]}";
}

const std::string outer = "[[0,0],[40,0],[40,30],[0,30],[0,0]]", pillar = "[[5,5],[5,25],[35,25],[35,5],[5,5]]";

std::string error_of(const std::string& file) {
  try {
    read_polygons(file);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Polygons, AFrameOfPassagesIsALoopRoundAPillarWithItsVolume) {
  WorldSettings s;
  s.plan = file_with("frame", polygon(outer + "," + pillar));
  s.mesh_edge_m = 0.4;
  s.height_sd_m = s.roll_m = s.grade_percent = s.floor.rms_m = s.roof.rms_m = s.rib.rms_m = 0;
  const World world = make_world(s, 1);
  EXPECT_TRUE(check_world(world).ok()) << check_world(world).what();
  EXPECT_TRUE(check_truth(world).empty());
  EXPECT_EQ(world.numbers.loops, 1);
  ASSERT_EQ(world.pillars.size(), 1u);
  // The pillar's corners are rounded by 1.2 m; straight ribs are good to some millimetres along 240 m.
  const double round = 4 * (1 - std::atan(1.0)) * 1.44;
  EXPECT_NEAR(world.pillars[0].area_m2, 600 - round, 2);
  EXPECT_NEAR(world.numbers.volume_m3, (1200 - 600 + round) * 1.9, 1.9 * 4);
  double length = 0;
  for (const Passage& p : world.passages) {
    length += p.length_m;
    EXPECT_NEAR(p.width_m, 5, 0.6);  // its corners are wider, the lattice good to 0.1 m on either side
  }
  EXPECT_NEAR(length, 2 * (35 + 25), 8);  // the middle cuts the four corners
  EXPECT_GT(plan_route(world, {}, 1).length_m, 100);
}

TEST(Polygons, ThePlanThatIsWrittenIsTheMineThatIsReadAgain) {
  WorldSettings s;
  s.kind = "panel";
  s.mesh_edge_m = 0.4;
  const World first = make_world(s, 8);
  const std::string dir = scratch("plan_again");
  save_plan(dir, first);
  s.kind = "plan";
  s.plan = dir + "/plan.geojson";
  s.rib.rms_m = 0;
  const World again = make_world(s, 8);
  EXPECT_TRUE(check_world(again).ok()) << check_world(again).what();
  EXPECT_EQ(again.pillars.size(), first.pillars.size());
  EXPECT_EQ(again.numbers.loops, first.numbers.loops);
  EXPECT_NEAR(again.numbers.floor_area_m2, first.numbers.floor_area_m2, 0.01 * first.numbers.floor_area_m2);
  size_t dead_ends = 0, dead_ends_again = 0;
  for (const Junction& j : first.junctions) dead_ends += j.degree() == 1;
  for (const Junction& j : again.junctions) dead_ends_again += j.degree() == 1;
  EXPECT_EQ(dead_ends_again, dead_ends);
}

TEST(Polygons, TheGridOfThePlanHasTheVoidsAreaFree) {
  WorldSettings s;
  s.kind = "panel";
  s.mesh_edge_m = 0.5;
  const World world = make_world(s, 3);
  const std::string dir = scratch("plan_grid");
  save_plan(dir, world);
  const Grid grid = read_grid(dir + "/plan.yaml");
  double free = 0, rim = 0;
  for (int j = 0; j < grid.height; ++j) {
    for (int i = 0; i < grid.width; ++i) {
      free += grid.cell(i, j) == Grid::free;
      rim += grid.cell(i, j) == Grid::occupied;
    }
  }
  const double cell = grid.cell_m * grid.cell_m;
  // The rim's cells lie half in the void.
  EXPECT_NEAR((free + 0.5 * rim) * cell, world.numbers.floor_area_m2, 0.02 * world.numbers.floor_area_m2);
}

TEST(Polygons, BadOnesAreAnsweredByPlaceAndCause) {
  const auto says = [](const std::string& what, const std::string& part) {
    EXPECT_NE(what.find(part), std::string::npos) << what;
  };
  says(error_of(file_with("bow", polygon("[[0,0],[40,30],[40,0],[0,20]]"))),
       "feature 0: ring 0 crosses itself near (20.0, 1");
  says(error_of(file_with("over", polygon(outer + ",[[30,5],[50,5],[50,20],[30,20]]"))), "rings 0 and 1 cross");
  says(error_of(file_with("line", polygon("[[0,0],[40,0],[20,0],[0,0]]"))), "encloses no area");
  says(error_of(file_with("two_points", polygon("[[0,0],[40,0],[0,0]]"))), "ring 0 has fewer than three points");
  says(error_of(file_with("huge", polygon("[[0,0],[400000,0],[400000,30],[0,30]]"))), "spans 400 km");
  says(error_of(file_with("degrees", polygon("[[-80.1,40.2],[-79.9,40.2],[-79.9,40.4],[-80.1,40.4]]"))), "not degrees");
  says(error_of(file_with("none", R"({"type": "FeatureCollection", "features": []})")), "no Polygon");
  says(error_of(file_with("broken", "{")), "not GeoJSON");
  WorldSettings s;
  s.plan = file_with("two", R"({"type": "MultiPolygon", "coordinates": [[[[0,0],[40,0],[40,5],[0,5]]],
                              [[[0,50],[40,50],[40,55],[0,55]]]]})");
  s.mesh_edge_m = 0.5;
  try {
    make_world(s, 1);
    FAIL() << "no error";
  } catch (const Error& e) {
    says(e.what(), "several parts");
  }
}

}  // namespace
}  // namespace adit
