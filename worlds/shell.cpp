// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/shell.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "worlds/triangulate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double lean_limit = 0.5;       // how far a rib may stand out over its foot, per metre of height
constexpr double slough_of_rock = 0.35;  // from either side of a thin pillar: some is left
constexpr size_t grain = 512;

// One column of rib vertices: where it stands, where the rock is.
struct Column {
  Vec2 smooth, normal;  // on the smooth outline; unit, into the rock
  Vec2 foot;            // with the roughness of mid height: where floor and roof end
  double floor_z, roof_z, offset_m;
  double slough_m;  // how far it has spalled at mid height
  double rough;     // share of the roughness: 1 but at walls, which were built even
};

constexpr double even_m = 0.6;      // from a wall to where ribs are as rough as elsewhere
constexpr double wall_rough = 0.1;  // of a wall, as a share of a rib's

double rough_share(const std::vector<Wall>& walls, const Vec2& p) {
  double least = even_m;
  for (const Wall& w : walls)
    if ((w.middle - p).squaredNorm() < w.wide_m * w.wide_m) least = std::min(least, w.distance(p));
  const double x = std::clamp(least / even_m, 0.0, 1.0);
  return wall_rough + (1 - wall_rough) * x * x * (3 - 2 * x);
}

// How much rock there is behind a rib, as far as it matters.
double rock_behind_m(const Lattice& depth, const Vec2& p, const Vec2& normal) {
  double t = 0.4;
  while (t < 2.4 && depth.at(p + (t + 0.2) * normal) > 0.6 * (t + 0.2)) t += 0.2;
  return t;
}

Column column_at(const Loop& rib, size_t i, const std::vector<Wall>& walls, const Terrain& terrain,
                 const Lattice& depth) {
  const size_t n = rib.size();
  Column c;
  c.smooth = rib[i];
  const Vec2 along = rib[(i + 1) % n] - rib[(i + n - 1) % n];
  c.normal = Vec2(along.y(), -along.x()).normalized();  // the void is to the left
  c.rough = rough_share(walls, c.smooth);
  const double mid = terrain.seam_z(c.smooth) + 0.5 * terrain.height_m(c.smooth);
  c.offset_m = c.rough * terrain.rib_offset_m({c.smooth.x(), c.smooth.y(), mid}, c.normal);
  c.foot = c.smooth + c.offset_m * c.normal;
  c.floor_z = terrain.floor_z(c.foot);
  c.roof_z = terrain.roof_z(c.foot);
  c.slough_m = terrain.slough_m(c.smooth);
  if (c.slough_m > 0) c.slough_m = std::min(c.slough_m, slough_of_rock * rock_behind_m(depth, c.smooth, c.normal));
  if (c.rough < 1) c.slough_m *= (c.rough - wall_rough) / (1 - wall_rough);
  return c;
}

// A point of a tile's rim in plan: of a rib, or of a cut between two.
struct RimPoint {
  Vec2 foot;
  double floor_z, roof_z;
};

// The rims of a tile: runs of columns, and the points of the cuts between, all in the order of the rims.
struct Rims {
  std::vector<std::vector<Column>> runs;
  std::vector<std::vector<RimPoint>> cuts;  // (runs) after each run; empty where it closes upon itself
  std::vector<size_t> rim_size;             // (rims) runs of each
};

// Always told from left to right, for the tiles on both sides.
std::vector<RimPoint> cut_points(const Column& left, const Column& right, const Terrain& terrain, double edge_m) {
  const int n = std::max(1, static_cast<int>(std::lround((right.foot - left.foot).norm() / edge_m)));
  std::vector<RimPoint> points;
  for (int k = 1; k < n; ++k) {
    const Vec2 p = left.foot + (right.foot - left.foot) * k / n;
    points.push_back({p, terrain.floor_z(p), terrain.roof_z(p)});
  }
  return points;
}

