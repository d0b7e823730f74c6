// SPDX-License-Identifier: BSD-3-Clause
#include "base/mesh.h"

#include "base/error.h"
#include "base/files.h"
#include "base/ply.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace adit {
namespace {

PlyColumn scalar(const std::string& name, PlyType type, size_t rows) {
  PlyColumn c{name, type, false, {}, {}};
  c.value.reserve(rows);
  return c;
}

const PlyColumn& need(const std::string& file, const PlyElement& element, const std::string& column) {
  const PlyColumn* c = element.find(column);
  if (!c || c->list) throw Error(file + ": element '" + element.name + "' lacks the property '" + column + "'");
  return *c;
}

std::vector<Vec3> read_vertices(const std::string& file, const Ply& ply) {
  const PlyElement* e = ply.find("vertex");
  if (!e) throw Error(file + ": has no element 'vertex'");
  const PlyColumn &x = need(file, *e, "x"), &y = need(file, *e, "y"), &z = need(file, *e, "z");
  std::vector<Vec3> vertex(e->rows);
  for (size_t i = 0; i < e->rows; ++i) vertex[i] = Vec3(x.value[i], y.value[i], z.value[i]);
  for (size_t i = 0; i < e->rows; ++i)
    if (!vertex[i].allFinite()) throw Error(file + ": vertex " + std::to_string(i) + " is not finite");
  return vertex;
}

PlyElement vertex_element(const Mesh& mesh) {
  PlyElement e{"vertex", mesh.vertex.size(), {}};
  for (int axis = 0; axis < 3; ++axis) {
    PlyColumn c = scalar(std::string(1, "xyz"[axis]), PlyType::float64, mesh.vertex.size());
    for (const Vec3& v : mesh.vertex) c.value.push_back(v[axis]);
    e.columns.push_back(std::move(c));
  }
  return e;
}

template <class T>
void add_column(PlyElement& e, const std::string& name, PlyType type, const std::vector<T>& values) {
  if (values.empty()) return;
  ADIT_CHECK(values.size() == e.rows);
  PlyColumn c = scalar(name, type, e.rows);
  for (const T& v : values) c.value.push_back(static_cast<double>(v));
  e.columns.push_back(std::move(c));
}

PlyElement face_element(const Mesh& mesh) {
  PlyElement e{"face", mesh.face.size(), {}};
  PlyColumn indices{"vertex_indices", PlyType::int32, true, {}, {0}};
  indices.value.reserve(3 * mesh.face.size());
  indices.offset.reserve(mesh.face.size() + 1);
  for (const auto& f : mesh.face) {
    for (std::uint32_t v : f) indices.value.push_back(v);
    indices.offset.push_back(static_cast<std::uint32_t>(indices.value.size()));
  }
  e.columns.push_back(std::move(indices));
  add_column(e, "label", PlyType::int32, mesh.label);
  add_column(e, "part", PlyType::int32, mesh.part);
  add_column(e, "reflectivity", PlyType::float32, mesh.reflectivity);
  add_column(e, "passage", PlyType::int32, mesh.passage);
  add_column(e, "material", PlyType::uint8, mesh.material);
  add_column(e, "wetness", PlyType::float32, mesh.wetness);
  return e;
}

const PlyColumn* index_list(const PlyElement& faces) {
  for (const char* name : {"vertex_indices", "vertex_index"})
    if (const PlyColumn* c = faces.find(name); c && c->list) return c;
  return nullptr;
}

// Fans a polygon into triangles; `row_of` gets the polygon of each triangle.
void read_faces(const std::string& file, const PlyColumn& indices, Mesh& mesh, std::vector<size_t>& row_of) {
  const auto index = [&](size_t i) {
    const double v = indices.value[i];
    if (!(v >= 0) || v >= static_cast<double>(mesh.vertex.size()))
      throw Error(file + ": a face names vertex " + std::to_string(static_cast<long long>(v)) + ", there are " +
                  std::to_string(mesh.vertex.size()));
    return static_cast<std::uint32_t>(v);
  };
  for (size_t row = 0; row + 1 < indices.offset.size(); ++row) {
    const size_t begin = indices.offset[row], end = indices.offset[row + 1];
    for (size_t i = begin + 1; i + 1 < end; ++i) {
      mesh.face.push_back({index(begin), index(i), index(i + 1)});
      row_of.push_back(row);
    }
  }
}

Material material_of(const std::string& file, double value) {
  for (const auto& [name, id] : material_ids())
    if (value == id) return static_cast<Material>(id);
  throw Error(file + ": a face has the unknown material " + std::to_string(static_cast<int>(value)));
}

Label label_of(const std::string& file, double value) {
  for (const auto& [name, id] : label_ids())
    if (value == id) return static_cast<Label>(id);
  throw Error(file + ": a face has the unknown label " + std::to_string(static_cast<int>(value)));
}

}  // namespace

const std::map<std::string, int>& label_ids() {
  static const std::map<std::string, int> ids{{"none", 0}, {"floor", 1},   {"roof", 2},  {"rib", 3},
                                              {"cap", 4},  {"vehicle", 5}, {"pusher", 6}};
  return ids;
}

