// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "rays/caster.h"
#include "worlds/decay.h"
#include "worlds/fittings.h"
#include "worlds/solid.h"
#include "worlds/space.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

namespace adit {
namespace {

// A short panel with everything in it.
WorldSettings full(double edge_m = 0.35) {
  WorldSettings s;
  s.kind = "panel";
  s.panel.crosscuts = 3;
  s.panel.width_m = 5;
  s.mesh_edge_m = edge_m;
  s.condition = "abandoned";
  FurnitureSettings& f = s.furniture;
  f.post_share = f.crossbar_share = 0.5;
  f.bolt_share = 0.4;
  f.belt_share = f.track_share = f.pipe_share = f.cable_share = 0.7;
  f.cribs_per_100m = f.pools_per_100m = 4;
  f.stopping_share = f.cars_per_100m = f.beams_per_100m = 0.5;
  return s;
}

// The same panel with nothing in it.
WorldSettings empty(double edge_m) {
  WorldSettings s = full(edge_m);
  s.condition = "bare";
  s.furniture = {};
  return s;
}

// Two levels 2 m apart over the unit square's four triangles, and sides: a room of 8 m x 8 m.
Mesh room() {
  Mesh m;
  for (double z : {0.0, 2.0})
    for (const Vec2& p : {Vec2(-4, -4), Vec2(4, -4), Vec2(4, 4), Vec2(-4, 4), Vec2(0.1, 0.2)})
      m.vertex.emplace_back(p.x(), p.y(), z);
  m.vertex[4].z() = 0.3;  // a hump
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t a = k, b = (k + 1) % 4;
    m.face.push_back({a, 4, b});
    m.face.push_back({5 + a, 5 + b, 9});
    m.label.insert(m.label.end(), {Label::floor, Label::roof});
  }
  for (std::uint32_t k = 0; k < 4; ++k) {
    const std::uint32_t a = k, b = (k + 1) % 4;
    m.face.push_back({a, b, 5 + b});
    m.face.push_back({a, 5 + b, 5 + a});
    m.label.insert(m.label.end(), 2, Label::rib);
  }
  return m;
}

TEST(Solid, LoftsAndTubesAreClosedAndHaveTheirVolumes) {
  const Solid b = box(Pose::Identity(), {1, 2, 0.5});
  EXPECT_TRUE(b.closed());
  EXPECT_NEAR(b.volume_m3(), 8, 1e-12);
  const Solid t = tube_along({Vec3(0, 0, 0), Vec3(3, 0, 0)}, 0.1, 12);
  EXPECT_TRUE(t.closed());
  EXPECT_NEAR(t.volume_m3(), 3 * 6 * 0.01 * std::sin(std::numbers::pi / 6), 1e-12);  // a prism of 12 sides
}

TEST(Space, AColumnFollowsFloorAndRoofAndLeavesAMillimetre) {
  const Mesh rock = room();
  ASSERT_EQ(open_edges(rock), 0u);
  ASSERT_GT(enclosed_volume(rock), 0);
  const Space space(rock, 4);
  const auto patch = space.patch(rectangle({0.3, 0.1}, {1, 0}, 0.5, 0.5));
  ASSERT_TRUE(patch);
  const auto c = column(
      *patch, [](const LevelPoint& v) { return v.floor_z + Space::gap_m; },
      [](const LevelPoint& v) { return v.roof_z - Space::gap_m; });
  ASSERT_TRUE(c);
  EXPECT_TRUE(c->closed());
  // The floor under it is a pyramid's part: its integral by midpoints of a fine grid.
  double under = 0;
  constexpr int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) under += space.level({-0.2 + (i + 0.5) / n, -0.4 + (j + 0.5) / n})->floor_z / (n * n);
  EXPECT_NEAR(c->volume_m3(), 2 - 2 * Space::gap_m - under, 1e-6);
}

TEST(Space, APatchBeyondTheRibsIsNone) {
  const Mesh rock = room();
  const Space space(rock, 4);
  EXPECT_FALSE(space.patch(rectangle({3.8, 0}, {1, 0}, 0.5, 0.5)));
  EXPECT_TRUE(space.patch(rectangle({3.4, 0}, {1, 0}, 0.5, 0.5)));
}

