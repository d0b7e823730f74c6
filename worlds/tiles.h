// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/outline.h"
#include "worlds/plan.h"

#include <vector>

namespace adit {

/// Where a passage is cut between two tiles: straight across, from a column of one rib to a column of the other.
struct Cut {
  struct End {
    size_t loop, column;
  };
  size_t passage;
  End left, right;  // seen from the passage's node a to its node b
};

/// Columns of one rib, followed by a cut to the first column of the run that comes next round a rim.
struct Run {
  size_t loop, first, count;  // columns first, first + 1, ... of the loop, round its end
  int cut = -1;               // -1: the run is a whole loop
  bool from_left = false;     // the cut is crossed from its left end
};

/// A piece of a mine: the passages about some of its junctions, as far as to the cuts.
struct Tile {
  std::vector<std::vector<Run>> rims;  // void to the left
  std::vector<size_t> passages;        // whose node a is in it
  Frame2 frame;                        // of all that is in it, roughness too
};

/// A mine's plan in tiles.
struct Tiling {
  std::vector<Loop> ribs;  // (loops x columns) the ribs' columns, even steps along each loop
  std::vector<Cut> cuts;
  std::vector<Tile> tiles;                          // from west to east, each column of them from south to north
  std::vector<std::pair<size_t, size_t>> tiles_of;  // (passages) those of its ends a and b
  std::vector<int> cut_of;                          // (passages) the one in it, -1 none
};

/// Cuts a mine into squares of `tile_m`, or leaves it in one piece (0). Where a passage cannot be cut straight across,
/// two tiles become one.
/// @param ribs  the outline's loops
Tiling tile_plan(const MinePlan& plan, const Workings& workings, const std::vector<Loop>& ribs, double tile_m,
                 double edge_m);

}  // namespace adit
