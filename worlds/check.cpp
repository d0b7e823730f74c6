// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/crossings.h"
#include "worlds/worlds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace adit {
namespace {

// Corners of faces are one fan where a chain of shared sides joins them. A vertex with several fans is one at which the
// surface only touches itself.
class Fans {
 public:
  explicit Fans(size_t corners) : parent_(corners) { std::iota(parent_.begin(), parent_.end(), 0u); }
  std::uint32_t root(std::uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::uint32_t a, std::uint32_t b) { parent_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

 private:
  std::vector<std::uint32_t> parent_;
};

constexpr size_t vertices_at_a_time = 1 << 20;

struct Side {
  std::uint64_t ends;    // (lower, higher vertex)
  std::uint32_t corner;  // 3 * face + k: the side runs from there to the next corner
  bool operator<(const Side& o) const { return ends != o.ends ? ends < o.ends : corner < o.corner; }
};

std::uint32_t next_corner(std::uint32_t c) {
  return c % 3 == 2 ? c - 2 : c + 1;
}

// Calls open(corner) for every side that no other face of the mesh runs against, and fans(vertex, n) for every vertex of
// n fans.
template <class Open, class FanCount>
void check_sides(const Mesh& mesh, const Open& open, const FanCount& fans_at) {
  const auto corners = static_cast<std::uint32_t>(3 * mesh.face.size());
  const auto vertex = [&](std::uint32_t c) { return mesh.face[c / 3][c % 3]; };
  Fans fans(corners);
  std::vector<Side> sides;
  // A million vertices at a time: the list of all sides would be larger than the mesh.
  for (size_t from = 0; from < mesh.vertex.size(); from += vertices_at_a_time) {
    sides.clear();
    for (std::uint32_t c = 0; c < corners; ++c) {
      const std::uint32_t a = vertex(c), b = vertex(next_corner(c)), low = std::min(a, b);
      if (low >= from && low - from < vertices_at_a_time)
        sides.push_back({std::uint64_t{low} << 32 | std::max(a, b), c});
    }
    std::sort(sides.begin(), sides.end());
    for (size_t i = 0; i < sides.size();) {
      size_t end = i + 1;
      while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
      const std::uint32_t a = sides[i].corner, b = sides[std::min(end - 1, i + 1)].corner;
      if (end - i != 2 || vertex(a) == vertex(b)) {
        open(a, end - i);
      } else {
        fans.unite(a, next_corner(b));
        fans.unite(next_corner(a), b);
      }
      i = end;
    }
  }
  std::vector<std::uint8_t> count(mesh.vertex.size(), 0);
  for (std::uint32_t c = 0; c < corners; ++c)
    if (fans.root(c) == c) count[vertex(c)] = static_cast<std::uint8_t>(std::min(255, count[vertex(c)] + 1));
  for (std::uint32_t v = 0; v < count.size(); ++v) fans_at(v, count[v]);
}

// The faces of a mesh that reach into a frame, with the vertices that they need.
template <class Kept>
void take_faces(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id, const MinePart::Frame& frame,
                const Kept& kept) {
  for (const auto& f : mesh.face) {
    const Vec3 low = mesh.vertex[f[0]].cwiseMin(mesh.vertex[f[1]]).cwiseMin(mesh.vertex[f[2]]);
    const Vec3 high = mesh.vertex[f[0]].cwiseMax(mesh.vertex[f[1]]).cwiseMax(mesh.vertex[f[2]]);
    if ((low.head<2>().array() > frame.high.array()).any() || (high.head<2>().array() < frame.low.array()).any())
      continue;
    kept(std::array<std::uint32_t, 3>{vertex_id[f[0]], vertex_id[f[1]], vertex_id[f[2]]},
         std::array<Vec3, 3>{mesh.vertex[f[0]], mesh.vertex[f[1]], mesh.vertex[f[2]]});
  }
}

// A mesh of faces that name their vertices by ids.
struct Patch {
  Mesh mesh;
  std::vector<std::uint32_t> vertex_id;
  std::map<std::uint32_t, std::uint32_t> index;