const std::map<std::string, int>& material_ids() {
  static const std::map<std::string, int> ids{{"none", 0},     {"coal", 1},      {"shale", 2},
                                              {"fireclay", 3}, {"rock_dust", 4}, {"block", 5}};
  return ids;
}

std::string label_name(Label label) {
  for (const auto& [name, id] : label_ids())
    if (id == static_cast<int>(label)) return name;
  return "none";
}

Vec3 Mesh::normal(size_t f) const {
  return (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)).normalized();
}

double Mesh::area(size_t f) const {
  return 0.5 * (corner(f, 1) - corner(f, 0)).cross(corner(f, 2) - corner(f, 0)).norm();
}

double enclosed_volume(const Mesh& mesh) {
  if (mesh.vertex.empty()) return 0;
  const Vec3 origin = mesh.vertex.front();  // near the mesh: small terms, little cancellation
  double six_volumes = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f)
    six_volumes += (mesh.corner(f, 0) - origin).dot((mesh.corner(f, 1) - origin).cross(mesh.corner(f, 2) - origin));
  return six_volumes / 6;
}

size_t open_edges(const Mesh& mesh) {
  // An edge as (lower, higher vertex), and whether the face runs it upwards.
  std::vector<std::pair<std::uint64_t, bool>> edges;
  edges.reserve(3 * mesh.face.size());
  for (const auto& f : mesh.face) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = f[k], b = f[(k + 1) % 3];
      edges.emplace_back(std::uint64_t{std::min(a, b)} << 32 | std::max(a, b), a < b);
    }
  }
  std::sort(edges.begin(), edges.end());
  size_t open = 0;
  for (size_t i = 0; i < edges.size();) {
    size_t end = i + 1;
    while (end < edges.size() && edges[end].first == edges[i].first) ++end;
    if (end - i != 2 || edges[i].second == edges[i + 1].second) ++open;
    i = end;
  }
  return open;
}

namespace {

// Wavefront OBJ: lines "v x y z" and "f a b c ...", counted from 1 or, negative, back from the last vertex; texture
// and normal behind a slash.
Mesh read_obj(const std::string& file) {
  std::istringstream in(read_text(file));
  Mesh mesh;
  size_t number = 0;
  for (std::string text; std::getline(in, text);) {
    ++number;
    const auto fail = [&](const std::string& what) { throw Error(file + ":" + std::to_string(number) + ": " + what); };
    std::istringstream words(text);
    std::string word;
    words >> word;
    if (word == "v") {
      Vec3 v;
      if (!(words >> v.x() >> v.y() >> v.z()) || !v.allFinite()) fail("a vertex needs three finite numbers");
      mesh.vertex.push_back(v);
    } else if (word == "f") {
      std::vector<std::uint32_t> corner;
      while (words >> word) {
        const long long n = std::strtoll(word.c_str(), nullptr, 10);
        const long long at = n < 0 ? static_cast<long long>(mesh.vertex.size()) + n : n - 1;
        if (n == 0 || at < 0 || at >= static_cast<long long>(mesh.vertex.size())) fail("no vertex '" + word + "'");
        corner.push_back(static_cast<std::uint32_t>(at));
      }
      if (corner.size() < 3) fail("a face needs three corners");
      for (size_t k = 1; k + 1 < corner.size(); ++k) mesh.face.push_back({corner[0], corner[k], corner[k + 1]});
    }
  }
  if (mesh.face.empty()) throw Error(file + ": has no faces; a mesh is needed");
  return mesh;
}

}  // namespace

void write_mesh(const std::string& file, const Mesh& mesh) {
  write_ply(file, {{vertex_element(mesh), face_element(mesh)}});
}

Mesh read_mesh(const std::string& file) {
  if (file.ends_with(".obj")) return read_obj(file);
  const Ply ply = read_ply(file);
  Mesh mesh;
  mesh.vertex = read_vertices(file, ply);
  const PlyElement* faces = ply.find("face");
  const PlyColumn* indices = faces ? index_list(*faces) : nullptr;
  if (!indices) throw Error(file + ": has no faces (a list 'vertex_indices'); a mesh is needed");
  std::vector<size_t> row_of;
  read_faces(file, *indices, mesh, row_of);
  if (const PlyColumn* c = faces->find("label"); c && !c->list)
    for (size_t row : row_of) mesh.label.push_back(label_of(file, c->value[row]));
  if (const PlyColumn* c = faces->find("part"); c && !c->list)
    for (size_t row : row_of) mesh.part.push_back(static_cast<int>(c->value[row]));
  if (const PlyColumn* c = faces->find("reflectivity"); c && !c->list)
    for (size_t row : row_of) mesh.reflectivity.push_back(static_cast<float>(c->value[row]));
  if (const PlyColumn* c = faces->find("passage"); c && !c->list)
    for (size_t row : row_of) mesh.passage.push_back(static_cast<int>(c->value[row]));
  if (const PlyColumn* c = faces->find("material"); c && !c->list)
    for (size_t row : row_of) mesh.material.push_back(material_of(file, c->value[row]));
  if (const PlyColumn* c = faces->find("wetness"); c && !c->list)
    for (size_t row : row_of) mesh.wetness.push_back(static_cast<float>(c->value[row]));
  return mesh;
}

}  // namespace adit
