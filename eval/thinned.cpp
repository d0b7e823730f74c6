// SPDX-License-Identifier: BSD-3-Clause
#include "eval/thinned.h"

#include "eval/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

namespace adit {

namespace {

using Face = std::array<std::uint32_t, 3>;

constexpr size_t most_clusters = 1 << 21;  // three indices in one number

struct Clusters {
  std::vector<std::uint32_t> of_vertex;
  size_t count = 0;
};

Clusters cluster(const Mesh& mesh, double cube_m) {
  std::unordered_map<std::uint64_t, std::uint32_t> known;
  known.reserve(mesh.vertex.size() / 4);
  Clusters clusters;
  clusters.of_vertex.reserve(mesh.vertex.size());
  for (const Vec3& p : mesh.vertex) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis)
      key = key << 21 | (static_cast<std::uint64_t>(std::floor(p[axis] / cube_m) + (1 << 20)) & 0x1fffff);
    clusters.of_vertex.push_back(known.try_emplace(key, static_cast<std::uint32_t>(known.size())).first->second);
  }
  clusters.count = known.size();
  return clusters;
}

// Two faces for each square of a surface, if it lay along the cubes.
double first_cube(const Mesh& mesh, size_t most_faces) {
  double area = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f) area += mesh.area(f);
  return std::max(0.15, std::sqrt(2 * area / static_cast<double>(most_faces)));
}

// Begins with its smallest corner; the turn stays.
Face turned(Face f) {
  std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
  return f;
}

// The faces that are left, each once, roof last; `roof` is the first of those.
std::vector<Face> faces_of(const Mesh& mesh, const Clusters& clusters, size_t& roof) {
  std::vector<Face> rest, above;
  std::unordered_set<std::uint64_t> seen;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    Face face;
    for (int k = 0; k < 3; ++k) face[k] = clusters.of_vertex[mesh.face[f][k]];
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
    face = turned(face);
    const std::uint64_t key =
        static_cast<std::uint64_t>(face[0]) << 42 | static_cast<std::uint64_t>(face[1]) << 21 | face[2];
    if (!seen.insert(key).second) continue;
    (is_roof(label_of(mesh, f)) ? above : rest).push_back(face);
  }
  roof = rest.size();
  rest.insert(rest.end(), above.begin(), above.end());
  return rest;
}

}  // namespace

ThinMesh thinned(const Mesh& mesh, const std::vector<float>& value, size_t most_faces) {
  ThinMesh thin;
  if (mesh.face.empty()) return thin;
  Clusters clusters;
  for (thin.cube_m = first_cube(mesh, most_faces);; thin.cube_m *= 1.15) {
    clusters = cluster(mesh, thin.cube_m);
    if (clusters.count >= most_clusters) continue;
    thin.face = faces_of(mesh, clusters, thin.roof);
    if (thin.face.size() <= most_faces) break;
  }
  thin.vertex.assign(clusters.count, Vec3::Zero());
  thin.value.assign(clusters.count, 0);
  std::vector<int> n(clusters.count, 0), valued(clusters.count, 0);
  for (size_t v = 0; v < mesh.vertex.size(); ++v) {
    const std::uint32_t c = clusters.of_vertex[v];
    thin.vertex[c] += mesh.vertex[v];
    ++n[c];
    if (value.empty() || std::isnan(value[v])) continue;
    thin.value[c] += value[v];
    ++valued[c];
  }
  for (size_t c = 0; c < clusters.count; ++c) {
    thin.vertex[c] /= n[c];
    thin.value[c] = valued[c] ? thin.value[c] / static_cast<float>(valued[c]) : std::numeric_limits<float>::quiet_NaN();
  }
  return thin;
}

}  // namespace adit
