// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/exact.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <array>

namespace adit {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Segment = Kernel::Segment_3;
using Triangle = Kernel::Triangle_3;

Point point(const Mesh& mesh, std::uint32_t v) {
  const Vec3& p = mesh.vertex[v];
  return {p.x(), p.y(), p.z()};
}

// The face's corners turned so that `first` comes first.
std::array<std::uint32_t, 3> turned(const std::array<std::uint32_t, 3>& face, std::uint32_t first) {
  if (face[0] == first) return face;
  if (face[1] == first) return {face[1], face[2], face[0]};
  return {face[2], face[0], face[1]};
}

bool cross_at_corner(const Mesh& mesh, const std::array<std::uint32_t, 3>& a, const std::array<std::uint32_t, 3>& b) {
  const Triangle s(point(mesh, a[0]), point(mesh, a[1]), point(mesh, a[2])),
      t(point(mesh, b[0]), point(mesh, b[1]), point(mesh, b[2]));
  return CGAL::do_intersect(s, Segment(t[1], t[2])) || CGAL::do_intersect(t, Segment(s[1], s[2]));
}

// They fold up where all four corners lie in one plane and the two that are not shared lie on one side of the others.
bool fold_at_side(const Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  const Point p = point(mesh, a), q = point(mesh, b), r = point(mesh, c), s = point(mesh, d);
  if (!CGAL::coplanar(p, q, r, s)) return false;
  return CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
}

}  // namespace

bool no_area(const Mesh& mesh, size_t f) {
  const auto& c = mesh.face[f];
  return CGAL::collinear(point(mesh, c[0]), point(mesh, c[1]), point(mesh, c[2]));
}

bool faces_cross(const Mesh& mesh, size_t f, size_t g) {
  std::vector<std::uint32_t> shared;
  for (std::uint32_t v : mesh.face[f])
    for (std::uint32_t w : mesh.face[g])
      if (v == w) shared.push_back(v);
  if (no_area(mesh, f) || no_area(mesh, g)) return shared.empty();  // they count as faces without area
  const auto a = turned(mesh.face[f], shared.empty() ? mesh.face[f][0] : shared[0]);
  const auto b = turned(mesh.face[g], shared.empty() ? mesh.face[g][0] : shared[0]);
  if (shared.size() >= 3) return true;
  if (shared.size() == 1) return cross_at_corner(mesh, a, b);
  if (shared.size() == 2)
    return fold_at_side(mesh, shared[0], shared[1], a[1] == shared[1] ? a[2] : a[1], b[1] == shared[1] ? b[2] : b[1]);
  return CGAL::do_intersect(Triangle(point(mesh, a[0]), point(mesh, a[1]), point(mesh, a[2])),
                            Triangle(point(mesh, b[0]), point(mesh, b[1]), point(mesh, b[2])));
}

}  // namespace adit
