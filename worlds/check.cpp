// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"
#include "worlds/worlds.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>

namespace adit {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using SurfaceMesh = CGAL::Surface_mesh<Point>;
using FaceId = SurfaceMesh::Face_index;
using Pair = std::pair<FaceId, FaceId>;

std::vector<Point> points_of(const Mesh& mesh) {
  std::vector<Point> points;
  points.reserve(mesh.vertex.size());
  for (const Vec3& v : mesh.vertex) points.emplace_back(v.x(), v.y(), v.z());
  return points;
}

// Two faces that meet do so at a point, and that lies in some slab across the longest side that both of them reach
// into: the slabs can be searched side by side.
std::vector<std::vector<FaceId>> slabs_of(const SurfaceMesh& mesh, const Mesh& raw, size_t count) {
  Vec3 low = raw.vertex[0], high = low;
  for (const Vec3& v : raw.vertex) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const double thickness = std::max((high - low)[axis], 1e-9) / static_cast<double>(count);
  std::vector<std::vector<FaceId>> slabs(count);
  const auto slab = [&](double x) {
    return static_cast<size_t>(std::clamp((x - low[axis]) / thickness, 0.0, static_cast<double>(count) - 1));
  };
  for (FaceId f : mesh.faces()) {
    double from = 1e300, to = -1e300;
    for (auto v : mesh.vertices_around_face(mesh.halfedge(f))) {
      from = std::min(from, mesh.point(v)[axis]);
      to = std::max(to, mesh.point(v)[axis]);
    }
    for (size_t k = slab(from); k <= slab(to); ++k) slabs[k].push_back(f);
  }
  return slabs;
}

size_t self_intersections(const SurfaceMesh& mesh, const Mesh& raw) {
  const auto slabs = slabs_of(mesh, raw, std::max<size_t>(1, raw.face.size() / 50000));
  std::vector<std::vector<Pair>> found(slabs.size());
  parallel_for(slabs.size(), [&](size_t k) { pmp::self_intersections(slabs[k], mesh, std::back_inserter(found[k])); });
  std::vector<Pair> all;  // a pair may be found in two slabs
  for (const auto& pairs : found)
    for (const Pair& p : pairs) all.emplace_back(std::min(p.first, p.second), std::max(p.first, p.second));
  std::sort(all.begin(), all.end());
  return static_cast<size_t>(std::unique(all.begin(), all.end()) - all.begin());
}

size_t degenerate_faces(const std::vector<Point>& points, const Mesh& mesh) {
  size_t count = 0;
  for (const auto& f : mesh.face) count += CGAL::collinear(points[f[0]], points[f[1]], points[f[2]]);
  return count;
}

}  // namespace

std::string WorldCheck::what() const {
  if (ok()) return "closed, oriented, no self-intersection, every face labelled";
  std::string text;
  const auto add = [&](bool wrong, const std::string& what) {
    if (wrong) text += (text.empty() ? "" : ", ") + what;
  };
  add(!closed, "not closed");
  add(!oriented, "not oriented with normals out of the void");
  add(self_intersections > 0, std::to_string(self_intersections) + " pairs of faces that cut each other");
  add(degenerate_faces > 0, std::to_string(degenerate_faces) + " faces without area");
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
  const std::vector<Point> points = points_of(mesh);
  check.degenerate_faces = degenerate_faces(points, mesh);
  std::vector<std::array<std::size_t, 3>> faces;
  faces.reserve(mesh.face.size());
  for (const auto& f : mesh.face) faces.push_back({f[0], f[1], f[2]});
  if (!pmp::is_polygon_soup_a_polygon_mesh(faces)) return check;  // edges of three faces, or faces against each other
  SurfaceMesh surface;
  pmp::polygon_soup_to_polygon_mesh(points, faces, surface);
  check.closed = CGAL::is_closed(surface);
  if (check.closed) check.volume_m3 = CGAL::to_double(pmp::volume(surface));
  check.oriented = check.closed && check.volume_m3 > 0;
  check.self_intersections = self_intersections(surface, mesh);
  return check;
}

}  // namespace adit
