// SPDX-License-Identifier: BSD-3-Clause
#include "base/mesh.h"

#include "base/error.h"
#include "base/files.h"
#include "base/mesh_writer.h"
#include "base/ply.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace adit {
namespace {

// Where an element's columns of some names stand among all, -1 for those that it lacks.
std::vector<int> columns_of(const PlyElement& element, const std::vector<std::string>& names, bool lists) {
  std::vector<int> at;
  for (const std::string& name : names) {
    const auto found = std::find_if(element.columns.begin(), element.columns.end(),
                                    [&](const PlyColumn& c) { return c.name == name && c.list == lists; });
    at.push_back(found == element.columns.end() ? -1 : static_cast<int>(found - element.columns.begin()));
  }
  return at;
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
  static const std::map<std::string, int> ids{
      {"none", 0},    {"floor", 1}, {"roof", 2},      {"rib", 3},       {"cap", 4},     {"vehicle", 5}, {"pusher", 6},
      {"rubble", 7},  {"talus", 8}, {"post", 9},      {"crossbar", 10}, {"crib", 11},   {"bolt", 12},   {"rail", 13},
      {"tie", 14},    {"belt", 15}, {"stopping", 16}, {"door", 17},     {"pipe", 18},   {"cable", 19},  {"water", 20},
      {"sludge", 21}, {"car", 22},  {"beam", 23},     {"block", 24},    {"cavity", 25}, {"scar", 26}};
  return ids;
}

const std::map<std::string, int>& material_ids() {
  static const std::map<std::string, int> ids{{"none", 0},      {"coal", 1},  {"shale", 2},  {"fireclay", 3},
                                              {"rock_dust", 4}, {"block", 5}, {"timber", 6}, {"steel", 7},
                                              {"water", 8},     {"mud", 9}};
  return ids;
}

bool is_ground(Label label) {
  return label == Label::floor || label == Label::rubble || label == Label::talus || label == Label::sludge;
}

bool is_object(Label label) {
  return label >= Label::post && label <= Label::block && label != Label::sludge;
}

bool is_roof(Label label) {
  return label == Label::roof || label == Label::cavity || label == Label::scar;
}

bool is_numbered(Label label) {
  return is_object(label) || label == Label::rubble || label == Label::cavity || label == Label::scar;
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

// Takes a mesh from the rows of a PLY file.
class Rows {
 public:
  explicit Rows(std::string file) : file_(std::move(file)) {}

  void begin(const PlyElement& e) {
    if (e.name == "vertex") {
      place_ = columns_of(e, {"x", "y", "z"}, false);
      for (int axis = 0; axis < 3; ++axis)
        if (place_[axis] < 0) throw Error(file_ + ": element 'vertex' lacks the property '" + "xyz"[axis] + "'");
      mesh_.vertex.reserve(e.rows);
    } else if (e.name == "face") {
      const std::vector<int> lists = columns_of(e, {"vertex_indices", "vertex_index"}, true);
      corners_ = std::max(lists[0], lists[1]);
      if (place_.empty()) throw Error(file_ + ": has no element 'vertex'");
      if (corners_ < 0) return;
      told_ = columns_of(e, {"label", "part", "reflectivity", "passage", "material", "wetness"}, false);
      mesh_.face.reserve(e.rows);
    }
  }

  void row(const PlyElement& e, const std::vector<std::vector<double>>& row) {
    if (e.name == "vertex") {
      const Vec3 v(row[place_[0]][0], row[place_[1]][0], row[place_[2]][0]);
      if (!v.allFinite()) throw Error(file_ + ": vertex " + std::to_string(mesh_.vertex.size()) + " is not finite");
      mesh_.vertex.push_back(v);
    } else if (e.name == "face" && corners_ >= 0) {
      const std::vector<double>& corner = row[corners_];
      for (size_t i = 1; i + 1 < corner.size(); ++i) {  // a polygon is fanned
        mesh_.face.push_back({index(corner[0]), index(corner[i]), index(corner[i + 1])});
        tell(row);
      }
    }
  }

  Mesh take() {
    if (place_.empty()) throw Error(file_ + ": has no element 'vertex'");
    if (corners_ < 0) throw Error(file_ + ": has no faces (a list 'vertex_indices'); a mesh is needed");
    return std::move(mesh_);
  }

 private:
  std::uint32_t index(double v) const {
    if (!(v >= 0) || v >= static_cast<double>(mesh_.vertex.size()))
      throw Error(file_ + ": a face names vertex " + std::to_string(static_cast<long long>(v)) + ", there are " +
                  std::to_string(mesh_.vertex.size()));
    return static_cast<std::uint32_t>(v);
  }

  void tell(const std::vector<std::vector<double>>& row) {
    const auto told = [&](int k) { return row[told_[k]][0]; };
    if (told_[0] >= 0) mesh_.label.push_back(label_of(file_, told(0)));
    if (told_[1] >= 0) mesh_.part.push_back(static_cast<int>(told(1)));
    if (told_[2] >= 0) mesh_.reflectivity.push_back(static_cast<float>(told(2)));
    if (told_[3] >= 0) mesh_.passage.push_back(static_cast<int>(told(3)));
    if (told_[4] >= 0) mesh_.material.push_back(material_of(file_, told(4)));
    if (told_[5] >= 0) mesh_.wetness.push_back(static_cast<float>(told(5)));
  }

  std::string file_;
  Mesh mesh_;
  std::vector<int> place_, told_;  // columns of x y z; of what is told of a face
  int corners_ = -1;
};

}  // namespace

void write_mesh(const std::string& file, const Mesh& mesh) {
  PlyWriter out(file);
  out.add(mesh, all_vertices(mesh));
  out.close();
}

Mesh read_mesh(const std::string& file) {
  if (file.ends_with(".obj")) return read_obj(file);
  Rows rows(file);
  read_ply(file, {[&](const PlyElement& e) { rows.begin(e); },
                  [&](const PlyElement& e, const std::vector<std::vector<double>>& row) { rows.row(e, row); }});
  return rows.take();
}

}  // namespace adit