TEST(Space, WhatTouchesRockOrABodyOrLiesWithinOneIsRefused) {
  const Mesh rock = room();
  Space space(rock, 4);
  const auto at = [](const Vec3& p, double half) {
    return std::vector<Solid>{box(Pose(Eigen::Translation3d(p)), Vec3::Constant(half))};
  };
  EXPECT_TRUE(space.put(Label::block, 0, at({1, 1, 1}, 0.3), 0));
  EXPECT_FALSE(space.put(Label::block, 0, at({1.5, 1, 1}, 0.3), 0));   // crosses it
  EXPECT_FALSE(space.put(Label::block, 0, at({1, 1, 1}, 0.1), 0));     // within it
  EXPECT_FALSE(space.put(Label::block, 0, at({1, 1, 1}, 0.6), 0));     // round it
  EXPECT_FALSE(space.put(Label::block, 0, at({-2, 0, 0.1}, 0.3), 0));  // in the floor
  EXPECT_FALSE(space.put(Label::block, 0, at({9, 0, 1}, 0.3), 0));     // in the rock as a whole
  EXPECT_TRUE(space.put(Label::block, 0, at({-2, 0, 1}, 0.3), 0));
  ASSERT_EQ(space.objects().size(), 2u);
  EXPECT_NEAR(space.objects()[0].volume_m3, 0.216, 1e-12);
}

TEST(Furniture, EverySeedIsSoundAndVoidAndBodiesMakeUpTheBareVoid) {
  std::set<Label> seen;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const World world = make_world(full(), seed);
    const WorldCheck check = check_world(world);
    EXPECT_TRUE(check.ok()) << "seed " << seed << ": " << check.what();
    const auto faults = check_truth(world);
    EXPECT_TRUE(faults.empty()) << "seed " << seed << ": " << faults.front();
    double bodies = 0;
    for (const MineObject& o : world.objects) {
      seen.insert(o.label);
      if (!o.ground) bodies += o.volume_m3;
    }
    EXPECT_NEAR(world.numbers.volume_m3 + bodies, world.numbers.bare_m3, 1e-9 * world.numbers.bare_m3)
        << "seed " << seed;
  }
  for (Label label : {Label::post, Label::crossbar, Label::crib, Label::bolt, Label::rail, Label::tie, Label::belt,
                      Label::pipe, Label::cable, Label::water, Label::block})
    EXPECT_TRUE(seen.contains(label)) << label_name(label);
}

TEST(Furniture, ATruthWithAWrongVolumeIsFound) {
  World world = make_world(full(), 1);
  const auto body =
      std::find_if(world.objects.begin(), world.objects.end(), [](const MineObject& o) { return !o.ground; });
  ASSERT_NE(body, world.objects.end());
  body->volume_m3 *= 1.01;
  EXPECT_FALSE(check_truth(world).empty());
}

// A tube as wide as the lane, along the centre line of every passage that is open.
TEST(Furniture, TheLaneOfAnOpenPassageIsClear) {
  const WorldSettings s = full();
  const World world = make_world(s, 2);
  const Caster caster(world.mesh);
  size_t looked = 0;
  for (const Passage& p : world.passages) {
    if (p.blocked) continue;
    for (size_t i = 4; i + 4 < p.centre_line.size(); ++i) {
      const auto near = caster.closest(p.centre_line[i] + Vec3(0, 0, 0.9), 0.45 * s.furniture.lane_m);
      ++looked;
      if (!near) continue;
      const Label met = world.mesh.label[static_cast<size_t>(near->face)];
      // A crossbar and a bolt are overhead; water is driven through.
      EXPECT_FALSE(met >= Label::post && met != Label::crossbar && met != Label::bolt && met != Label::water)
          << label_name(met);
    }
  }
  EXPECT_GT(looked, 20u);
}

// Turning needs 2.5 m to either side of the centre line, within 7 m of the face.
TEST(Furniture, WhereVehiclesTurnInADeadEndNothingStandsInTheirWay) {
  WorldSettings s = full();
  s.panel.width_m = 6.5;  // so wide that things may stand beside the turn
  s.panel.stub_length_m = 20;
  const World world = make_world(s, 2);
  const auto stands = [](Label label) {
    return label == Label::post || label == Label::crossbar || label == Label::crib || label == Label::belt ||
           label == Label::block;
  };
  size_t within = 0, beyond = 0;  // corners of such things that stand less than 2.5 m off the centre line
  for (const Passage& p : world.passages)
    for (const bool at_b : {false, true}) {
      if (p.blocked || world.junctions[static_cast<size_t>(at_b ? p.b : p.a)].degree() > 1) continue;
      const Vec2 face = (at_b ? p.centre_line.back() : p.centre_line.front()).head<2>();
      for (size_t f = 0; f < world.mesh.face.size(); ++f) {
        if (!stands(world.mesh.label[f])) continue;
        const Vec3 v = world.mesh.corner(f, 0);
        for (const Vec3& q : p.centre_line) {
          if ((q - v).head<2>().norm() > 2.35 || v.z() - q.z() > 1) continue;  // line's points lie up to 1 m apart
          ((q.head<2>() - face).norm() < 7 ? within : beyond) += 1;
        }
      }
    }
  EXPECT_EQ(within, 0u);
  EXPECT_GT(beyond, 20u);
}

