// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/triangulate.h"

#include "base/error.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Spatial_sort_traits_adapter_2.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/spatial_sort.h>

#include <numeric>

namespace adit {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_2;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_2<std::uint32_t, Kernel>;
using FaceInfoBase = CGAL::Triangulation_face_base_with_info_2<int, Kernel>;
using FaceBase = CGAL::Constrained_triangulation_face_base_2<Kernel, FaceInfoBase>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure, CGAL::No_constraint_intersection_tag>;

constexpr std::uint32_t none = 0xFFFFFFFF;

std::vector<Triangulation::Vertex_handle> insert_all(Triangulation& t, const std::vector<Point>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto map = CGAL::make_property_map(points);
  CGAL::spatial_sort(order.begin(), order.end(), CGAL::Spatial_sort_traits_adapter_2<Kernel, decltype(map)>(map));
  std::vector<Triangulation::Vertex_handle> handle(points.size());
  Triangulation::Face_handle hint;
  for (std::size_t i : order) {
    handle[i] = t.insert(points[i], hint);
    hint = handle[i]->face();
  }
  return handle;
}

// Faces get 0 outside and 1 inside: a constraint is crossed between the two.
void mark_inside(Triangulation& t) {
  for (const auto& f : t.all_face_handles()) f->info() = -1;
  std::vector<Triangulation::Face_handle> stack{t.infinite_face()};
  stack.back()->info() = 0;
  while (!stack.empty()) {
    const auto f = stack.back();
    stack.pop_back();
    for (int k = 0; k < 3; ++k) {
      const auto next = f->neighbor(k);
      if (next->info() >= 0) continue;
      next->info() = f->is_constrained(k) ? 1 - f->info() : f->info();
      stack.push_back(next);
    }
  }
}

}  // namespace

PlanMesh triangulate(const std::vector<Loop>& loops, const std::vector<Vec2>& extra) {
  std::vector<Point> points;
  for (const Loop& loop : loops)
    for (const Vec2& p : loop) points.emplace_back(p.x(), p.y());
  const size_t bound = points.size();
  for (const Vec2& p : extra) points.emplace_back(p.x(), p.y());

  Triangulation t;
  const auto handle = insert_all(t, points);
  try {
    size_t first = 0;
    for (const Loop& loop : loops) {
      for (size_t k = 0; k < loop.size(); ++k)
        t.insert_constraint(handle[first + k], handle[first + (k + 1) % loop.size()]);
      first += loop.size();
    }
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    throw Error("world: ribs would cross one another; lower world.rib.rms_m or raise world.corner_radius_m");
  }
  mark_inside(t);

  PlanMesh mesh;
  std::vector<std::uint32_t> index(points.size(), none);
  for (size_t i = 0; i < points.size(); ++i) handle[i]->info() = static_cast<std::uint32_t>(i);
  for (size_t i = 0; i < bound; ++i) {
    if (handle[i]->info() != i) throw Error("world: two points of the ribs coincide; raise world.mesh_edge_m");
    index[i] = static_cast<std::uint32_t>(i);
    mesh.vertex.emplace_back(points[i].x(), points[i].y());
  }
  for (const auto& f : t.finite_face_handles()) {
    if (f->info() != 1) continue;
    std::array<std::uint32_t, 3> face;
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t i = f->vertex(k)->info();
      if (index[i] == none) {
        index[i] = static_cast<std::uint32_t>(mesh.vertex.size());
        mesh.vertex.emplace_back(points[i].x(), points[i].y());
      }
      face[k] = index[i];
    }
    mesh.face.push_back(face);
  }
  return mesh;
}

}  // namespace adit
