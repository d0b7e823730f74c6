// SPDX-License-Identifier: BSD-3-Clause
#include "eval/outline.h"

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

struct Edge {
  std::uint32_t a, b;
  bool operator<(const Edge& other) const { return a != other.a ? a < other.a : b < other.b; }
};

// Edges of floor faces, in the direction of the face, whose twin is no edge of a floor face.
std::vector<Edge> floor_rim(const Mesh& mesh) {
  std::vector<Edge> all, rim;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    if (!is_ground(label_of(mesh, f))) continue;
    for (int k = 0; k < 3; ++k) all.push_back({mesh.face[f][k], mesh.face[f][(k + 1) % 3]});
  }
  std::sort(all.begin(), all.end());
  for (const Edge& e : all)
    if (!std::binary_search(all.begin(), all.end(), Edge{e.b, e.a})) rim.push_back(e);
  return rim;
}

}  // namespace

Label label_of(const Mesh& mesh, size_t face) {
  if (!mesh.label.empty()) return mesh.label[face];
  const double up = mesh.normal(face).z();
  return up > 0.6 ? Label::roof : up < -0.6 ? Label::floor : Label::rib;
}

std::vector<std::vector<Vec2>> plan_outline(const Mesh& mesh, double tolerance_m) {
  const std::vector<Edge> rim = floor_rim(mesh);
  std::vector<char> used(rim.size(), 0);
  std::vector<std::vector<Vec2>> rings;
  for (size_t first = 0; first < rim.size(); ++first) {
    if (used[first]) continue;
    std::vector<Vec2> ring;
    for (size_t at = first; at < rim.size() && !used[at];) {
      used[at] = 1;
      ring.push_back(mesh.vertex[rim[at].a].head<2>());
      const std::uint32_t next = rim[at].b;
      auto it = std::lower_bound(rim.begin(), rim.end(), Edge{next, 0});
      while (it != rim.end() && it->a == next && used[it - rim.begin()]) ++it;
      if (it == rim.end() || it->a != next) break;
      at = static_cast<size_t>(it - rim.begin());
    }
    if (ring.size() < 3) continue;
    ring.push_back(ring.front());
    ring = simplified(ring, tolerance_m);
    ring.pop_back();
    if (ring.size() >= 3) rings.push_back(std::move(ring));
  }
  return rings;
}

std::vector<Vec2> clipped_ring(const std::vector<Vec2>& ring, const Vec2& low, const Vec2& high) {
  std::vector<Vec2> kept = ring;
  for (const int axis : {0, 1})
    for (const double side : {1.0, -1.0}) {
      const double border = side > 0 ? low[axis] : -high[axis];
      const auto depth = [&](const Vec2& p) { return side * p[axis] - border; };
      std::vector<Vec2> next;
      for (size_t k = 0; k < kept.size(); ++k) {
        const Vec2 &a = kept[k], &b = kept[(k + 1) % kept.size()];
        const double da = depth(a), db = depth(b);
        if (da >= 0) next.push_back(a);
        if ((da >= 0) != (db >= 0)) next.push_back(a + (b - a) * (da / (da - db)));
      }
      kept = std::move(next);
    }
  return kept;
}

std::optional<std::pair<Vec2, Vec2>> clipped_stretch(Vec2 a, Vec2 b, const Vec2& low, const Vec2& high) {
  double from = 0, to = 1;
  const Vec2 d = b - a;
  for (const int axis : {0, 1})
    for (const double side : {1.0, -1.0}) {
      const double border = side > 0 ? low[axis] : -high[axis];
      const double depth = side * a[axis] - border, slope = side * d[axis];
      if (slope == 0) {
        if (depth < 0) return {};
        continue;
      }
      const double cross = -depth / slope;
      if (slope > 0)
        from = std::max(from, cross);
      else
        to = std::min(to, cross);
    }
  if (from >= to) return {};
  return std::pair{Vec2(a + from * d), Vec2(a + to * d)};
}

std::vector<std::pair<Vec2, Vec2>> upright_section(const Mesh& mesh, const Vec2& origin, const Vec2& along,
                                                   double reach_m) {
  const Vec2 across(-along.y(), along.x());
  std::vector<std::pair<Vec2, Vec2>> stretches;
  for (const auto& face : mesh.face) {
    std::array<double, 3> side;
    for (int k = 0; k < 3; ++k) side[k] = across.dot(mesh.vertex[face[k]].head<2>() - origin);
    if (*std::min_element(side.begin(), side.end()) > 0 || *std::max_element(side.begin(), side.end()) < 0) continue;
    std::vector<Vec2> ends;
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3;
      if ((side[k] < 0) == (side[l] < 0)) continue;
      const Vec3 p =
          mesh.vertex[face[k]] + (mesh.vertex[face[l]] - mesh.vertex[face[k]]) * (side[k] / (side[k] - side[l]));
      ends.emplace_back(along.dot(p.head<2>() - origin), p.z());
    }
    if (ends.size() == 2 && std::min(std::abs(ends[0].x()), std::abs(ends[1].x())) <= reach_m)
      stretches.emplace_back(ends[0], ends[1]);
  }
  return stretches;
}

}  // namespace adit
