// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "rays/caster.h"
#include "tests/support/errors.h"
#include "worlds/plan.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace adit {
namespace {

WorldSettings rooms() {
  WorldSettings s;
  s.kind = "rooms";
  s.mesh_edge_m = 0.5;
  s.rooms.rooms = 3;
  s.rooms.depth_m = 35;
  s.rooms.depth_sd_m = 4;
  return s;
}

WorldSettings panel() {
  WorldSettings s;
  s.kind = "panel";
  s.mesh_edge_m = 0.5;
  return s;
}

WorldSettings retreat() {
  WorldSettings s = panel();
  s.panel.entries = 3;
  s.panel.crosscut_spacing_m = 24;
  s.panel.spacing_sd_m = 0.3;
  s.panel.retreat_rows = 1;
  s.panel.stagger = 0;
  return s;
}

WorldSettings roads() {
  WorldSettings s = panel();
  s.panel.entries = 3;
  s.panel.crosscut_spacing_m = 32;
  s.panel.entry_spacing_m = 30;
  s.panel.turnout_share = 0.5;
  s.panel.loop_road = true;
  s.panel.missing_share = s.panel.dead_end_share = s.panel.stopping_share = 0.25;
  return s;
}

WorldSettings district(double length_m) {
  WorldSettings s;
  s.kind = "district";
  s.mesh_edge_m = 0.6;
  s.district.length_m = length_m;
  s.district.stopping_share = s.district.missing_share = 0.2;
  return s;
}

double length_of(const MinePlan& plan) {
  double length = 0;
  for (const PlanPassage& p : plan.passages)
    for (size_t i = 1; i < p.line.size(); ++i) length += (p.line[i] - p.line[i - 1]).norm();
  return length;
}

TEST(Layouts, EveryKindGivesASoundMineWhoseTruthFitsAndThatCanBeDriven) {
  for (const WorldSettings& s : {rooms(), retreat(), roads(), district(600)}) {
    for (std::uint64_t seed = 0; seed < 2; ++seed) {
      const World world = make_world(s, seed);
      const WorldCheck check = check_world(world);
      EXPECT_TRUE(check.ok()) << s.kind << ", seed " << seed << ": " << check.what();
      const auto faults = check_truth(world);
      EXPECT_TRUE(faults.empty()) << s.kind << ", seed " << seed << ": " << faults.front();
      // Nothing broke through into another passage: rock that is encircled is encircled by passages that the graph has.
      EXPECT_EQ(world.pillars.size(), static_cast<size_t>(world.numbers.loops)) << s.kind << ", seed " << seed;
      EXPECT_GT(plan_route(world, {}, seed).length_m, 100) << s.kind << ", seed " << seed;
      EXPECT_EQ(cycle_basis(world).size(), static_cast<size_t>(world.numbers.loops)) << s.kind << ", seed " << seed;
    }
  }
}

TEST(Layouts, RetreatLeavesFourStumpsOfEachPillarOfItsRows) {
  WorldSettings s = retreat();
  // Crosscuts 0 to 3 between three entries: two rows of two whole pillars, one row of two split ones.
  const World world = make_world(s, 3);
  EXPECT_EQ(world.pillars.size(), 2u * 2u + 2u * 4u);
  s.panel.crosscut_angle_deg = 60;
  EXPECT_NE(error_of([&] { make_plan(s, 1); }).find("retreat_rows"), std::string::npos);
  s = retreat();
  s.panel.stump_m = 12;
  EXPECT_NE(error_of([&] { make_plan(s, 1); }).find("world.panel.stump_m = 12.00 m"), std::string::npos);
}

TEST(Layouts, AStoppingClosesACrosscutWithTwoCaps) {
  WorldSettings s = panel();
  s.panel.stopping_share = 1;
  s.panel.stub_share = 0;
  const MinePlan plan = make_plan(s, 1);
  EXPECT_EQ(plan.walls.size(), 2u);  // of the two crosscuts in the middle
  const World world = make_world(s, 1);
  EXPECT_EQ(world.numbers.loops, 1);
  double cap = 0;
  for (size_t f = 0; f < world.mesh.face.size(); ++f)
    if (world.mesh.label[f] == Label::cap) cap += world.mesh.area(f);
  EXPECT_GT(cap, 4 * (3.7 - 1.4 - 0.8) * 1.9);  // less the round corners of the faces and a column more or less
  EXPECT_LT(cap, 4 * (3.7 + 0.8) * 1.9);
}

// From the middle of one side through the wall to the other: what is left of the way between the two dead ends' nodes.
TEST(Layouts, AStoppingIsAsThickAsAsked) {
  for (double thick : {0.3, 0.5, 1.2}) {
    WorldSettings s = panel();
    s.mesh_edge_m = 0.3;
    s.panel.stopping_share = 1;
    s.panel.stopping_m = thick;
    s.panel.stub_share = 0;
    const MinePlan plan = make_plan(s, 2);
    const World world = make_world(s, 2);
    EXPECT_TRUE(check_world(world).ok()) << check_world(world).what();
    const Caster caster(world.mesh);
    for (const PlanWall& w : plan.walls) {
      const Vec3 a = world.junctions[w.a].p_W, b = world.junctions[w.b].p_W, ahead = (b - a).normalized();
      for (double up : {0.5, 1.0, 1.4}) {
        const Vec3 off(0, 0, up);
        const double from_a = caster.nearest({a + off, ahead, 50}).range_m;
        const double from_b = caster.nearest({b + off, -ahead, 50}).range_m;
        // A wall has a tenth of the ribs' roughness of 55 mm to either side.
        EXPECT_NEAR((b - a).norm() - from_a - from_b, thick, 0.05);
        EXPECT_NEAR(from_a, 1, 0.15);  // centre lines wander, some per cent longer or shorter
      }
    }
  }
}

TEST(Layouts, PanelsTurnOffSubMainsBetweenBarrierPillars) {
  WorldSettings s = district(1500);
  s.district.submain_entries = 2;
  s.district.submain_panels = 2;
  s.district.missing_share = s.district.stopping_share = 0;
  const MinePlan plan = make_plan(s, 3);
  // No passage leads across another where the layout has no junction: crossings would have become nodes of four ways.
  std::vector<int> degree(plan.nodes.size(), 0);
  for (const PlanPassage& p : plan.passages) ++degree[p.a], ++degree[p.b];
  const auto four = std::count_if(degree.begin(), degree.end(), [](int d) { return d >= 4; });
  EXPECT_LT(4 * four, static_cast<long>(degree.size()));
  const World world = make_world(s, 3);
  EXPECT_TRUE(check_world(world).ok()) << check_world(world).what();
  EXPECT_EQ(world.pillars.size(), static_cast<size_t>(world.numbers.loops));
  s.district.submain_entries = 1;
  EXPECT_NE(error_of([&] { make_plan(s, 1); }).find("world.district.submain_entries = 1"), std::string::npos);
}

TEST(Layouts, ADistrictIsAsLongAsAskedUpToAPitch) {
  double before = 0;
  for (double length : {1000.0, 2000.0, 8000.0}) {
    const MinePlan plan = make_plan(district(length), 5);
    EXPECT_GT(length_of(plan), length);
    EXPECT_LT(length_of(plan), length + 1500);  // a pitch: two panels of three entries and its part of the mains
    EXPECT_GT(length_of(plan), before);
    before = length_of(plan);
  }
}

TEST(Layouts, EntriesWiderThanThePillarsAllowAreRefusedWithTheRange) {
  WorldSettings s = panel();
  s.panel.width_m = 11.9;
  s.panel.entry_spacing_m = 14;
  EXPECT_NE(error_of([&] { make_plan(s, 1); }).find("world.panel.width_m = 11.90 m"), std::string::npos);
  s = district(1000);
  s.district.panel_spacing_m = 8;
  EXPECT_NE(error_of([&] { make_plan(s, 1); }).find("world.district.width_m = 5.00 m"), std::string::npos);
}

TEST(Layouts, RoomsThatLeaveNoPillarsAreRefusedWithTheRange) {
  WorldSettings s = rooms();
  s.rooms.width_m = 11;
  EXPECT_NE(error_of([&] { make_plan(s, 1); }).find("world.rooms.width_m = 11.00 m"), std::string::npos);
  s = rooms();
  s.rooms.depth_m = 15;
  EXPECT_NE(error_of([&] { make_plan(s, 1); }).find("world.rooms.depth_m"), std::string::npos);
}

TEST(Truth, PassagesShareTheVolumeAndAWrongNumberIsFound) {
  World world = make_world(panel(), 2);
  double sum = 0;
  for (const Passage& p : world.passages) {
    // Its floor times its height, where no other passage meets it; junctions belong to one of those that meet.
    EXPECT_GT(p.volume_m3, 0.4 * p.length_m * p.width_m * p.height_m);
    sum += p.volume_m3;
  }
  EXPECT_NEAR(sum, world.numbers.volume_m3, 1e-9 * sum);
  EXPECT_TRUE(check_truth(world).empty());
  world.passages[0].volume_m3 += 0.01;
  world.numbers.loops += 1;
  EXPECT_EQ(check_truth(world).size(), 2u);
}

TEST(Truth, CyclesAreClosedWalks) {
  const World world = make_world(rooms(), 1);
  for (const std::vector<int>& cycle : cycle_basis(world)) {
    std::vector<int> ends(world.junctions.size(), 0);
    for (int id : cycle) {
      ++ends[world.passages[id].a];
      ++ends[world.passages[id].b];
    }
    for (int n : ends) EXPECT_TRUE(n == 0 || n == 2);
  }
}

TEST(Wear, SpalledRibsStandBackUnderTheRoofAndTheMeshStaysSound) {
  WorldSettings s = panel();
  s.mesh_edge_m = 0.25;
  s.panel.crosscuts = 2;
  const World before = make_world(s, 4);
  s.wear.slough_m = 0.5;
  s.wear.slough_share = 1;
  s.wear.sag_m = 0.15;
  s.wear.heave_m = 0.1;
  s.wear.bedding_m = 0.08;
  s.wear.scallop_m = 0.02;
  const World world = make_world(s, 4);
  EXPECT_TRUE(check_world(world).ok()) << check_world(world).what();
  EXPECT_TRUE(check_truth(world).empty());
  // Brows: rib faces whose rock lies above the void.
  double brow = 0, rib = 0, brow_before = 0;
  for (size_t f = 0; f < world.mesh.face.size(); ++f) {
    if (world.mesh.label[f] != Label::rib) continue;
    rib += world.mesh.area(f);
    if (world.mesh.normal(f).z() > 0.4) brow += world.mesh.area(f);
  }
  for (size_t f = 0; f < before.mesh.face.size(); ++f)
    if (before.mesh.label[f] == Label::rib && before.mesh.normal(f).z() > 0.4) brow_before += before.mesh.area(f);
  EXPECT_GT(brow, 0.1 * rib);
  EXPECT_GT(brow, 3 * brow_before);
}

// The share of the ribs whose faces stand within 12 degrees of one of the two sets of joints.
TEST(Wear, CleatBreaksRibsAlongTwoSetsOfJointsWhateverWayTheyRun) {
  WorldSettings s = panel();
  s.mesh_edge_m = 0.2;
  s.panel.crosscuts = 2;
  s.rib.rms_m = 0.01;
  const auto along_joints = [](const Mesh& mesh, double bearing) {
    double along = 0, all = 0;
    for (size_t f = 0; f < mesh.face.size(); ++f) {
      if (mesh.label[f] != Label::rib) continue;
      const Vec3 n = mesh.normal(f);
      const double off = std::remainder(std::atan2(n.y(), n.x()) - bearing, std::numbers::pi / 2);
      all += mesh.area(f);
      if (std::abs(off) < 12 * std::numbers::pi / 180) along += mesh.area(f);
    }
    return along / all;
  };
  const double bearing = 35 * std::numbers::pi / 180;  // entries run at 35 degrees to the joints, crosscuts too
  const double without = along_joints(make_world(s, 5).mesh, bearing);
  s.wear.cleat_m = 0.25;
  s.wear.cleat_deg = 35;
  const World world = make_world(s, 5);
  EXPECT_TRUE(check_world(world).ok()) << check_world(world).what();
  EXPECT_LT(without, 0.1);
  EXPECT_GT(along_joints(world.mesh, bearing), 0.25);  // edges of 0.2 m blur the steps' corners
}

TEST(Rocks, DustAndWaterCoverTheShareThatIsAsked) {
  WorldSettings s = panel();
  s.rock.dust_share = 0.3;
  s.rock.wet_share = 0.4;
  s.rock.patch_m = 2;
  const Mesh mesh = make_world(s, 6).mesh;
  double dust = 0, wet = 0, ribs = 0, all = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const double area = mesh.area(f);
    all += area;
    if (mesh.material[f] == Material::rock_dust) dust += area;
    if (mesh.label[f] == Label::rib) ribs += area, wet += area * mesh.wetness[f];
    EXPECT_TRUE(mesh.reflectivity[f] >= 0.02f && mesh.reflectivity[f] <= 1.0f);
    EXPECT_TRUE(mesh.wetness[f] >= 0 && mesh.wetness[f] <= 1);
  }
  // Some 1500 patches of 2 m; water's are twice as long, on the ribs alone some 150.
  EXPECT_NEAR(dust / all, 0.3, 0.06);
  EXPECT_NEAR(wet / ribs, 0.4, 0.12);
}

TEST(Rocks, WithoutWearEverythingLiesUnderDust) {
  const Mesh mesh = make_world(panel(), 6).mesh;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    ASSERT_EQ(mesh.material[f], Material::rock_dust);
    ASSERT_EQ(mesh.wetness[f], 0);
  }
}

}  // namespace
}  // namespace adit
