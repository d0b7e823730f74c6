// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "worlds/outline.h"
#include "worlds/terrain.h"
#include "worlds/tiles.h"

#include <cstdint>
#include <functional>
#include <map>
#include <vector>

namespace adit {

/// The surface of a tile's void, open at the cuts.
struct Shell {
  Mesh mesh;
  /// What the tile has in common with that on a cut's other side: floor, roof and the rows between of the column at the
  /// cut's left end, the same of its right end, then floor and roof of the points between from left to right.
  std::map<int, std::vector<std::uint32_t>> seams;
  size_t levels = 0;  // faces 2 k and 2 k + 1 are floor and roof over triangle k of the plan, for k < levels
  struct Piece {
    double volume_m3 = 0;  // by how much it lifts the floor's faces, or those of the roof
    Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  };
  std::map<int, Piece> pieces = {};  // rubble, cavities, scars, by their numbers
};

/// What of a mine is the same for all of its tiles.
struct ShellPlan {
  const Tiling& tiling;
  const Workings& workings;
  std::function<bool(const Vec2&)> capped;  // where a rib is not rock: the plan was cut off, or a wall stands
  double edge_m;
  int rows;  // of faces from floor to roof; even
  std::uint64_t seed;
};

/// Rows of faces for a height.
int rows_of(double height_m, double edge_m);

/// Floor and roof over one triangulation of the plan, ribs as rows of quads between their outlines. Ribs are rough as a
/// field in space; towards floor and roof their offset becomes that of mid height, so that the three meet in one line.
/// Tiles meet in the same vertices, whatever their order.
/// @param outline     a window that shows the tile's frame
/// @param volume_m3   (passages) each one's share of the void grows: what lies between its floor and its roof, and
///                    between that and its ribs
/// @param mid_height  (loops x columns) the ribs at mid height: the tile's columns are written
Shell make_shell(const ShellPlan& plan, const Tile& tile, const Outline& outline, const Terrain& terrain,
                 std::vector<double>& volume_m3, std::vector<Loop>& mid_height);

}  // namespace adit
