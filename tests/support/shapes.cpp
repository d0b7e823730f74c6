// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace adit {
namespace {

// Adds the parallelogram at `corner` spanned by u and v, normal along u x v, cut into squares of about edge_m; vertices
// shared by position.
class Builder {
 public:
  Mesh mesh;

  void plate(const Vec3& corner, const Vec3& u, const Vec3& v, double edge_m, Label label, int part) {
    const int n = std::max(1, static_cast<int>(std::lround(u.norm() / edge_m)));
    const int m = std::max(1, static_cast<int>(std::lround(v.norm() / edge_m)));
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) {
        const auto at = [&](int a, int b) { return index(corner + u * (double(a) / n) + v * (double(b) / m)); };
        const std::uint32_t p00 = at(i, j), p10 = at(i + 1, j), p11 = at(i + 1, j + 1), p01 = at(i, j + 1);
        add({p00, p10, p11}, label, part);
        add({p00, p11, p01}, label, part);
      }
  }

 private:
  std::map<std::array<std::int64_t, 3>, std::uint32_t> seen_;

  std::uint32_t index(const Vec3& p) {
    const std::array<std::int64_t, 3> key{std::llround(p.x() * 1e6), std::llround(p.y() * 1e6),
                                          std::llround(p.z() * 1e6)};
    const auto [it, added] = seen_.try_emplace(key, static_cast<std::uint32_t>(mesh.vertex.size()));
    if (added) mesh.vertex.push_back(p);
    return it->second;
  }
  void add(const std::array<std::uint32_t, 3>& f, Label label, int part) {
    mesh.face.push_back(f);
    mesh.label.push_back(label);
    mesh.part.push_back(part);
    mesh.reflectivity.push_back(0.45f);
  }
};

void set_numbers(World& w, double floor_area, double height) {
  w.numbers.floor_area_m2 = floor_area;
  w.numbers.volume_m3 = floor_area * height;
  double pillars = 0;
  for (const Pillar& p : w.pillars) pillars += p.area_m2;
  w.numbers.extraction_ratio = floor_area / (floor_area + pillars);
}

std::vector<Vec3> straight(const Vec3& a, const Vec3& b) {
  const int n = std::max(1, static_cast<int>(std::lround((b - a).norm())));
  std::vector<Vec3> line;
  for (int i = 0; i <= n; ++i) line.push_back(a + (b - a) * (double(i) / n));
  return line;
}

}  // namespace

Mesh fine_box_mesh(const Vec3& low, const Vec3& high, double edge_m) {
  const Vec3 d = high - low;
  const Vec3 x(d.x(), 0, 0), y(0, d.y(), 0), z(0, 0, d.z());
  Builder b;
  b.plate(low, y, x, edge_m, Label::floor, 0);
  b.plate(low + z, x, y, edge_m, Label::roof, 0);
  b.plate(low, x, z, edge_m, Label::rib, -1);
  b.plate(low + y, z, x, edge_m, Label::rib, -1);
  b.plate(low, z, y, edge_m, Label::rib, -1);
  b.plate(low + x, y, z, edge_m, Label::rib, -1);
  return b.mesh;
}

Mesh box_mesh(const Vec3& low, const Vec3& high) {
  return fine_box_mesh(low, high, 1e9);
}

Mesh sphere_mesh(const Vec3& centre, double radius_m, int rounds) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vec3> v{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                      {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<std::uint32_t, 3>> f{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                              {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                              {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                              {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int round = 0; round < rounds; ++round) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middle;
    const auto mid = [&](std::uint32_t a, std::uint32_t b) {
      const auto [it, added] = middle.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(v.size()));
      if (added) v.push_back((v[a].normalized() + v[b].normalized()) / 2);
      return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : f) {
      const std::uint32_t ab = mid(a, b), bc = mid(b, c), ca = mid(c, a);
      for (const std::array<std::uint32_t, 3>& t : {std::array{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}})
        finer.push_back(t);
    }
    f = std::move(finer);
  }
  Mesh mesh;
  for (const Vec3& p : v) mesh.vertex.push_back(centre + radius_m * p.normalized());
  mesh.face = f;
  mesh.label.assign(f.size(), Label::rib);
  mesh.part.assign(f.size(), -1);
  mesh.reflectivity.assign(f.size(), 0.45f);
  return mesh;
}

World tunnel_world(double length_m, double width_m, double height_m, double edge_m) {
  World w;
  w.name = "tunnel";
  w.mesh = fine_box_mesh({0, -width_m / 2, 0}, {length_m, width_m / 2, height_m}, edge_m);
  w.junctions = {{Vec3(0, 0, 0), {0}}, {Vec3(length_m, 0, 0), {0}}};
  w.passages = {{0, 1, straight({0, 0, 0}, {length_m, 0, 0}), width_m, height_m, length_m}};
  set_numbers(w, length_m * width_m, height_m);
  return w;
}

World ring_world(double outer_m, double width_m, double height_m, double edge_m) {
  const double o = outer_m / 2, i = o - width_m, c = o - width_m / 2;
  Builder b;
  const Vec3 up(0, 0, height_m);
  // Floor and roof as four strips that meet at the corners' inner edges; strip k belongs to passage k.
  const Vec3 corner[4] = {{-o, -o, 0}, {i, -o, 0}, {-i, i, 0}, {-o, -i, 0}};
  const Vec3 along[4] = {{2 * o - width_m, 0, 0}, {width_m, 0, 0}, {2 * i + width_m, 0, 0}, {width_m, 0, 0}};
  const Vec3 across[4] = {{0, width_m, 0}, {0, 2 * i + width_m, 0}, {0, width_m, 0}, {0, 2 * i + width_m, 0}};
  for (int k = 0; k < 4; ++k) {
    b.plate(corner[k], across[k], along[k], edge_m, Label::floor, k);
    b.plate(corner[k] + up, along[k], across[k], edge_m, Label::roof, k);
  }
  // Ribs: the outer side faces outward, the pillar's faces towards its middle. Cut as the strips are, so that edges
  // meet.
  const auto ribs = [&](const std::vector<Vec3>& ring, int part) {
    for (size_t k = 0; k < ring.size(); ++k)
      b.plate(ring[k], ring[(k + 1) % ring.size()] - ring[k], up, edge_m, Label::rib, part);
  };
  ribs({{-o, -o, 0}, {i, -o, 0}, {o, -o, 0}, {o, i, 0}, {o, o, 0}, {-i, o, 0}, {-o, o, 0}, {-o, -i, 0}}, -1);
  ribs({{-i, -i, 0}, {-i, i, 0}, {i, i, 0}, {i, -i, 0}}, 0);
  World w;
  w.name = "ring";
  w.mesh = b.mesh;
  const Vec3 node[4] = {{-c, -c, 0}, {c, -c, 0}, {c, c, 0}, {-c, c, 0}};
  for (int k = 0; k < 4; ++k) {
    w.junctions.push_back({node[k], {(k + 3) % 4, k}});
    w.passages.push_back({k, (k + 1) % 4, straight(node[k], node[(k + 1) % 4]), width_m, height_m, 2 * c});
  }
  w.pillars = {{{{-i, -i}, {i, -i}, {i, i}, {-i, i}}, 4 * i * i}};
  w.numbers.loops = 1;
  set_numbers(w, outer_m * outer_m - 4 * i * i, height_m);
  return w;
}

}  // namespace adit
