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
};

// How much rock there is behind a rib, as far as it matters.
double rock_behind_m(const Lattice& depth, const Vec2& p, const Vec2& normal) {
  double t = 0.4;
  while (t < 2.4 && depth.at(p + (t + 0.2) * normal) > 0.6 * (t + 0.2)) t += 0.2;
  return t;
}

std::vector<Vec2> spaced(const Loop& loop, double edge_m) {
  double length = 0;
  for (size_t i = 0; i < loop.size(); ++i) length += (loop[(i + 1) % loop.size()] - loop[i]).norm();
  const int n = std::max(6, static_cast<int>(std::lround(length / edge_m)));
  std::vector<Vec2> points;
  double behind = 0;
  size_t i = 0;
  for (int k = 0; k < n; ++k) {
    const double s = length * k / n;
    double piece = (loop[(i + 1) % loop.size()] - loop[i]).norm();
    while (behind + piece < s && i + 1 < loop.size()) {
      behind += piece;
      ++i;
      piece = (loop[(i + 1) % loop.size()] - loop[i]).norm();
    }
    const double t = piece > 0 ? std::clamp((s - behind) / piece, 0.0, 1.0) : 0.0;
    points.push_back(loop[i] + t * (loop[(i + 1) % loop.size()] - loop[i]));
  }
  return points;
}

std::vector<Column> columns_of(const Loop& loop, const Terrain& terrain, const Lattice& depth, double edge_m) {
  const std::vector<Vec2> points = spaced(loop, edge_m);
  const size_t n = points.size();
  std::vector<Column> columns(n);
  parallel_for(
      n,
      [&](size_t i) {
        Column& c = columns[i];
        c.smooth = points[i];
        const Vec2 along = points[(i + 1) % n] - points[(i + n - 1) % n];
        c.normal = Vec2(along.y(), -along.x()).normalized();  // the void is to the left
        const double mid = terrain.seam_z(c.smooth) + 0.5 * terrain.height_m(c.smooth);
        c.offset_m = terrain.rib_offset_m({c.smooth.x(), c.smooth.y(), mid});
        c.foot = c.smooth + c.offset_m * c.normal;
        c.floor_z = terrain.floor_z(c.foot);
        c.roof_z = terrain.roof_z(c.foot);
        c.slough_m = terrain.slough_m(c.smooth);
        if (c.slough_m > 0)
          c.slough_m = std::min(c.slough_m, slough_of_rock * rock_behind_m(depth, c.smooth, c.normal));
      },
      grain);
  return columns;
}

Vec3 rib_point(const Column& c, double share, const Terrain& terrain) {
  const double z = c.floor_z + share * (c.roof_z - c.floor_z);
  const double to_edge = std::min(z - c.floor_z, c.roof_z - z);
  const double fade = std::clamp(to_edge / 0.4, 0.0, 1.0);
  const double rough = terrain.rib_offset_m({c.smooth.x(), c.smooth.y(), z});
  const double more = std::clamp(fade * (rough - c.offset_m), -lean_limit * to_edge, lean_limit * to_edge);
  // Spalled under the brow of the roof and above the foot, most a little above the middle.
  const double at = std::sin(std::numbers::pi * std::pow(share, 0.85));
  const Vec2 p = c.foot + (more + c.slough_m * at * at) * c.normal;
  return {p.x(), p.y(), z};
}

// Squares of the lattice that hold points of the ribs, for the question whether one is near.
class Near {
 public:
  Near(const std::vector<std::vector<Column>>& loops, const Lattice& field, double cell)
      : origin_(field.origin), cell_(cell), width_(static_cast<int>(field.width * field.cell_m / cell) + 3) {
    for (const auto& loop : loops)
      for (const Column& c : loop) cells_.emplace_back(key(c.foot, 0, 0), c.foot);
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
    const Vec2 q = (p - origin_) / cell_;
    return (static_cast<std::int64_t>(std::floor(q.y())) + dy) * width_ + static_cast<std::int64_t>(std::floor(q.x())) +
           dx;
  }
  Vec2 origin_;
  double cell_;
  int width_;
  std::vector<std::pair<std::int64_t, Vec2>> cells_;
};

// A hexagonal lattice, each point moved a little, over the void but not close to its ribs.
std::vector<Vec2> inner_points(const Outline& outline, const std::vector<std::vector<Column>>& loops, double edge_m,
                               std::uint64_t seed) {
  const Lattice& f = outline.depth;
  const Near near(loops, f, edge_m);
  const double row = edge_m * std::sqrt(0.75);
  const int rows = static_cast<int>(f.height * f.cell_m / row), across = static_cast<int>(f.width * f.cell_m / edge_m);
  std::vector<std::vector<Vec2>> found(rows);
  parallel_for(rows, [&](size_t j) {
    for (int i = 0; i < across; ++i) {
      Vec2 p = f.origin + Vec2(edge_m * (i + 0.5 * (j % 2)), row * static_cast<double>(j));
      if (f.at(p) > edge_m) continue;
      const std::uint64_t address = static_cast<std::uint64_t>(j) << 32 | static_cast<std::uint64_t>(i);
      p += 0.3 * edge_m *
           Vec2(uniform(seed, Draw::world_layout, 10, address) - 0.5,
                uniform(seed, Draw::world_layout, 11, address) - 0.5);
      if (f.at(p) > 0.15 || (f.at(p) > -2 * edge_m - 0.3 && near.within(p, 0.75 * edge_m))) continue;
      found[j].push_back(p);
    }
  });
  std::vector<Vec2> points;
  for (const auto& r : found) points.insert(points.end(), r.begin(), r.end());
  return points;
}

