// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "rays/caster.h"
#include "worlds/plan.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace adit {
namespace {

WorldSettings mini(double edge_m = 0.3) {
  WorldSettings s;
  s.kind = "panel";
  s.mesh_edge_m = edge_m;
  return s;
}

WorldSettings bruceton(double edge_m) {
  WorldSettings s;
  s.x_max = -45;
  s.y_max = 182;
  s.mesh_edge_m = edge_m;
  return s;
}

double area_of(const Mesh& mesh, Label label) {
  double area = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f)
    if (mesh.label[f] == label) area += mesh.area(f);
  return area;
}

// Plan area of the floor: its faces seen from above.
double plan_area(const Mesh& mesh) {
  double area = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f)
    if (mesh.label[f] == Label::floor) area += mesh.area(f) * std::abs(mesh.normal(f).z());
  return area;
}

TEST(MakeWorld, EverySeedGivesASoundMeshWithItsLoopsAndPillars) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const World world = make_world(mini(0.35), seed);
    const WorldCheck check = check_world(world);
    EXPECT_TRUE(check.ok()) << "seed " << seed << ": " << check.what();
    EXPECT_NEAR(check.volume_m3, world.numbers.volume_m3, 1e-9 * check.volume_m3) << "seed " << seed;
    EXPECT_EQ(world.numbers.loops, 3) << "seed " << seed;
    EXPECT_EQ(world.pillars.size(), 3u) << "seed " << seed;
  }
}

TEST(MakeWorld, ObliqueStaggeredAndWidePanelsAreSoundToo) {
  for (double angle : {50.0, 60.0, 120.0}) {
    WorldSettings s = mini(0.4);
    s.panel.crosscut_angle_deg = angle;
    s.panel.stagger = 0.4;
    s.panel.entries = 3;
    s.panel.width_m = 5.5;
    s.panel.entry_spacing_m = 22;
    const World world = make_world(s, 7);
    EXPECT_TRUE(check_world(world).ok()) << angle << " deg: " << check_world(world).what();
    EXPECT_EQ(world.pillars.size(), 6u) << angle << " deg";
  }
}

TEST(MakeWorld, BrucetonIsSoundAndHasAPillarForEachLoop) {
  const World world = make_world(bruceton(0.4), 100);
  const WorldCheck check = check_world(world);
  EXPECT_TRUE(check.ok()) << check.what();
  EXPECT_EQ(world.numbers.loops, 22);
  EXPECT_EQ(world.pillars.size(), 22u);
}

TEST(MakeWorld, WithoutChanceAStraightEntryHasTheVolumeOfItsClosedForm) {
  WorldSettings s = mini(0.3);
  s.panel.entries = 1;
  s.panel.crosscuts = 2;
  s.panel.crosscut_spacing_m = 100;
  s.panel.stub_share = 0;
  s.panel.spacing_sd_m = s.width_sd_m = s.wander_m = s.wall_wander_m = s.height_sd_m = s.roll_m = s.grade_percent = 0;
  s.floor.rms_m = s.roof.rms_m = s.rib.rms_m = 0;
  const World world = make_world(s, 1);
  // 102 m long with its faces, 3.7 m wide, 1.9 m high, less four corners of 0.7 m; ribs are good to some millimetres.
  const double area = 102 * 3.7 - 4 * (1 - std::atan(1.0)) * 0.49;
  EXPECT_NEAR(world.numbers.volume_m3, area * 1.9, 0.003 * 2 * 105.7 * 1.9);
  EXPECT_NEAR(world.numbers.floor_area_m2 * 1.9, world.numbers.volume_m3,
              1e-6 * world.numbers.volume_m3);  // upright walls
  EXPECT_NEAR(area_of(world.mesh, Label::floor), world.numbers.floor_area_m2, 1e-6 * world.numbers.floor_area_m2);
  EXPECT_EQ(world.numbers.loops, 0);
  EXPECT_EQ(world.numbers.extraction_ratio, 1);
}

