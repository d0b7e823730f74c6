// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "worlds/outline.h"
#include "worlds/terrain.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace adit {

/// The surface of a mine's void.
struct Shell {
  Mesh mesh;
  std::vector<Loop> mid_height;   // the ribs at mid height, void to the left; the outer one first, then pillars by id
  std::vector<double> volume_m3;  // (passages) each one's share of the void: what lies between its floor and its roof,
                                  // and between that and its ribs
};

/// Floor and roof over one triangulation of the plan, ribs as rows of quads between their outlines. Ribs are rough as a
/// field in space; towards floor and roof their offset becomes that of mid height, so that the three meet in one line.
/// `capped(p)` tells where a rib is not rock but where the plan was cut off.
Shell make_shell(const Outline& outline, const Terrain& terrain, const std::function<bool(const Vec2&)>& capped,
                 double edge_m, double height_m, std::uint64_t seed);

}  // namespace adit
