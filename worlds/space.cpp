// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/space.h"

#include "worlds/contact.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool before(const Vec2& a, const Vec2& b) {
  return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

// Where a side of a piece meets the line on which the two signed distances f, g vanish: the same bits from either end.
LevelPoint meeting(const LevelPoint& a, double f, const LevelPoint& b, double g) {
  if (before(b.p, a.p)) return meeting(b, g, a, f);
  const double t = f / (f - g);
  return {a.p + t * (b.p - a.p), a.floor_z + t * (b.floor_z - a.floor_z), a.roof_z + t * (b.roof_z - a.roof_z)};
}

// What of a convex piece lies to the left of a line (Sutherland, Hodgman 1974).
std::vector<LevelPoint> left_of(const std::vector<LevelPoint>& piece, const Vec2& from, const Vec2& to) {
  std::vector<LevelPoint> kept;
  std::vector<double> side;
  for (const LevelPoint& v : piece) side.push_back(cross(to - from, v.p - from));
  for (size_t i = 0; i < piece.size(); ++i) {
    const size_t j = (i + 1) % piece.size();
    if (side[i] >= 0) kept.push_back(piece[i]);
    if ((side[i] > 0 && side[j] < 0) || (side[i] < 0 && side[j] > 0))
      kept.push_back(meeting(piece[i], side[i], piece[j], side[j]));
  }
  return kept;
}

double area_of(const std::vector<LevelPoint>& piece) {
  double twice = 0;
  for (size_t i = 1; i + 1 < piece.size(); ++i) twice += cross(piece[i].p - piece[0].p, piece[i + 1].p - piece[0].p);
  return twice / 2;
}

}  // namespace

float reflectivity_of(Material material) {
  switch (material) {
    case Material::timber:
      return 0.30f;
    case Material::steel:
      return 0.18f;  // rusty
    case Material::block:
      return 0.40f;
    case Material::shale:
      return 0.22f;
    case Material::water:
      return 0.04f;
    case Material::mud:
      return 0.25f;
    default:
      return 0.08f;  // rubber
  }
}

Space::Space(const Mesh& rock, size_t levels) : rock_(rock), levels_(levels), caster_(rock) {
  Box3 all;
  for (const Vec3& v : rock.vertex) all.add(v);
  const Vec2 from = all.low.head<2>(), to = all.high.head<2>();
  plan_.build(from, to, 0.5, levels, [&](std::uint32_t k) { return box_of(rock.vertex, rock.face[2 * k]); });
  faces_.build(from, to, 0.5, rock.face.size(), [&](std::uint32_t f) { return box_of(rock.vertex, rock.face[f]); });
}

// Floors run the other way round.
LevelPoint Space::corner(std::uint32_t k, int c) const {
  const Vec3 &up = rock_.vertex[name(k, c)], &down = rock_.vertex[rock_.face[2 * size_t{k}][c == 0 ? 0 : 3 - c]];
  return {up.head<2>(), down.z(), up.z()};
}

std::optional<LevelPatch> Space::patch(const Loop& polygon) const {
  Box3 frame;
  double area = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    frame.add({polygon[i].x(), polygon[i].y(), 0});
    if (i > 1) area += 0.5 * cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  std::vector<std::uint32_t> near;
  plan_.for_near(frame.low.head<2>(), frame.high.head<2>(), [&](std::uint32_t k) { near.push_back(k); });
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  LevelPatch patch;
  std::map<std::pair<double, double>, std::uint32_t> index;
  double covered = 0;
  for (std::uint32_t k : near) {
    std::vector<LevelPoint> piece{corner(k, 0), corner(k, 1), corner(k, 2)};
    for (size_t i = 0; i < polygon.size() && piece.size() > 2; ++i)
      piece = left_of(piece, polygon[i], polygon[(i + 1) % polygon.size()]);
    if (piece.size() < 3) continue;
    covered += area_of(piece);
    patch.piece.emplace_back();
    for (const LevelPoint& v : piece) {
      const auto [found, fresh] =
          index.emplace(std::pair{v.p.x(), v.p.y()}, static_cast<std::uint32_t>(patch.vertex.size()));
      if (fresh) patch.vertex.push_back(v);
      patch.piece.back().push_back(found->second);
    }
  }
  if (patch.piece.empty() || std::abs(covered - area) > 1e-7) return std::nullopt;
  return patch;
}

std::optional<LevelPoint> Space::level(const Vec2& p) const {
  std::optional<LevelPoint> found;
  const auto look = [&](std::uint32_t k) {
    if (found) return;
    const LevelPoint a = corner(k, 0), b = corner(k, 1), c = corner(k, 2);
    const Vec2 ab = b.p - a.p, ac = c.p - a.p, ap = p - a.p;
    const double area = cross(ab, ac), s = cross(ap, ac) / area, t = cross(ab, ap) / area;
    if (!(s >= 0 && t >= 0 && s + t <= 1)) return;
    found = LevelPoint{p, a.floor_z + s * (b.floor_z - a.floor_z) + t * (c.floor_z - a.floor_z),
                       a.roof_z + s * (b.roof_z - a.roof_z) + t * (c.roof_z - a.roof_z)};
  };
  plan_.for_near(p, p, look);
  return found;
}