TEST(MakeWorld, EveryFaceIsLabelledWithAPartThatExists) {
  const World world = make_world(mini(), 3);
  std::map<Label, size_t> count;
  std::set<int> pillars_seen;
  for (size_t f = 0; f < world.mesh.face.size(); ++f) {
    const Label label = world.mesh.label[f];
    const int part = world.mesh.part[f];
    ++count[label];
    if (label == Label::floor || label == Label::roof) {
      ASSERT_TRUE(part >= 0 && part < static_cast<int>(world.passages.size())) << part;
      ASSERT_EQ(world.mesh.normal(f).z() < 0, label == Label::floor);  // out of the void
    } else {
      ASSERT_TRUE(part >= -1 && part < static_cast<int>(world.pillars.size())) << part;
      pillars_seen.insert(part);
    }
    ASSERT_TRUE(world.mesh.reflectivity[f] > 0.02 && world.mesh.reflectivity[f] <= 1);
  }
  EXPECT_EQ(count.size(), 3u);  // floor, roof, rib and no other
  EXPECT_EQ(count[Label::floor], count[Label::roof]);
  EXPECT_EQ(pillars_seen.size(), world.pillars.size() + 1);
}

TEST(MakeWorld, WhereTheSelectionCutsAPassageTheFaceIsACap) {
  WorldSettings s = bruceton(0.4);
  s.y_max = 90;
  s.y_min = 50;
  s.x_max = -200;
  const World world = make_world(s, 1);
  // Each is about 3.7 m x 1.9 m; its corners of 0.7 m are rock, a column of faces more or less.
  const MinePlan plan = make_plan(s, 1);
  const double cut = static_cast<double>(std::count(plan.cut.begin(), plan.cut.end(), 1));
  ASSERT_GE(cut, 3);
  EXPECT_GT(area_of(world.mesh, Label::cap), cut * (3.7 - 1.4 - 0.8) * 1.9);
  EXPECT_LT(area_of(world.mesh, Label::cap), cut * (3.7 + 0.4) * 1.9);
  EXPECT_TRUE(check_world(world).ok()) << check_world(world).what();
}

TEST(MakeWorld, VolumeIsFloorAreaTimesHeightUpToRoughness) {
  const World world = make_world(mini(), 4);
  double height = 0, length = 0;
  for (const Passage& p : world.passages) {
    height += p.height_m * p.length_m;
    length += p.length_m;
  }
  // Height varies by 0.1 m over 50 m and is sampled along the middle: 2 % covers it.
  EXPECT_NEAR(world.numbers.volume_m3, world.numbers.floor_area_m2 * height / length, 0.02 * world.numbers.volume_m3);
  EXPECT_NEAR(plan_area(world.mesh), world.numbers.floor_area_m2, 0.01 * world.numbers.floor_area_m2);
}

TEST(MakeWorld, PassagesAreAsWideAndHighAsAsked) {
  double width = 0, height = 0, n = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    for (const Passage& p : make_world(mini(0.5), seed).passages) {
      EXPECT_NEAR(p.width_m, 3.7, 0.65);   // 2.5 sd of the width and of both ribs' wander
      EXPECT_NEAR(p.height_m, 1.9, 0.35);  // 2.5 sd of the height, some of roof and floor
      width += p.width_m;
      height += p.height_m;
      ++n;
    }
  }
  EXPECT_NEAR(width / n, 3.7, 5 * 0.15 / std::sqrt(n));    // five standard errors
  EXPECT_NEAR(height / n, 1.9, 5 * 0.1 / std::sqrt(4.0));  // passages of a mine share their height: four mines
}

// The nearest rock to a point a metre above the floor is the rib, or the floor or roof about a metre away.
TEST(MakeWorld, CentreLinesRunInTheVoidWithRoomToBothSides) {
  for (const WorldSettings& s : {mini(), bruceton(0.5)}) {
    const World world = make_world(s, 11);
    const Caster caster(world.mesh);
    for (const Passage& p : world.passages)
      for (const Vec3& v : p.centre_line) {
        const Vec3 eye = v + Vec3(0, 0, 0.5 * p.height_m);
        EXPECT_FALSE(caster.closest(eye, 0.55))
            << "at " << v.transpose();  // a dead end's face is 1 m less its roughness away
        EXPECT_NEAR(caster.nearest({eye, {0, 0, -1}, 10}).range_m, 0.5 * p.height_m,
                    0.06);  // the mesh between its vertices
      }
  }
}

TEST(MakeWorld, TheGraphIsConsistentAndItsLinesMeetInTheJunctions) {
  const World world = make_world(bruceton(0.6), 2);
  for (size_t i = 0; i < world.passages.size(); ++i) {
    const Passage& p = world.passages[i];
    EXPECT_LT((p.centre_line.front() - world.junctions[p.a].p_W).norm(), 1e-9);
    EXPECT_LT((p.centre_line.back() - world.junctions[p.b].p_W).norm(), 1e-9);
    for (int j : {p.a, p.b}) {
      const auto& here = world.junctions[j].passages;
      EXPECT_EQ(std::count(here.begin(), here.end(), static_cast<int>(i)), 1);
    }
  }
}

