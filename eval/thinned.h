// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"

#include <vector>

namespace adit {

/// A mesh of fewer faces for a quick look: vertices that fall into the same cube become one, in their mean. Faces that
/// lose their area go. Roof faces come last.
struct ThinMesh {
  std::vector<Vec3> vertex;
  std::vector<float> value;  // mean of the vertices' values that are no NaN; NaN where there is none
  std::vector<std::array<std::uint32_t, 3>> face;
  size_t roof = 0;  // first face of the roof
  double cube_m = 0;
};

/// @param value      one for each vertex, or empty
/// @param most_faces that the result may have: the cube, 0.15 m at least, grows until they suffice
/// After Rossignac and Borrel, "Multi-resolution 3D approximations for rendering complex scenes", 1993.
ThinMesh thinned(const Mesh& mesh, const std::vector<float>& value, size_t most_faces);

}  // namespace adit