Rims rims_of(const ShellPlan& plan, const Tile& tile, const Outline& outline, const Terrain& terrain) {
  Rims rims;
  std::vector<Wall> walls;
  for (const Wall& w : plan.workings.walls())
    if (tile.frame.meets({w.middle, w.middle}, w.wide_m)) walls.push_back(w);
  for (const auto& rim : tile.rims) {
    rims.rim_size.push_back(rim.size());
    for (const Run& run : rim) {
      const Loop& rib = plan.tiling.ribs[run.loop];
      std::vector<Column> columns(run.count);
      parallel_for(
          run.count,
          [&](size_t k) { columns[k] = column_at(rib, (run.first + k) % rib.size(), walls, terrain, outline.depth); },
          grain);
      rims.runs.push_back(std::move(columns));
    }
  }
  size_t begin = 0;
  for (const auto& rim : tile.rims) {
    for (size_t k = 0; k < rim.size(); ++k) {
      rims.cuts.emplace_back();
      if (rim[k].cut < 0) continue;
      const Column& end = rims.runs[begin + k].back();
      const Column& next = rims.runs[begin + (k + 1) % rim.size()].front();
      auto& points = rims.cuts.back() =
          cut_points(rim[k].from_left ? end : next, rim[k].from_left ? next : end, terrain, plan.edge_m);
      if (!rim[k].from_left) std::reverse(points.begin(), points.end());
    }
    begin += rim.size();
  }
  return rims;
}

Vec3 rib_point(const Column& c, double share, const Terrain& terrain) {
  const double z = c.floor_z + share * (c.roof_z - c.floor_z);
  const double to_edge = std::min(z - c.floor_z, c.roof_z - z);
  const double fade = std::clamp(to_edge / 0.4, 0.0, 1.0);
  const double rough = c.rough * terrain.rib_offset_m({c.smooth.x(), c.smooth.y(), z}, c.normal);
  const double more = std::clamp(fade * (rough - c.offset_m), -lean_limit * to_edge, lean_limit * to_edge);
  // Spalled under the brow of the roof and above the foot, most a little above the middle.
  const double at = std::sin(std::numbers::pi * std::pow(share, 0.85));
  const Vec2 p = c.foot + (more + c.slough_m * at * at) * c.normal;
  return {p.x(), p.y(), z};
}

// Squares of the plan that hold points of the rims, for the question whether one is near.
class Near {
 public:
  Near(const std::vector<Loop>& rims, double cell) : cell_(cell) {
    for (const Loop& rim : rims)
      for (const Vec2& p : rim) cells_.emplace_back(key(p, 0, 0), p);
    std::sort(cells_.begin(), cells_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  }
  bool within(const Vec2& p, double reach) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::int64_t k = key(p, dx, dy);
        auto it = std::lower_bound(cells_.begin(), cells_.end(), k,
                                   [](const auto& a, std::int64_t b) { return a.first < b; });
        for (; it != cells_.end() && it->first == k; ++it)
          if ((it->second - p).norm() < reach) return true;
      }
    }
    return false;
  }

 private:
  std::int64_t key(const Vec2& p, int dx, int dy) const {
    return ((static_cast<std::int64_t>(std::floor(p.y() / cell_)) + dy) << 32) +
           static_cast<std::int64_t>(std::floor(p.x() / cell_)) + dx;
  }
  double cell_;
  std::vector<std::pair<std::int64_t, Vec2>> cells_;
};

// Whether a point of the void is on the tile's side of all cuts.
class Within {
 public:
  Within(const ShellPlan& plan, const Tile& tile, const Outline& outline)
      : plan_(plan), outline_(outline), self_(static_cast<size_t>(&tile - plan.tiling.tiles.data())) {}
  bool operator()(const Vec2& p) const {
    const Tiling& t = plan_.tiling;
    if (t.tiles.size() == 1) return true;
    const int passage = passage_at(outline_, p);
    if (passage < 0) return false;
    const auto [tile_a, tile_b] = t.tiles_of[passage];
    const int cut = t.cut_of[passage];
    if (cut < 0) return tile_a == self_;
    const Vec2 left = at(t.cuts[cut].left), right = at(t.cuts[cut].right), way = left - right, w = p - right;
    const bool towards_a = way.x() * w.y() - way.y() * w.x() > 0;  // left of the way from the right end to the left one
    return (towards_a ? tile_a : tile_b) == self_;
  }

 private:
  const Vec2& at(const Cut::End& e) const { return plan_.tiling.ribs[e.loop][e.column]; }

  const ShellPlan& plan_;
  const Outline& outline_;
  size_t self_;
};