  void add(const std::array<std::uint32_t, 3>& id, const std::array<Vec3, 3>& at) {
    std::array<std::uint32_t, 3> face;
    for (int k = 0; k < 3; ++k) {
      const auto [found, fresh] = index.emplace(id[k], static_cast<std::uint32_t>(mesh.vertex.size()));
      if (fresh) {
        mesh.vertex.push_back(at[k]);
        vertex_id.push_back(id[k]);
      }
      face[k] = found->second;
    }
    mesh.face.push_back(face);
  }
};

}  // namespace

std::string WorldCheck::what() const {
  if (ok()) return "closed, oriented, no self-intersection, every face labelled";
  std::string text;
  const auto add = [&](bool wrong, const std::string& what) {
    if (wrong) text += (text.empty() ? "" : ", ") + what;
  };
  add(!closed, "not closed (" + std::to_string(open_edges) + " edges that do not join two faces)");
  add(!oriented, "not oriented with normals out of the void");
  add(self_intersections > 0, std::to_string(self_intersections) + " pairs of faces that cut each other");
  add(degenerate_faces > 0, std::to_string(degenerate_faces) + " faces without area");
  add(pinched_vertices > 0, std::to_string(pinched_vertices) + " points where the surface touches itself");
  add(unlabelled > 0, std::to_string(unlabelled) + " faces without label");
  return text;
}

// Sides that wait for a neighbour are open until it comes and runs them the other way.
void PartsCheck::check_joints(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id) {
  std::vector<char> at_border(mesh.vertex.size(), 0);
  const auto open = [&](std::uint32_t corner, size_t faces) {
    const std::uint32_t from = mesh.face[corner / 3][corner % 3];
    const std::uint32_t to = mesh.face[next_corner(corner) / 3][next_corner(corner) % 3];
    at_border[from] = at_border[to] = 1;
    const std::uint32_t a = vertex_id[from], b = vertex_id[to];
    const std::uint64_t ends = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
    const auto other = open_.find(ends);
    if (faces != 1) {
      ++check_.open_edges;
    } else if (other == open_.end()) {
      open_[ends] = a < b;
    } else if (other->second == (a < b)) {
      ++check_.open_edges;  // two parts run it the same way
    } else {
      open_.erase(other);
    }
  };
  check_sides(mesh, open, [&](std::uint32_t v, int fans) {
    if (at_border[v] == 0) {
      check_.pinched_vertices += fans > 1;
      return;
    }
    // Where two parts meet each has one fan: more of them are a pinch.
    int& all = fans_[vertex_id[v]];
    check_.pinched_vertices += all <= 2 && all + fans > 2;
    all += fans;
  });
}

void PartsCheck::check_crossings(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id, size_t index,
                                 const std::vector<MinePart::Frame>& later) {
  check_.self_intersections += crossing_pairs(mesh);
  for (const Waiting& other : waiting_[index]) {
    Patch both;
    for (const auto& f : other.mesh.face)
      both.add({other.vertex_id[f[0]], other.vertex_id[f[1]], other.vertex_id[f[2]]},
               {other.mesh.vertex[f[0]], other.mesh.vertex[f[1]], other.mesh.vertex[f[2]]});
    MinePart::Frame near{0, Vec2(1e300, 1e300), Vec2(-1e300, -1e300)};
    for (const Vec3& v : other.mesh.vertex) {
      near.low = near.low.cwiseMin(v.head<2>());
      near.high = near.high.cwiseMax(v.head<2>());
    }
    Patch own;
    take_faces(mesh, vertex_id, near, [&](const auto& id, const auto& at) {
      both.add(id, at);
      own.add(id, at);
    });
    if (const size_t found = crossing_pairs(both.mesh); found > 0)
      check_.self_intersections += found - crossing_pairs(own.mesh) - crossing_pairs(other.mesh);
  }
  waiting_.erase(index);
  for (const MinePart::Frame& next : later) {
    Patch patch;
    take_faces(mesh, vertex_id, next, [&](const auto& id, const auto& at) { patch.add(id, at); });
    if (!patch.mesh.face.empty()) waiting_[next.part].push_back({std::move(patch.mesh), std::move(patch.vertex_id)});
  }
}

void MeshTally::add(const Mesh& mesh, const Vec3& origin) {
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const double six = (mesh.corner(f, 0) - origin).dot((mesh.corner(f, 1) - origin).cross(mesh.corner(f, 2) - origin));
    const Label label = f < mesh.label.size() ? mesh.label[f] : Label::none;
    six_volumes += six;
    if (!is_object(label))
      rock_six_volumes += six;
    else if (f < mesh.part.size() && mesh.part[f] >= 0) {
      const auto id = static_cast<size_t>(mesh.part[f]);
      if (id >= body_six_volumes.size()) body_six_volumes.resize(id + 1, 0.0);
      body_six_volumes[id] -= six;
    }
    if (f < mesh.passage.size()) {
      passages = std::max(passages, mesh.passage[f] + 1);
      nameless += mesh.passage[f] < 0;
    }
    if (f >= mesh.part.size() || mesh.label.empty()) continue;
    const bool thing = is_numbered(label);
    const bool level = is_ground(label) || is_roof(label);
    int& highest = thing ? objects : level ? passages : pillars;
    highest = std::max(highest, mesh.part[f] + 1);
    nameless += mesh.part[f] < (thing || level ? 0 : -1);
  }
}

void PartsCheck::add(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id, size_t index,
                     const std::vector<MinePart::Frame>& later) {
  faces_ += mesh.face.size();
  check_.unlabelled += mesh.label.empty()
                           ? mesh.face.size()
                           : static_cast<size_t>(std::count(mesh.label.begin(), mesh.label.end(), Label::none));
  if (mesh.face.empty()) return;
  if (faces_ == mesh.face.size()) origin_ = mesh.vertex.front();
  check_.degenerate_faces += degenerate_faces(mesh);
  check_joints(mesh, vertex_id);
  tally_.add(mesh, origin_);
  check_crossings(mesh, vertex_id, index, later);
}

WorldCheck PartsCheck::finish() const {
  WorldCheck check = check_;
  check.open_edges += open_.size();
  check.closed = faces_ > 0 && check.open_edges == 0;
  check.volume_m3 = check.closed ? tally_.six_volumes / 6 : 0;
  check.oriented = check.volume_m3 > 0;
  return check;
}

WorldCheck check_world(const World& world) {
  PartsCheck check;
  std::vector<std::uint32_t> all(world.mesh.vertex.size());
  std::iota(all.begin(), all.end(), 0u);
  check.add(world.mesh, all, 0, {});
  return check.finish();
}

}  // namespace adit
