// SPDX-License-Identifier: BSD-3-Clause
#include "base/mine_part.h"

#include "base/error.h"

namespace adit {

void append(const MinePart& part, Mesh& mesh) {
  for (size_t v = 0; v < part.vertex_id.size(); ++v) {
    ADIT_CHECK(part.vertex_id[v] <= mesh.vertex.size());
    if (part.vertex_id[v] == mesh.vertex.size()) mesh.vertex.push_back(part.mesh.vertex[v]);
  }
  const Mesh& m = part.mesh;
  for (const auto& f : m.face) mesh.face.push_back({part.vertex_id[f[0]], part.vertex_id[f[1]], part.vertex_id[f[2]]});
  mesh.label.insert(mesh.label.end(), m.label.begin(), m.label.end());
  mesh.part.insert(mesh.part.end(), m.part.begin(), m.part.end());
  mesh.reflectivity.insert(mesh.reflectivity.end(), m.reflectivity.begin(), m.reflectivity.end());
  mesh.passage.insert(mesh.passage.end(), m.passage.begin(), m.passage.end());
  mesh.material.insert(mesh.material.end(), m.material.begin(), m.material.end());
  mesh.wetness.insert(mesh.wetness.end(), m.wetness.begin(), m.wetness.end());
}

}  // namespace adit
