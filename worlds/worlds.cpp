// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/worlds.h"

#include "base/error.h"
#include "worlds/drift.h"
#include "worlds/furniture.h"
#include "worlds/outline.h"
#include "worlds/pieces.h"
#include "worlds/plan.h"
#include "worlds/polygons.h"
#include "worlds/shell.h"
#include "worlds/skeleton.h"
#include "worlds/terrain.h"
#include "worlds/tiles.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace adit {
namespace {

std::string text(double v) {
  std::string t = std::to_string(v);
  return t.substr(0, t.find('.') + 3);
}

constexpr double most_triangles = 1e8, most_triangles_in_tiles = 2e9;

// Floor and roof of triangles with sides of an edge, ribs of squares cut in two.
double triangles_of(const WorldSettings& s, const MinePlan& plan) {
  double n = 0;
  for (const PlanPassage& p : plan.passages)
    for (size_t i = 1; i < p.line.size(); ++i)
      n += (p.line[i] - p.line[i - 1]).norm() * (2 * p.width_m / std::sqrt(3.0 / 16) + 4 * s.height_m);
  return n / (s.mesh_edge_m * s.mesh_edge_m);
}

void check_size(const WorldSettings& s, const MinePlan& plan) {
  const double n = triangles_of(s, plan), most = s.tile_m > 0 ? most_triangles_in_tiles : most_triangles;
  if (n <= most) return;
  throw Error("world.mesh_edge_m = " + text(s.mesh_edge_m) + ": the mine would have some " +
              std::to_string(std::llround(n / 1e6)) + " million triangles, at most " +
              std::to_string(std::llround(most / 1e6)) + " million are made" +
              (s.tile_m > 0 ? "" : " in one piece (world.tile_m = 0)") + "; an edge of " +
              text(s.mesh_edge_m * std::sqrt(n / most) + 0.005) + " m would do");
}

void check_settings(const WorldSettings& s, const MinePlan& plan) {
  if (s.tile_m > 0 && s.tile_m < 40)
    throw Error("world.tile_m = " + text(s.tile_m) + ": 0 for one piece, or 40 and more");
  check_size(s, plan);
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

// Ends of passages that are not rock: where the selection's border cut them off, gob.
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

// What in a tile is no rock: the ends of passages and the walls.
struct Faces {
  std::vector<CutEnd> ends;
  std::vector<Wall> walls;

  bool operator()(const Vec2& p) const {
    return std::any_of(walls.begin(), walls.end(), [&](const Wall& w) { return w.distance(p) < 0.08; }) ||
           std::any_of(ends.begin(), ends.end(), [&](const CutEnd& e) {
             return ((e.at_b ? e.drift->line.back() : e.drift->line.front()) - p).norm() < e.half_m &&
                    std::abs(beyond_end(*e.drift, e.at_b, p)) < 0.3;
           });
  }
};

Faces faces_in(const Frame2& frame, const std::vector<CutEnd>& ends, const std::vector<Wall>& walls) {
  Faces found;
  for (const CutEnd& e : ends) {
    const Vec2& p = e.at_b ? e.drift->line.back() : e.drift->line.front();
    if (frame.meets({p, p}, e.half_m)) found.ends.push_back(e);
  }
  for (const Wall& w : walls)
    if (frame.meets({w.middle, w.middle}, w.wide_m)) found.walls.push_back(w);
  return found;
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

// Junctions of passages that are all known.
void add_junctions(const MinePlan& plan, World& world) {
  world.junctions.resize(plan.nodes.size());
  for (size_t i = 0; i < world.passages.size(); ++i) {
    const PlanPassage& p = plan.passages[i];
    world.junctions[p.a].p_W = world.passages[i].centre_line.front();
    world.junctions[p.b].p_W = world.passages[i].centre_line.back();
    world.junctions[p.a].passages.push_back(static_cast<int>(i));
    if (p.b != p.a) world.junctions[p.b].passages.push_back(static_cast<int>(i));
  }
}

void add_numbers(std::vector<Loop> mid_height, World& world) {
  double rock = 0;
  for (size_t l = 0; l < mid_height.size(); ++l) {
    const double area = enclosed_area(mid_height[l]);
    world.numbers.floor_area_m2 += area;  // pillars run clockwise: theirs are negative
    if (l == 0) continue;
    rock -= area;
    std::reverse(mid_height[l].begin(), mid_height[l].end());
    world.pillars.push_back({std::move(mid_height[l]), -area});
  }
  world.outline = std::move(mid_height[0]);
  world.numbers.extraction_ratio = world.numbers.floor_area_m2 / (world.numbers.floor_area_m2 + rock);
  world.numbers.loops =
      static_cast<int>(world.passages.size()) - static_cast<int>(world.junctions.size()) + 1;  // connected
}

// Gives the vertices of the tiles their numbers in the mine.
class Numbering {
 public:
  std::vector<std::uint32_t> ids_of(const Shell& shell) {
    std::vector<std::uint32_t> ids(shell.mesh.vertex.size(), none);
    for (const auto& [cut, seam] : shell.seams) {
      const auto known = seams_.find(cut);
      if (known == seams_.end()) continue;
      ADIT_CHECK(known->second.size() == seam.size());
      for (size_t k = 0; k < seam.size(); ++k) ids[seam[k]] = known->second[k];
    }
    for (std::uint32_t& id : ids)
      if (id == none) id = next_++;
    for (const auto& [cut, seam] : shell.seams) {
      if (seams_.erase(cut) > 0) continue;  // both sides are done
      for (std::uint32_t v : seam) seams_[cut].push_back(ids[v]);
    }
    return ids;
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFF;
  std::uint32_t next_ = 0;
  std::map<int, std::vector<std::uint32_t>> seams_;
};

std::vector<MinePart::Frame> later_neighbours(const std::vector<Tile>& tiles, size_t t) {
  std::vector<MinePart::Frame> later;
  for (size_t u = t + 1; u < tiles.size(); ++u)
    if (tiles[u].frame.meets(tiles[t].frame, 0)) later.push_back({u, tiles[u].frame.low, tiles[u].frame.high});
  return later;
}

// Where two passages that share no node run into one another, in words; empty where none do.
std::string overlap_of(const MinePlan& plan, const std::vector<Drift>& drifts) {
  std::vector<Frame2> frames;
  for (const Drift& d : drifts) {
    frames.emplace_back();
    for (const Vec2& p : d.line) frames.back().add(p);
  }
  for (size_t i = 0; i < drifts.size(); ++i) {
    for (size_t j = i + 1; j < drifts.size(); ++j) {
      const PlanPassage &p = plan.passages[i], &q = plan.passages[j];
      if (p.a == q.a || p.a == q.b || p.b == q.a || p.b == q.b || !frames[i].meets(frames[j], p.width_m + q.width_m))
        continue;
      for (const Vec2& u : drifts[i].line)
        for (const Vec2& v : drifts[j].line)
          if ((u - v).norm() < 0.5 * (p.width_m + q.width_m))
            return " near (" + std::to_string(std::lround(u.x())) + ", " + std::to_string(std::lround(u.y())) + ")";
    }
  }
  return "";
}

// Each loop of the centre lines goes round rock of its own, else the rock between two passages is gone.
void check_pillars(const WorldSettings& s, const MinePlan& plan, const Workings& workings, size_t pillars) {
  const size_t loops = plan.passages.size() + 1 - plan.nodes.size();
  if (pillars == loops || !workings.has_windows()) return;
  throw Error("world." + (s.kind == "plan" ? "plan = \"" + s.plan + "\"" : s.kind) + ": the centre lines have " +
              std::to_string(loops) + " loops, but " + std::to_string(pillars) +
              " pillars would be left: passages run into one another" + overlap_of(plan, workings.drifts()) +
              "; lower their widths (world.width_scale = " + text(s.width_scale) +
              ", world.wander_m, world.wall_wander_m) or move them apart");
}

// A mine laid out in plan: what is left is to raise its tiles.
struct Layout {
  MinePlan plan;
  Workings workings;
  Tiling tiling;
  Decay decay;
};

bool furnished(const FurnitureSettings& f) {
  for (double some :
       {f.post_share, f.crossbar_share, f.cribs_per_100m, f.bolt_share, f.track_share, f.belt_share, f.pipe_share,
        f.cable_share, f.stopping_share, f.cars_per_100m, f.beams_per_100m, f.blocks_per_100m, f.pools_per_100m})
    if (some > 0) return true;
  return false;
}

// Of what was asked for, what does not stand.
std::map<Label, int> without_room(const Asked& asked, const std::vector<MineObject>& objects) {
  std::map<Label, int> left;
  for (const auto& [which, n] : asked) left[which.second] += n;
  for (const MineObject& o : objects)
    if (const auto found = left.find(o.label); found != left.end()) --found->second;
  std::erase_if(left, [](const auto& of) { return of.second <= 0; });
  return left;
}

// Those that lie in a tile or reach into it.
std::vector<size_t> passages_of(const Tiling& tiling, size_t t) {
  std::vector<size_t> some;
  for (size_t p = 0; p < tiling.tiles_of.size(); ++p)
    if (tiling.tiles_of[p].first == t || tiling.tiles_of[p].second == t) some.push_back(p);
  return some;
}

Layout lay_out(const WorldSettings& s, std::uint64_t seed, const Progress& progress) {
  const bool drawn = s.kind == "plan" && names_polygons(s.plan);
  if (drawn && s.tile_m > 0)
    throw Error("world.tile_m = " + text(s.tile_m) + ": a mine from polygons is made in one piece; 0 is needed");
  Lattice depth = drawn ? depth_of(read_polygons(s.plan), s.corner_radius_m) : Lattice{};
  Skeleton skeleton = drawn ? skeleton_of(depth) : Skeleton{make_plan(s, seed), {}};
  check_settings(s, skeleton.plan);
  progress("laying out the mine", 0, 1);
  std::vector<Drift> drifts = drawn ? std::move(skeleton.drifts) : drive_passages(skeleton.plan, s, seed);
  std::vector<Wall> walls = walls_of(skeleton.plan, drifts);
  Workings workings = drawn ? Workings(std::move(depth), std::move(drifts), s.corner_radius_m)
                            : Workings(std::move(drifts), std::move(walls), s.corner_radius_m);
  const std::vector<Loop> ribs = workings.ribs();
  check_pillars(s, skeleton.plan, workings, ribs.size() - 1);
  Tiling tiling = tile_plan(skeleton.plan, workings, ribs, s.tile_m, s.mesh_edge_m);
  Decay decay = draw_decay(s, skeleton.plan, workings, seed);
  progress("laying out the mine", 1, 1);
  return {std::move(skeleton.plan), std::move(workings), std::move(tiling), std::move(decay)};
}

}  // namespace

World make_parts(const WorldSettings& given, std::uint64_t seed, const std::function<void(MinePart&&)>& take,
                 const Progress& progress) {
  const WorldSettings s = in_condition(given);
  const Layout layout = lay_out(s, seed, progress);
  const auto& [plan, workings, tiling, decay] = layout;
  const std::vector<CutEnd> ends = cut_ends(plan, workings.drifts());
  const Vec2 middle = middle_of(plan);
  World world;
  world.name = s.kind == "plan" ? s.plan : s.kind;
  world.passages.resize(plan.passages.size());
  std::vector<NumberedFall> falls;
  std::tie(world.objects, falls) = pieces_of(decay.falls);
  std::vector<char> blocked = decay.blocked;
  Asked asked;
  std::vector<double> volume_m3(plan.passages.size(), 0.0);
  std::vector<Loop> mid_height;
  for (const Loop& rib : tiling.ribs) mid_height.emplace_back(rib.size());
  Numbering numbering;
  Vec3 origin = Vec3::Zero();
  MeshTally tally;
  for (size_t t = 0; t < tiling.tiles.size(); ++t) {
    const Tile& tile = tiling.tiles[t];
    Frame2 seen = tile.frame;  // the tile tells of its passages to their ends
    for (size_t p : tile.passages)
      for (const Vec2& q : workings.drifts()[p].line) seen.add(q);
    const Outline outline = tiling.tiles.size() == 1 ? workings.whole() : workings.window(seen);
    const Terrain terrain(s, middle, outline.depth, seed, falls_in(falls, seen));
    const Faces faces = faces_in(tile.frame, ends, workings.walls());
    Shell shell = make_shell({tiling, workings, faces, s.mesh_edge_m, rows_of(s.height_m, s.mesh_edge_m), seed}, tile,
                             outline, terrain, volume_m3, mid_height);
    for (const auto& [number, piece] : shell.pieces) grow(world.objects[static_cast<size_t>(number)], piece);
    if (furnished(s.furniture) && shell.levels > 0) {
      Space space(shell.mesh, shell.levels);
      // A passage that reaches into several tiles is asked for from each.
      for (const auto& [which, n] : furnish({s, plan, workings.drifts(), decay, seed}, passages_of(tiling, t), space))
        asked[which] = std::max(asked[which], n);
      space.append_to(shell.mesh, static_cast<int>(world.objects.size()));
      for (const MineObject& o : space.objects()) {
        volume_m3[static_cast<size_t>(o.passage)] -= o.volume_m3;
        if (o.blocks) blocked[static_cast<size_t>(o.passage)] = 1;
        world.objects.push_back(o);
      }
    }
    for (size_t p : tile.passages) world.passages[p] = passage_of(plan.passages[p], workings.drifts()[p], terrain);
    if (t == 0) origin = shell.mesh.vertex.front();
    tally.add(shell.mesh, origin);
    MinePart part{
        t, {}, numbering.ids_of(shell), {t, tile.frame.low, tile.frame.high}, later_neighbours(tiling.tiles, t)};
    part.mesh = std::move(shell.mesh);
    take(std::move(part));
    progress("raising the mine", static_cast<double>(t + 1), static_cast<double>(tiling.tiles.size()));
  }
  for (size_t i = 0; i < volume_m3.size(); ++i) {
    world.passages[i].volume_m3 = volume_m3[i];
    world.passages[i].blocked = blocked[i] != 0;
  }
  world.numbers.volume_m3 = tally.six_volumes / 6;
  if (!world.objects.empty()) world.numbers.bare_m3 = tally.rock_six_volumes / 6;
  world.left_out = without_room(asked, world.objects);
  add_junctions(plan, world);
  add_numbers(std::move(mid_height), world);
  return world;
}

World make_world(const WorldSettings& s, std::uint64_t seed, const Progress& progress) {
  Mesh mesh;
  World world = make_parts(
      s, seed, [&](MinePart&& part) { append(part, mesh); }, progress);
  world.mesh = std::move(mesh);
  return world;
}

}  // namespace adit