TEST(Furniture, TilesGiveSoundPartsToo) {
  WorldSettings s = full(0.4);
  s.tile_m = 60;
  PartsCheck check;
  size_t parts = 0;
  const World world = make_parts(s, 3, [&](MinePart&& part) { check.add(part), ++parts; });
  EXPECT_GT(parts, 1u);
  EXPECT_TRUE(check.finish().ok()) << check.finish().what();
  const auto faults = check_truth(world, check.tally());
  EXPECT_TRUE(faults.empty()) << faults.front();
}

TEST(Furniture, ABareMineHasNoObjectsAndItsVolumeNeedsNoOther) {
  WorldSettings s = empty(0.5);
  const World world = make_world(s, 1);
  EXPECT_TRUE(world.objects.empty());
  EXPECT_EQ(world.numbers.bare_m3, 0);
}

TEST(Decay, UnlessItMayCutSomeLoopIsLeft) {
  WorldSettings s = full(0.5);
  s.furniture = {};
  s.decay.falls_per_100m = 5;
  s.decay.cleared_share = 0;
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const World world = make_world(s, seed);
    EXPECT_GT(std::count_if(world.passages.begin(), world.passages.end(), [](const Passage& p) { return p.blocked; }),
              0)
        << seed;
    EXPECT_GT(plan_route(world, {}, seed).length_m, 0) << seed;
  }
  s.decay.may_cut = true;
  s.furniture.stopping_share = 1;
  const World cut = make_world(s, 1);
  EXPECT_THROW(plan_route(cut, {}, 1), Error);
}

TEST(Decay, RubbleLiesLooserThanItWasAndNoSteeperThanItsRepose) {
  Fall f{};
  f.along = {1, 0};
  f.half_along_m = 4;
  f.half_across_m = 2;
  f.heap_m = 1.5;
  f.repose = std::tan(37 * std::numbers::pi / 180);
  for (double x = -6; x < 6; x += 0.37)
    for (double y = -4; y < 4; y += 0.41) {
      const double h = f.rubble_m({x, y});
      EXPECT_LE(std::hypot(f.rubble_m({x + 1e-4, y}) - h, f.rubble_m({x, y + 1e-4}) - h) / 1e-4,
                f.repose + 1e-3);  // a difference over 0.1 mm of a cone
    }
  EXPECT_EQ(f.rubble_m({0, 0}), 1.5);
  EXPECT_EQ(f.rubble_m({0, 1.5 / f.repose + 0.01}), 0);
}

// Low and high corner of the faces of each object that is a part of the rock's surface.
std::map<int, std::pair<Vec3, Vec3>> boxes_of(const Mesh& mesh, Label label) {
  std::map<int, std::pair<Vec3, Vec3>> boxes;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    if (mesh.label[f] != label) continue;
    auto& [low, high] = boxes.try_emplace(mesh.part[f], mesh.corner(f, 0), mesh.corner(f, 0)).first->second;
    for (int k = 0; k < 3; ++k) low = low.cwiseMin(mesh.corner(f, k)), high = high.cwiseMax(mesh.corner(f, k));
  }
  return boxes;
}

TEST(Decay, WhatFellAndWhereItFellFromBearTheirLabelsAndNumbers) {
  WorldSettings s = empty(0.35);
  s.decay.falls_per_100m = 3;
  s.decay.skins_per_100m = 3;
  std::map<Label, size_t> seen;
  for (const double tile_m : {0.0, 60.0}) {
    s.tile_m = tile_m;
    const World world = make_world(s, 1);
    EXPECT_TRUE(check_truth(world).empty()) << check_truth(world).front();
    EXPECT_EQ(world.numbers.bare_m3, world.numbers.volume_m3);  // no bodies among them
    for (Label label : {Label::rubble, Label::cavity, Label::scar})
      for (const auto& [id, box] : boxes_of(world.mesh, label)) {
        const MineObject& o = world.objects.at(static_cast<size_t>(id));
        ++seen[label];
        EXPECT_EQ(o.label, label);
        EXPECT_TRUE(o.ground);
        EXPECT_GT(o.volume_m3, 0);
        EXPECT_LT((o.middle_W - 0.5 * o.size_m - box.first).norm(), 1e-9) << label_name(label) << ' ' << id;
        EXPECT_LT((o.middle_W + 0.5 * o.size_m - box.second).norm(), 1e-9) << label_name(label) << ' ' << id;
      }
  }
  EXPECT_GT(seen[Label::rubble], 1u);
  EXPECT_GT(seen[Label::cavity], 1u);
  EXPECT_GT(seen[Label::scar], 1u);
}