class Builder {
 public:
  Builder(const Outline& outline, const Terrain& terrain, const std::function<bool(const Vec2&)>& capped, int rows)
      : outline_(outline), terrain_(terrain), capped_(capped), rows_(rows) {}

  Shell build(const std::vector<std::vector<Column>>& loops, const PlanMesh& plan) {
    add_floor_and_roof(loops, plan);
    size_t first = 0;
    for (size_t l = 0; l < loops.size(); ++l) {
      add_ribs(loops[l], first, static_cast<int>(l) - 1);
      first += loops[l].size();
    }
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

  void add_volume(int passage, double volume_m3) {
    if (shell_.volume_m3.size() <= static_cast<size_t>(passage)) shell_.volume_m3.resize(passage + size_t{1}, 0.0);
    shell_.volume_m3[passage] += volume_m3;
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

  // Vertices 0 .. n-1 are the floor's, n .. 2n-1 the roof's; those of the ribs' feet come first in each.
  void add_floor_and_roof(const std::vector<std::vector<Column>>& loops, const PlanMesh& plan) {
    n_ = static_cast<std::uint32_t>(plan.vertex.size());
    auto& vertex = shell_.mesh.vertex;
    vertex.resize(2 * size_t{n_});
    size_t bound = 0;
    for (const auto& loop : loops) {
      for (const Column& c : loop) {
        vertex[bound] = {c.foot.x(), c.foot.y(), c.floor_z};
        vertex[n_ + bound++] = {c.foot.x(), c.foot.y(), c.roof_z};
      }
    }
    parallel_for(
        n_ - bound,
        [&](size_t k) {
          const size_t i = bound + k;
          const Vec2& p = plan.vertex[i];
          vertex[i] = {p.x(), p.y(), terrain_.floor_z(p)};
          vertex[n_ + i] = {p.x(), p.y(), terrain_.roof_z(p)};
        },
        grain);
    for (const auto& f : plan.face) {
      const int passage = passage_at(outline_, (plan.vertex[f[0]] + plan.vertex[f[1]] + plan.vertex[f[2]]) / 3);
      add_face(f[0], f[2], f[1], Label::floor, passage, passage);
      add_face(n_ + f[0], n_ + f[1], n_ + f[2], Label::roof, passage, passage);
      add_volume(passage, prism_m3(f[0], f[1], f[2]));
    }
  }

  // Row 0 is the foot, row rows_ the roof's edge; those between are new.
  void add_ribs(const std::vector<Column>& loop, size_t first, int pillar) {
    auto& vertex = shell_.mesh.vertex;
    const std::uint32_t base = static_cast<std::uint32_t>(vertex.size());
    const size_t n = loop.size(), between = rows_ - 1;
    vertex.resize(base + n * between);
    parallel_for(
        n,
        [&](size_t i) {
          for (int r = 1; r < rows_; ++r)
            vertex[base + i * between + r - 1] = rib_point(loop[i], static_cast<double>(r) / rows_, terrain_);
        },
        64);
    const auto at = [&](size_t i, int r) -> std::uint32_t {
      if (r == 0) return static_cast<std::uint32_t>(first + i);
      if (r == rows_) return n_ + static_cast<std::uint32_t>(first + i);
      return base + static_cast<std::uint32_t>(i * between + r - 1);
    };
    std::vector<char> capped(n);
    for (size_t i = 0; i < n; ++i) capped[i] = capped_(loop[i].smooth);
    Loop middle;
    for (size_t i = 0; i < n; ++i) {
      const size_t j = (i + 1) % n;
      const Label label = capped[i] && capped[j] ? Label::cap : Label::rib;
      const int passage = passage_at(outline_, 0.5 * (loop[i].smooth + loop[j].smooth));
      // Between the strip, the upright quad at its feet and the upright polygons at its two columns.
      double six = 0;
      const Vec3 o = vertex[at(i, 0)];
      for (int r = 0; r < rows_; ++r) {
        const std::uint32_t a = at(i, r), b = at(j, r), c = at(j, r + 1), d = at(i, r + 1);
        six += (i + r) % 2 ? six_volumes(o, a, b, c) + six_volumes(o, a, c, d)
                           : six_volumes(o, a, b, d) + six_volumes(o, b, c, d);
        six += six_volumes(o, at(j, 0), c, b);
        if ((i + r) % 2) {
          add_face(a, b, c, label, pillar, passage);
          add_face(a, c, d, label, pillar, passage);
        } else {
          add_face(a, b, d, label, pillar, passage);
          add_face(b, c, d, label, pillar, passage);
        }
      }
      add_volume(passage, six / 6);
      middle.push_back(vertex[at(i, rows_ / 2)].head<2>());
    }
    shell_.mid_height.push_back(std::move(middle));
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

  const Outline& outline_;
  const Terrain& terrain_;
  const std::function<bool(const Vec2&)>& capped_;
  int rows_;
  std::uint32_t n_ = 0;
  Shell shell_;
};

}  // namespace

Shell make_shell(const Outline& outline, const Terrain& terrain, const std::function<bool(const Vec2&)>& capped,
                 double edge_m, double height_m, std::uint64_t seed) {
  std::vector<std::vector<Column>> loops;
  std::vector<Loop> feet;
  for (const Loop& loop : outline.loops) {
    loops.push_back(columns_of(loop, terrain, outline.depth, edge_m));
    feet.emplace_back();
    for (const Column& c : loops.back()) feet.back().push_back(c.foot);
  }
  const PlanMesh plan = triangulate(feet, inner_points(outline, loops, edge_m, seed));
  const int rows = 2 * std::max(1, static_cast<int>(std::lround(height_m / (2 * edge_m))));
  return Builder(outline, terrain, capped, rows).build(loops, plan);
}

}  // namespace adit
