// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/crossings.h"
#include "worlds/worlds.h"

#include <algorithm>
#include <cmath>
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

struct Side {
  std::uint64_t ends;    // (lower, higher vertex)
  std::uint32_t corner;  // 3 * face + k: the side runs from there to the next corner
  bool operator<(const Side& o) const { return ends != o.ends ? ends < o.ends : corner < o.corner; }
};

std::uint32_t next_corner(std::uint32_t c) {
  return c % 3 == 2 ? c - 2 : c + 1;
}

// Sides that do not join two faces in opposite directions, and vertices of several fans.
void check_joints(const Mesh& mesh, WorldCheck& check) {
  std::vector<Side> sides;
  sides.reserve(3 * mesh.face.size());
  const auto vertex = [&](std::uint32_t c) { return mesh.face[c / 3][c % 3]; };
  for (std::uint32_t c = 0; c < 3 * mesh.face.size(); ++c) {
    const std::uint32_t a = vertex(c), b = vertex(next_corner(c));
    sides.push_back({std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), c});
  }
  std::sort(sides.begin(), sides.end());
  Fans fans(sides.size());
  for (size_t i = 0; i < sides.size();) {
    size_t end = i + 1;
    while (end < sides.size() && sides[end].ends == sides[i].ends) ++end;
    const std::uint32_t a = sides[i].corner, b = sides[std::min(end - 1, i + 1)].corner;
    if (end - i != 2 || vertex(a) == vertex(b)) {
      ++check.open_edges;
    } else {
      fans.unite(a, next_corner(b));
      fans.unite(next_corner(a), b);
    }
    i = end;
  }
  std::vector<char> seen(mesh.vertex.size(), 0);
  for (std::uint32_t c = 0; c < sides.size(); ++c) {
    if (fans.root(c) != c) continue;
    char& fan = seen[vertex(c)];
    check.pinched_vertices += fan == 1;
    fan = static_cast<char>(std::min(2, fan + 1));
  }
  check.closed = check.open_edges == 0;
}

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

WorldCheck check_world(const World& world) {
  const Mesh& mesh = world.mesh;
  WorldCheck check;
  check.unlabelled = mesh.label.empty()
                         ? mesh.face.size()
                         : static_cast<size_t>(std::count(mesh.label.begin(), mesh.label.end(), Label::none));
  if (mesh.face.empty()) return check;
  check.degenerate_faces = degenerate_faces(mesh);
  check_joints(mesh, check);
  if (check.closed) check.volume_m3 = enclosed_volume(mesh);
  check.oriented = check.closed && check.volume_m3 > 0;
  check.self_intersections = crossing_pairs(mesh);
  return check;
}

}  // namespace adit