// A cart of 0.8 m by 0.65 m on its four wheels tips with the ground's roughness by one to two degrees (rms).
TEST(MakeWorld, TheFloorTipsACartByOneToTwoDegrees) {
  const World world = make_world(mini(0.2), 5);
  const Caster caster(world.mesh);
  double pitch = 0, roll = 0, n = 0;
  for (const Passage& p : world.passages) {
    for (size_t i = 1; i + 1 < p.centre_line.size(); ++i) {
      const Vec2 ahead = (p.centre_line[i + 1] - p.centre_line[i - 1]).head<2>().normalized(),
                 left(-ahead.y(), ahead.x());
      const auto ground = [&](double x, double y) {
        const Vec2 q = p.centre_line[i].head<2>() + x * ahead + y * left;
        const double top = p.centre_line[i].z() + 1;
        return top - caster.nearest({{q.x(), q.y(), top}, {0, 0, -1}, 10}).range_m;
      };
      const double fl = ground(0.4, 0.325), fr = ground(0.4, -0.325), rl = ground(-0.4, 0.325),
                   rr = ground(-0.4, -0.325);
      pitch += std::pow((fl + fr - rl - rr) / 2 / 0.8, 2);
      roll += std::pow((fl + rl - fr - rr) / 2 / 0.65, 2);
      ++n;
    }
  }
  const double degree = std::atan(1.0) / 45;
  EXPECT_GT(std::sqrt(pitch / n) / degree, 1.0);
  EXPECT_LT(std::sqrt(pitch / n) / degree, 3.0);  // with the grade and the rolls, which add about 1.5 deg
  EXPECT_GT(std::sqrt(roll / n) / degree, 1.0);
  EXPECT_LT(std::sqrt(roll / n) / degree, 3.0);
}

// Ribs about their smooth line: the same mine without roughness.
TEST(MakeWorld, RibsAreAsRoughAsAsked) {
  WorldSettings s = mini(0.2);
  const World rough = make_world(s, 5);
  s.rib.rms_m = 0;
  s.floor.rms_m = s.roof.rms_m = 0;
  const World smooth = make_world(s, 5);
  const Caster caster(smooth.mesh);
  double sum = 0, n = 0;
  for (const Pillar& p : rough.pillars) {
    for (const Vec2& q : p.outline) {
      // Height of the smooth mine's middle there, from its junctions' neighbourhood: the nearest centre line point.
      double best = 1e9, z = 0;
      for (const Passage& way : smooth.passages)
        for (const Vec3& v : way.centre_line)
          if ((v.head<2>() - q).norm() < best) {
            best = (v.head<2>() - q).norm();
            z = v.z() + 0.95;
          }
      const auto closest = caster.closest({q.x(), q.y(), z}, 0.6);
      if (!closest) continue;
      sum += std::pow((closest->point.head<2>() - q).norm(), 2);
      ++n;
    }
  }
  ASSERT_GT(n, 500);
  EXPECT_NEAR(std::sqrt(sum / n), 0.055, 0.012);  // some 250 correlation lengths of rib: 5 % one sigma, and the smooth
                                                  // mine's facets
}

TEST(MakeWorld, ASeedIsAMineAndAnotherSeedAnotherOne) {
  const std::string one = world_hash(make_world(mini(0.5), 1));
  EXPECT_EQ(one, world_hash(make_world(mini(0.5), 1)));
  EXPECT_NE(one, world_hash(make_world(mini(0.5), 2)));
}

TEST(MakeWorld, AnyNumberOfThreadsMakesTheSameMine) {
  std::set<std::string> hashes;
  for (int threads : {1, 2, 7}) {
    set_threads(threads);
    hashes.insert(world_hash(make_world(mini(0.4), 9)));
  }
  set_threads(0);
  EXPECT_EQ(hashes.size(), 1u);
}

TEST(MakeWorld, AMeshEdgeBeyondThePassagesIsRefusedWithTheRange) {
  WorldSettings s = mini(0.9);
  try {
    make_world(s, 1);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("world.mesh_edge_m = 0.90"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("at most 0.63"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace adit
