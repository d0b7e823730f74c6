// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/worlds.h"

#include "base/error.h"
#include "worlds/drift.h"
#include "worlds/outline.h"
#include "worlds/plan.h"
#include "worlds/polygons.h"
#include "worlds/shell.h"
#include "worlds/skeleton.h"
#include "worlds/terrain.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

std::string text(double v) {
  std::string t = std::to_string(v);
  return t.substr(0, t.find('.') + 3);
}

void check_settings(const WorldSettings& s, const MinePlan& plan) {
  double finest = plan.passages[0].width_m;
  for (const PlanPassage& p : plan.passages) finest = std::min(finest, p.width_m);
  const double coarsest = std::min(finest, s.height_m) / 3;
  if (s.mesh_edge_m > coarsest)
    throw Error("world.mesh_edge_m = " + text(s.mesh_edge_m) + ": too coarse for passages of " + text(finest) +
                " m by " + text(s.height_m) + " m; at most " + text(coarsest));
  if (s.roll_min_m > s.roll_max_m)
    throw Error("world.roll_min_m = " + text(s.roll_min_m) + ": must not be above world.roll_max_m");
}

Vec2 middle_of(const MinePlan& plan) {
  Vec2 low = plan.nodes[0], high = low;
  for (const Vec2& p : plan.nodes) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return 0.5 * (low + high);
}

// Ends of passages that are not rock: where the selection's border cut them off, stoppings, gob.
struct CutEnd {
  const Drift* drift;
  bool at_b;
  double half_m;  // of the face, with a margin
};

std::vector<CutEnd> cut_ends(const MinePlan& plan, const std::vector<Drift>& drifts) {
  std::vector<CutEnd> ends;
  for (size_t i = 0; i < drifts.size(); ++i)
    for (bool at_b : {false, true})
      if (plan.cut[at_b ? plan.passages[i].b : plan.passages[i].a])
        ends.push_back({&drifts[i], at_b, std::max(drifts[i].left.back(), drifts[i].right.back()) + 0.5});
  return ends;
}

bool is_cap(const std::vector<CutEnd>& ends, const Vec2& p) {
  return std::any_of(ends.begin(), ends.end(), [&](const CutEnd& e) {
    return ((e.at_b ? e.drift->line.back() : e.drift->line.front()) - p).norm() < e.half_m &&
           std::abs(beyond_end(*e.drift, e.at_b, p)) < 0.3;
  });
}

Vec3 on_floor(const Vec2& p, const Terrain& terrain) {
  return {p.x(), p.y(), terrain.floor_z(p)};
}

// Every second point of the drift: about one a metre.
std::vector<Vec3> centre_line(const Drift& d, const Terrain& terrain) {
  std::vector<Vec3> line;
  for (size_t i = 0; i < d.line.size(); i += 2) line.push_back(on_floor(d.line[i], terrain));
  if (d.line.size() % 2 == 0) line.push_back(on_floor(d.line.back(), terrain));
  return line;
}

Passage passage_of(const PlanPassage& p, const Drift& d, const Terrain& terrain) {
  Passage passage{p.a, p.b, centre_line(d, terrain), d.width_m(), 0, 0};
  for (const Vec3& v : passage.centre_line) passage.height_m += terrain.roof_z(v.head<2>()) - v.z();
  passage.height_m /= static_cast<double>(passage.centre_line.size());
  for (size_t i = 1; i < passage.centre_line.size(); ++i)
    passage.length_m += (passage.centre_line[i] - passage.centre_line[i - 1]).head<2>().norm();
  return passage;
}

void add_graph(const MinePlan& plan, const std::vector<Drift>& drifts, const Terrain& terrain, World& world) {
  world.junctions.resize(plan.nodes.size());
  for (size_t i = 0; i < drifts.size(); ++i) {
    const PlanPassage& p = plan.passages[i];
    world.passages.push_back(passage_of(p, drifts[i], terrain));
    world.junctions[p.a].p_W = world.passages.back().centre_line.front();
    world.junctions[p.b].p_W = world.passages.back().centre_line.back();
    world.junctions[p.a].passages.push_back(static_cast<int>(i));
    if (p.b != p.a) world.junctions[p.b].passages.push_back(static_cast<int>(i));
  }
}

void add_numbers(const std::vector<Loop>& mid_height, World& world) {
  double rock = 0;
  for (size_t l = 0; l < mid_height.size(); ++l) {
    const double area = enclosed_area(mid_height[l]);
    world.numbers.floor_area_m2 += area;  // pillars run clockwise: theirs are negative
    if (l == 0) continue;
    rock -= area;
    world.pillars.push_back({{mid_height[l].rbegin(), mid_height[l].rend()}, -area});
  }
  world.numbers.volume_m3 = enclosed_volume(world.mesh);
  world.numbers.extraction_ratio = world.numbers.floor_area_m2 / (world.numbers.floor_area_m2 + rock);
  world.numbers.loops =
      static_cast<int>(world.passages.size()) - static_cast<int>(world.junctions.size()) + 1;  // connected
}

}  // namespace

World make_world(const WorldSettings& s, std::uint64_t seed, const Progress& progress) {
  const bool drawn = s.kind == "plan" && s.plan.ends_with(".geojson");
  const Lattice depth = drawn ? depth_of(read_polygons(s.plan), s.corner_radius_m) : Lattice{};
  Skeleton skeleton = drawn ? skeleton_of(depth) : Skeleton{make_plan(s, seed), {}};
  const MinePlan& plan = skeleton.plan;
  check_settings(s, plan);
  progress("laying out the mine", 0, 4);
  const std::vector<Drift> drifts = drawn ? std::move(skeleton.drifts) : drive_passages(plan, s, seed);
  const Outline outline = drawn ? outline_of(depth, drifts, s.corner_radius_m) : outline_of(drifts, s.corner_radius_m);
  progress("laying out the mine", 1, 4);
  const Terrain terrain(s, middle_of(plan), outline.depth, seed);
  const std::vector<CutEnd> ends = cut_ends(plan, drifts);
  Shell shell = make_shell(
      outline, terrain, [&](const Vec2& p) { return is_cap(ends, p); }, s.mesh_edge_m, s.height_m, seed);
  progress("laying out the mine", 3, 4);
  World world;
  world.name = s.kind == "plan" ? s.plan : s.kind;
  world.mesh = std::move(shell.mesh);
  add_graph(plan, drifts, terrain, world);
  for (size_t i = 0; i < shell.volume_m3.size(); ++i) world.passages[i].volume_m3 = shell.volume_m3[i];
  add_numbers(shell.mid_height, world);
  world.outline = std::move(shell.mid_height[0]);
  progress("laying out the mine", 4, 4);
  return world;
}

}  // namespace adit
