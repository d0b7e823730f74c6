// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/lattice.h"

#include <array>
#include <cstdint>
#include <vector>

namespace adit {

/// A region of the plan in triangles, counter-clockwise. The first vertices are those of the loops, in their order.
struct PlanMesh {
  std::vector<Vec2> vertex;
  std::vector<std::array<std::uint32_t, 3>> face;
};

/// The constrained Delaunay triangulation of what lies to the left of the loops, with more points inside (those that
/// lie outside are left out). Error where loops cross.
PlanMesh triangulate(const std::vector<Loop>& loops, const std::vector<Vec2>& points);

}  // namespace adit