TEST(Decay, NothingThatStoodBeforeAFallIsOnItsRubble) {
  WorldSettings s = full(0.5);
  s.decay.falls_per_100m = 5;
  s.decay.cleared_share = 0;
  s.furniture.track_share = s.furniture.post_share = s.furniture.bolt_share = 1;
  const World world = make_world(s, 1);
  std::vector<Vec2> deep;  // where rubble lies 0.3 m and more over its lowest
  for (size_t f = 0; f < world.mesh.face.size(); ++f) {
    if (world.mesh.label[f] != Label::rubble) continue;
    const MineObject& heap = world.objects[static_cast<size_t>(world.mesh.part[f])];
    const Vec3 p = (world.mesh.corner(f, 0) + world.mesh.corner(f, 1) + world.mesh.corner(f, 2)) / 3;
    if (p.z() > heap.middle_W.z() - 0.5 * heap.size_m.z() + 0.3) deep.emplace_back(p.head<2>());
  }
  EXPECT_GT(deep.size(), 50u);
  size_t looked = 0;
  for (const MineObject& o : world.objects) {
    if (o.label != Label::rail && o.label != Label::tie && o.label != Label::post && o.label != Label::bolt) continue;
    ++looked;
    for (const Vec2& p : deep) EXPECT_GT((p - o.middle_W.head<2>()).norm(), 0.25) << label_name(o.label);
  }
  EXPECT_GT(looked, 50u);
}

// Where pillars were robbed a passage has ribs in places only: a wall across it would run on through its neighbours.
TEST(Furniture, AStoppingReachesNoFurtherThanOnePassage) {
  const Mesh rock = room();  // 4 m to either side
  const Space space(rock, 4);
  const Spot spot{{0.5, 0}, Vec2::UnitX()};
  EXPECT_FALSE(stopping(space, spot, 0, 0.006, 4.1).wall.empty());
  EXPECT_TRUE(stopping(space, spot, 0, 0.006, 3.9).wall.empty());
}

// Chance asks for the same things however wide a passage is and however the mine is made.
TEST(Furniture, WhatHasNoRoomIsTold) {
  WorldSettings s = empty(0.5);
  s.furniture.belt_share = 1;
  s.furniture.post_share = 1;
  const auto count = [](const World& world, Label label) {
    return static_cast<int>(std::count_if(world.objects.begin(), world.objects.end(),
                                          [&](const MineObject& o) { return o.label == label; }));
  };
  const auto left_out = [](const World& world, Label label) {
    const auto found = world.left_out.find(label);
    return found == world.left_out.end() ? 0 : found->second;
  };
  const World wide = make_world(s, 1);
  EXPECT_GT(count(wide, Label::belt), 0);
  s.tile_m = 60;
  const World tiled = make_world(s, 1);
  for (const Label label : {Label::belt, Label::post})
    EXPECT_EQ(count(wide, label) + left_out(wide, label), count(tiled, label) + left_out(tiled, label))
        << label_name(label);
  s.tile_m = 0;
  s.panel.width_m = 3.7;
  const World narrow = make_world(s, 1);
  EXPECT_EQ(count(narrow, Label::belt), 0);
  EXPECT_GT(left_out(narrow, Label::belt), 10);
}

TEST(Condition, WhatIsSetIsKeptAndTheRestFollowsTheCondition) {
  WorldSettings s;
  s.condition = "abandoned";
  s.furniture.post_share = 0;
  s.wear.slough_m = 0.7;
  const WorldSettings d = in_condition(s);
  EXPECT_EQ(d.furniture.post_share, 0);
  EXPECT_EQ(d.wear.slough_m, 0.7);
  EXPECT_GT(d.furniture.cribs_per_100m, 0);
  EXPECT_GT(d.decay.falls_per_100m + d.decay.skins_per_100m, 1);  // 1-3 in 100 m where a mine is left to itself
  EXPECT_LT(d.decay.falls_per_100m + d.decay.skins_per_100m, 3);
}

}  // namespace
}  // namespace adit