// A hexagonal lattice, each point moved a little, over the void but not close to its ribs and cuts.
std::vector<Vec2> inner_points(const ShellPlan& plan, const Tile& tile, const Outline& outline,
                               const std::vector<Loop>& rims) {
  const Lattice& f = outline.depth;
  const double edge = plan.edge_m, row = edge * std::sqrt(0.75);
  const Near near(rims, edge);
  const Within within(plan, tile, outline);
  const Vec2 low = (f.node(0, 0) - f.origin), high = (f.node(f.width, f.height) - f.origin);
  const int first_row = static_cast<int>(low.y() / row), last_row = static_cast<int>(high.y() / row);
  const int first = static_cast<int>(low.x() / edge), last = static_cast<int>(high.x() / edge);
  std::vector<std::vector<Vec2>> found(last_row - first_row);
  parallel_for(found.size(), [&](size_t k) {
    const size_t j = first_row + k;
    for (int i = first; i < last; ++i) {
      Vec2 p = f.origin + Vec2(edge * (i + 0.5 * (j % 2)), row * static_cast<double>(j));
      if (f.at(p) > edge) continue;
      const std::uint64_t address = static_cast<std::uint64_t>(j) << 32 | static_cast<std::uint64_t>(i);
      p += 0.3 * edge *
           Vec2(uniform(plan.seed, Draw::world_layout, 10, address) - 0.5,
                uniform(plan.seed, Draw::world_layout, 11, address) - 0.5);
      if (f.at(p) > 0.15 || !within(p)) continue;
      const bool deep = f.at(p) <= -2 * edge - 0.3 && plan.tiling.cuts.empty();
      if (!deep && near.within(p, 0.75 * edge)) continue;
      found[k].push_back(p);
    }
  });
  std::vector<Vec2> points;
  for (const auto& r : found) points.insert(points.end(), r.begin(), r.end());
  return points;
}

class Builder {
 public:
  Builder(const ShellPlan& plan, const Tile& tile, const Outline& outline, const Terrain& terrain, const Rims& rims,
          std::vector<double>& volume_m3, std::vector<Loop>& mid_height)
      : plan_(plan),
        tile_(tile),
        outline_(outline),
        terrain_(terrain),
        rims_(rims),
        volume_m3_(volume_m3),
        mid_height_(mid_height) {}

  Shell build(const PlanMesh& ground) {
    add_floor_and_roof(ground);
    size_t first = 0, k = 0;
    for (const auto& rim : tile_.rims) {
      for (const Run& run : rim) {
        add_ribs(run, rims_.runs[k], first);
        first += run.count + rims_.cuts[k].size();
        ++k;
      }
    }
    add_seams();
    colour();
    return std::move(shell_);
  }