double Space::sight_m(const Vec3& from, const Vec3& direction) const {
  return caster_.nearest(Ray{from, direction.normalized(), 1e3}).range_m;
}

bool Space::meets_rock(const Solid& body) const {
  const Box3 own = box_of(body);
  std::vector<std::uint32_t> near;
  faces_.for_near(own.low.head<2>(), own.high.head<2>(), [&](std::uint32_t f) {
    if (own.meets(box_of(rock_.vertex, rock_.face[f]))) near.push_back(f);
  });
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  Contact pairs(body);
  for (std::uint32_t f : near)
    if (pairs.crosses({rock_.corner(f, 0), rock_.corner(f, 1), rock_.corner(f, 2)})) return true;
  // Not in the rock as a whole: what lies below is seen from the void.
  const Hit below = caster_.nearest(Ray{body.vertex[0], {0, 0, -1}, 1e3});
  return below.face < 0 || below.cosine <= 0;
}

bool Space::meets_bodies(const Solid& body, const Vec3& low, const Vec3& high) const {
  const Box3 own{low, high};
  std::vector<std::uint32_t> near;
  const auto from = cell_of(low.head<2>()), to = cell_of(high.head<2>());
  for (long y = from.second; y <= to.second; ++y)
    for (long x = from.first; x <= to.first; ++x)
      if (const auto found = placed_at_.find({x, y}); found != placed_at_.end())
        near.insert(near.end(), found->second.begin(), found->second.end());
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::optional<Contact> pairs;
  for (std::uint32_t i : near) {
    const Placed& other = placed_[i];
    if (!own.meets({other.low, other.high})) continue;
    if (!pairs) pairs.emplace(body);
    for (const auto& f : other.body.face)
      if (own.meets(box_of(other.body.vertex, f)) &&
          pairs->crosses({other.body.vertex[f[0]], other.body.vertex[f[1]], other.body.vertex[f[2]]}))
        return true;
    if (within(other.body, body.vertex[0]) || within(body, other.body.vertex[0])) return true;
  }
  return false;
}

bool Space::put(Label label, int passage, std::vector<Solid> bodies, double yaw_rad, bool blocks) {
  if (bodies.empty()) return false;
  for (const Solid& body : bodies) {
    const Box3 b = box_of(body);
    if (!body.closed() || meets_rock(body) || meets_bodies(body, b.low, b.high)) return false;
  }
  const Eigen::Rotation2Dd turned(-yaw_rad);
  Box3 whole;
  MineObject object{label, passage};
  for (Solid& body : bodies) {
    object.volume_m3 += body.volume_m3();
    for (const Vec3& v : body.vertex) {
      const Vec2 q = turned * Vec2(v.head<2>());
      whole.add({q.x(), q.y(), v.z()});
    }
    const Box3 b = box_of(body);
    const auto from = cell_of(b.low.head<2>()), to = cell_of(b.high.head<2>());
    for (long y = from.second; y <= to.second; ++y)
      for (long x = from.first; x <= to.first; ++x)
        placed_at_[{x, y}].push_back(static_cast<std::uint32_t>(placed_.size()));
    placed_.push_back({std::move(body), b.low, b.high, objects_.size()});
  }
  const Vec3 middle = 0.5 * (whole.low + whole.high);
  const Vec2 p = turned.inverse() * Vec2(middle.head<2>());
  object.middle_W = {p.x(), p.y(), middle.z()};
  object.size_m = whole.high - whole.low;
  object.yaw_rad = yaw_rad;
  object.blocks = blocks;
  objects_.push_back(object);
  return true;
}

void Space::append_to(Mesh& mesh, int first) const {
  for (const Placed& p : placed_) {
    const MineObject& object = objects_[p.object];
    const auto base = static_cast<std::uint32_t>(mesh.vertex.size());
    mesh.vertex.insert(mesh.vertex.end(), p.body.vertex.begin(), p.body.vertex.end());
    for (const auto& f : p.body.face) {
      mesh.face.push_back({base + f[0], base + f[2], base + f[1]});
      mesh.label.push_back(object.label);
      mesh.part.push_back(first + static_cast<int>(p.object));
      mesh.reflectivity.push_back(reflectivity_of(p.body.material));
      mesh.passage.push_back(object.passage);
      mesh.material.push_back(p.body.material);
      mesh.wetness.push_back(p.body.material == Material::water ? 1.0f : 0.0f);
    }
  }
}

}  // namespace adit
