// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <cstdint>
#include <vector>

namespace adit {

/// Cells of a plane, row by row: 1 where one may pass.
struct FreeCells {
  double cell_m = 0;
  int width = 0, height = 0;
  std::vector<std::uint8_t> free;  // (height x width)

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
};

/// The same in larger cells, free where half of them was.
FreeCells coarsened(const FreeCells& cells, int factor);
/// Distance of each cell from the nearest that is not free, in metres (chamfer 3-4: at most 6 % off); the border counts as not free.
std::vector<float> clearance_m(const FreeCells& cells);

/// Middle lines of free space, and where they meet.
struct JunctionGraph {
  struct Edge {
    int a, b;                // nodes; the same one for a ring without a junction
    std::vector<Vec2> line;  // metres from the corner of cell (0, 0), from a to b
    double length_m;
  };
  std::vector<Vec2> node;   // metres, as above
  std::vector<int> degree;  // (node) 1: a dead end; 3 and more: a junction
  std::vector<Edge> edge;
};

/// Ways narrower than 0.6 m are none. Islands smaller than island_m2 are filled, and so are free parts smaller than it.
/// Thinned (Zhang and Suen, CACM 27(3), 1984); dead ends that reach out less than 1.5 m beyond the clearance of the
/// junction that they leave are no ways; junctions closer than 0.8 of their clearances together are one.
JunctionGraph junction_graph(const FreeCells& cells, double island_m2);

/// Shortest way from one cell to all others over free cells, in metres, sideways and across corners; +inf where none goes.
std::vector<float> ways_from(const FreeCells& cells, size_t from);

}  // namespace adit