 private:
  void add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c, Label label, int part, int passage) {
    shell_.mesh.face.push_back({a, b, c});
    shell_.mesh.label.push_back(label);
    shell_.mesh.part.push_back(part);
    shell_.mesh.passage.push_back(passage);
  }

  double six_volumes(const Vec3& o, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const auto& v = shell_.mesh.vertex;
    return (v[a] - o).dot((v[b] - o).cross(v[c] - o));
  }

  // Of the upright prism between a floor triangle and the roof above it.
  double prism_m3(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const auto& v = shell_.mesh.vertex;
    const Vec3 u = v[b] - v[a], w = v[c] - v[a];
    const double height = v[n_ + a].z() - v[a].z() + v[n_ + b].z() - v[b].z() + v[n_ + c].z() - v[c].z();
    return 0.5 * (u.x() * w.y() - u.y() * w.x()) * height / 3;
  }

  // Vertices 0 .. n-1 are the floor's, n .. 2n-1 the roof's; those of the rims come first in each.
  void add_floor_and_roof(const PlanMesh& ground) {
    n_ = static_cast<std::uint32_t>(ground.vertex.size());
    shell_.levels = ground.face.size();
    auto& vertex = shell_.mesh.vertex;
    vertex.resize(2 * size_t{n_});
    size_t bound = 0;
    const auto put = [&](const Vec2& foot, double floor_z, double roof_z) {
      vertex[bound] = {foot.x(), foot.y(), floor_z};
      vertex[n_ + bound++] = {foot.x(), foot.y(), roof_z};
    };
    for (size_t k = 0; k < rims_.runs.size(); ++k) {
      for (const Column& c : rims_.runs[k]) put(c.foot, c.floor_z, c.roof_z);
      for (const RimPoint& p : rims_.cuts[k]) put(p.foot, p.floor_z, p.roof_z);
    }
    parallel_for(
        n_ - bound,
        [&](size_t k) {
          const size_t i = bound + k;
          const Vec2& p = ground.vertex[i];
          vertex[i] = {p.x(), p.y(), terrain_.floor_z(p)};
          vertex[n_ + i] = {p.x(), p.y(), terrain_.roof_z(p)};
        },
        grain);
    for (const auto& f : ground.face) {
      const int passage = passage_at(outline_, (ground.vertex[f[0]] + ground.vertex[f[1]] + ground.vertex[f[2]]) / 3);
      const Vec2 middle = (ground.vertex[f[0]] + ground.vertex[f[1]] + ground.vertex[f[2]]) / 3;
      const auto [lies, heap] = terrain_.ground(middle);
      const auto [hangs, hollow] = terrain_.ceiling(middle);
      add_face(f[0], f[2], f[1], lies, heap >= 0 ? heap : passage, passage);
      add_face(n_ + f[0], n_ + f[1], n_ + f[2], hangs, hollow >= 0 ? hollow : passage, passage);
      if (heap >= 0)
        add_to_piece(heap, f, 0, lifted_m3(f, ground, [&](const Vec2& p) { return terrain_.rubble_m(p); }));
      if (hollow >= 0)
        add_to_piece(hollow, f, n_, lifted_m3(f, ground, [&](const Vec2& p) { return terrain_.hollow_m(p); }));
      volume_m3_[passage] += prism_m3(f[0], f[1], f[2]);
    }
  }

  // A triangle of the plan becomes a part of a piece, as it is on the floor (over = 0) or on the roof (over = n).
  void add_to_piece(int number, const std::array<std::uint32_t, 3>& f, std::uint32_t over, double volume_m3) {
    Shell::Piece& piece = shell_.pieces[number];
    piece.volume_m3 += volume_m3;
    for (std::uint32_t v : f) {
      piece.low = piece.low.cwiseMin(shell_.mesh.vertex[over + v]);
      piece.high = piece.high.cwiseMax(shell_.mesh.vertex[over + v]);
    }
  }

  template <class F>
  static double lifted_m3(const std::array<std::uint32_t, 3>& f, const PlanMesh& ground, const F& lift_m) {
    const Vec2 &a = ground.vertex[f[0]], u = ground.vertex[f[1]] - a, w = ground.vertex[f[2]] - a;
    double mean = 0;
    for (std::uint32_t v : f) mean += lift_m(ground.vertex[v]) / 3;
    return 0.5 * (u.x() * w.y() - u.y() * w.x()) * mean;
  }

  // Vertex of row r at column k of a run whose first column is rim point `first` and whose rows between begin at `base`.
  std::uint32_t at(size_t first, std::uint32_t base, size_t k, int r) const {
    if (r == 0) return static_cast<std::uint32_t>(first + k);
    if (r == plan_.rows) return n_ + static_cast<std::uint32_t>(first + k);
    return base + static_cast<std::uint32_t>(k * (plan_.rows - 1) + r - 1);
  }

  // Row 0 is the foot, the last row the roof's edge; those between are new.
  void add_ribs(const Run& run, const std::vector<Column>& columns, size_t first) {
    auto& vertex = shell_.mesh.vertex;
    const std::uint32_t base = static_cast<std::uint32_t>(vertex.size());
    const size_t n = columns.size(), between = plan_.rows - 1, in_loop = mid_height_[run.loop].size();
    base_.push_back(base);
    vertex.resize(base + n * between);
    parallel_for(
        n,
        [&](size_t i) {
          for (int r = 1; r < plan_.rows; ++r)
            vertex[base + i * between + r - 1] = rib_point(columns[i], static_cast<double>(r) / plan_.rows, terrain_);
        },
        64);
    std::vector<char> capped(n);
    for (size_t i = 0; i < n; ++i) {
      capped[i] = plan_.capped(columns[i].smooth);
      mid_height_[run.loop][(run.first + i) % in_loop] = vertex[at(first, base, i, plan_.rows / 2)].head<2>();
    }
    const bool whole = run.cut < 0;
    for (size_t i = 0; i < (whole ? n : n - 1); ++i) {
      const size_t j = (i + 1) % n;
      add_strip(first, base, i, j, (run.first + i) % in_loop, capped[i] && capped[j] ? Label::cap : Label::rib,
                static_cast<int>(run.loop) - 1, passage_at(outline_, 0.5 * (columns[i].smooth + columns[j].smooth)));
    }
  }

  // The faces between two columns; besides, the volume between them, the upright quad at their feet and the upright
  // polygons at the two columns.
  void add_strip(size_t first, std::uint32_t base, size_t i, size_t j, size_t number, Label label, int pillar,
                 int passage) {
    double six = 0;
    const Vec3 o = shell_.mesh.vertex[at(first, base, i, 0)];
    for (int r = 0; r < plan_.rows; ++r) {
      const std::uint32_t a = at(first, base, i, r), b = at(first, base, j, r), c = at(first, base, j, r + 1),
                          d = at(first, base, i, r + 1);
      const bool rising = (number + r) % 2;
      six += rising ? six_volumes(o, a, b, c) + six_volumes(o, a, c, d)
                    : six_volumes(o, a, b, d) + six_volumes(o, b, c, d);
      six += six_volumes(o, at(first, base, j, 0), c, b);
      add_face(a, b, rising ? c : d, label, pillar, passage);
      add_face(rising ? a : b, c, d, label, pillar, passage);
    }
    volume_m3_[passage] += six / 6;
  }

  void add_seams() {
    size_t first = 0, k = 0, begin = 0;
    std::vector<size_t> first_of;
    for (size_t r = 0; r < rims_.runs.size(); ++r) {
      first_of.push_back(first);
      first += rims_.runs[r].size() + rims_.cuts[r].size();
    }
    for (const auto& rim : tile_.rims) {
      for (size_t r = 0; r < rim.size(); ++r, ++k) {
        if (rim[r].cut < 0) continue;
        const size_t next = begin + (r + 1) % rim.size(), last = rims_.runs[k].size() - 1;
        const auto column = [&](size_t run, size_t i) {
          std::vector<std::uint32_t> ids;
          for (int row = 0; row <= plan_.rows; ++row) ids.push_back(at(first_of[run], base_[run], i, row));
          return ids;
        };
        std::vector<std::uint32_t> seam = rim[r].from_left ? column(k, last) : column(next, 0);
        for (std::uint32_t id : rim[r].from_left ? column(next, 0) : column(k, last)) seam.push_back(id);
        const size_t points = rims_.cuts[k].size();
        for (size_t p = 0; p < points; ++p) {
          const size_t id = first_of[k] + rims_.runs[k].size() + (rim[r].from_left ? p : points - 1 - p);
          seam.push_back(static_cast<std::uint32_t>(id));
          seam.push_back(n_ + static_cast<std::uint32_t>(id));
        }
        shell_.seams[rim[r].cut] = std::move(seam);
      }
      begin += rim.size();
    }
  }

  void colour() {
    Mesh& m = shell_.mesh;
    m.reflectivity.resize(m.face.size());
    m.material.resize(m.face.size());
    m.wetness.resize(m.face.size());
    parallel_for(
        m.face.size(),
        [&](size_t f) {
          const Rock rock = terrain_.rock((m.corner(f, 0) + m.corner(f, 1) + m.corner(f, 2)) / 3, m.label[f]);
          m.reflectivity[f] = rock.reflectivity;
          m.material[f] = rock.material;
          m.wetness[f] = rock.wetness;
        },
        4096);
  }

  const ShellPlan& plan_;
  const Tile& tile_;
  const Outline& outline_;
  const Terrain& terrain_;
  const Rims& rims_;
  std::vector<double>& volume_m3_;
  std::vector<Loop>& mid_height_;
  std::uint32_t n_ = 0;
  std::vector<std::uint32_t> base_;  // (runs) first vertex of the rows between floor and roof
  Shell shell_;
};

}  // namespace

int rows_of(double height_m, double edge_m) {
  return 2 * std::max(1, static_cast<int>(std::lround(height_m / (2 * edge_m))));
}

Shell make_shell(const ShellPlan& plan, const Tile& tile, const Outline& outline, const Terrain& terrain,
                 std::vector<double>& volume_m3, std::vector<Loop>& mid_height) {
  const Rims rims = rims_of(plan, tile, outline, terrain);
  std::vector<Loop> feet;
  size_t k = 0;
  for (size_t size : rims.rim_size) {
    feet.emplace_back();
    for (size_t r = 0; r < size; ++r, ++k) {
      for (const Column& c : rims.runs[k]) feet.back().push_back(c.foot);
      for (const RimPoint& p : rims.cuts[k]) feet.back().push_back(p.foot);
    }
  }
  const PlanMesh ground = triangulate(feet, inner_points(plan, tile, outline, feet));
  return Builder(plan, tile, outline, terrain, rims, volume_m3, mid_height).build(ground);
}

}  // namespace adit
