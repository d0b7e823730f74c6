// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/solid.h"

#include "worlds/exact.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace adit {
namespace {

constexpr double thinnest_m = 0.01;

using Side = std::pair<std::uint32_t, std::uint32_t>;

// Directed sides of convex pieces that no other piece runs the other way.
std::vector<Side> rim_of(const std::vector<std::vector<std::uint32_t>>& pieces) {
  std::map<Side, int> sides;
  for (const auto& piece : pieces)
    for (size_t k = 0; k < piece.size(); ++k) ++sides[{piece[k], piece[(k + 1) % piece.size()]}];
  std::vector<Side> rim;
  for (const auto& [side, n] : sides)
    if (!sides.contains({side.second, side.first})) rim.push_back(side);
  return rim;
}

}  // namespace

double Solid::volume_m3() const {
  Mesh mesh;
  mesh.vertex = vertex;
  mesh.face = face;
  return enclosed_volume(mesh);
}

bool Solid::closed() const {
  Mesh mesh;
  mesh.vertex = vertex;
  mesh.face = face;
  for (size_t f = 0; f < face.size(); ++f)
    if (no_area(mesh, f)) return false;
  return open_edges(mesh) == 0;
}

Solid loft(const std::vector<std::vector<Vec3>>& rings) {
  Solid s;
  const auto n = static_cast<std::uint32_t>(rings.front().size()), last = static_cast<std::uint32_t>(rings.size() - 1);
  for (const auto& ring : rings) s.vertex.insert(s.vertex.end(), ring.begin(), ring.end());
  for (std::uint32_t r = 0; r < last; ++r) {
    for (std::uint32_t k = 0; k < n; ++k) {
      const std::uint32_t a = r * n + k, b = r * n + (k + 1) % n, c = b + n, d = a + n;
      s.face.push_back({a, b, c});
      s.face.push_back({a, c, d});
    }
  }
  for (std::uint32_t k = 1; k + 1 < n; ++k) {
    s.face.push_back({0, k + 1, k});
    s.face.push_back({last * n, last * n + k, last * n + k + 1});
  }
  return s;
}

Solid box(const Pose& X, const Vec3& half) {
  std::vector<std::vector<Vec3>> rings(2);
  for (int r = 0; r < 2; ++r)
    for (const Vec2& c : {Vec2(-1, -1), Vec2(1, -1), Vec2(1, 1), Vec2(-1, 1)})
      rings[r].push_back(X * Vec3(c.x() * half.x(), c.y() * half.y(), r ? half.z() : -half.z()));
  return loft(rings);
}

Solid tube_along(const std::vector<Vec3>& line, double radius_m, int sides) {
  std::vector<std::vector<Vec3>> rings;
  for (size_t k = 0; k < line.size(); ++k) {
    const Vec3 t = (line[std::min(k + 1, line.size() - 1)] - line[k > 0 ? k - 1 : 0]).normalized();
    const Vec3 side = t.cross(std::abs(t.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized(), top = side.cross(t);
    rings.emplace_back();
    for (int i = 0; i < sides; ++i) {
      // Counter-clockwise about t.
      const double a = -2 * std::numbers::pi * i / sides;
      rings.back().push_back(line[k] + radius_m * (std::cos(a) * side + std::sin(a) * top));
    }
  }
  return loft(rings);
}

Solid slab(const Loop& polygon, const std::function<double(const Vec2&)>& bottom_z,
           const std::function<double(const Vec2&)>& top_z) {
  std::vector<std::vector<Vec3>> rings(2);
  for (const Vec2& p : polygon) {
    rings[0].emplace_back(p.x(), p.y(), bottom_z(p));
    rings[1].emplace_back(p.x(), p.y(), top_z(p));
  }
  return loft(rings);
}

Loop rectangle(const Vec2& middle, const Vec2& along, double half_along_m, double half_across_m) {
  const Vec2 u = half_along_m * along, v = half_across_m * Vec2(-along.y(), along.x());
  return {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
}

Loop regular(const Vec2& middle, double radius_m, int sides, double turned_rad) {
  Loop loop;
  for (int k = 0; k < sides; ++k) {
    const double a = turned_rad + 2 * std::numbers::pi * k / sides;
    loop.push_back(middle + radius_m * Vec2(std::cos(a), std::sin(a)));
  }
  return loop;
}

double LevelPatch::floor_high() const {
  double z = -1e300;
  for (const LevelPoint& v : vertex) z = std::max(z, v.floor_z);
  return z;
}
double LevelPatch::floor_low() const {
  double z = 1e300;
  for (const LevelPoint& v : vertex) z = std::min(z, v.floor_z);
  return z;
}
double LevelPatch::roof_low() const {
  double z = 1e300;
  for (const LevelPoint& v : vertex) z = std::min(z, v.roof_z);
  return z;
}

std::optional<Solid> column(const LevelPatch& patch, const std::function<double(const LevelPoint&)>& bottom_z,
                            const std::function<double(const LevelPoint&)>& top_z) {
  const auto n = static_cast<std::uint32_t>(patch.vertex.size());
  Solid s;
  s.vertex.resize(2 * size_t{n});
  for (std::uint32_t i = 0; i < n; ++i) {
    const LevelPoint& v = patch.vertex[i];
    s.vertex[i] = {v.p.x(), v.p.y(), bottom_z(v)};
    s.vertex[n + i] = {v.p.x(), v.p.y(), top_z(v)};
    if (s.vertex[n + i].z() - s.vertex[i].z() < thinnest_m) return std::nullopt;
  }
  for (const auto& piece : patch.piece) {
    for (size_t k = 1; k + 1 < piece.size(); ++k) {
      s.face.push_back({piece[0], piece[k + 1], piece[k]});
      s.face.push_back({n + piece[0], n + piece[k], n + piece[k + 1]});
    }
  }
  for (const auto& [a, b] : rim_of(patch.piece)) {
    s.face.push_back({a, b, n + b});
    s.face.push_back({a, n + b, n + a});
  }
  return s;
}

}  // namespace adit
