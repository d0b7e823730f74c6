// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"

#include <cstdint>
#include <vector>

namespace adit {

/// A piece of a mine's mesh, where a mine is too large to be held as a whole. Pieces come one after the other; they meet
/// in vertices of the same id, and together they are the closed mesh.
struct MinePart {
  struct Frame {
    size_t part;
    Vec2 low, high;  // of its vertices, in plan
  };

  size_t index = 0;
  Mesh mesh;                             // faces name its own vertices
  std::vector<std::uint32_t> vertex_id;  // (vertices) in the mine; what no earlier part has is numbered on, in order
  Frame frame = {};
  std::vector<Frame> later;  // of the parts to come that this one may touch
};

/// Adds a part to the mesh of those before it.
void append(const MinePart& part, Mesh& mesh);

}  // namespace adit
