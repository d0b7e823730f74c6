// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <cstdint>
#include <vector>

namespace adit {

/// Numbers on the nodes of a square lattice in plan, or of a window of it whose lower left node is (i0, j0) of the whole:
/// node (i, j) of the window stands at origin + (i0 + i, j0 + j) * cell_m.
struct Lattice {
  double cell_m = 0;
  Vec2 origin = Vec2::Zero();
  int width = 0, height = 0;
  std::vector<float> value;  // (height x width)
  int i0 = 0, j0 = 0;

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
  Vec2 node(int i, int j) const { return origin + cell_m * Vec2(i0 + i, j0 + j); }
  /// Bilinear; the border's value outside.
  double at(const Vec2& p) const;
};

/// A closed line; the part where the field was below the level lies to its left.
using Loop = std::vector<Vec2>;

/// The closed lines on which the field has a level, lowest first (marching squares; two opposite corners below the
/// level are held to be joined). Nodes on the lattice's border must be above the level.
std::vector<Loop> contours(const Lattice& field, double level);

/// A contour's way through one cell, from one side of the cell to another. Sides have numbers that are the same in every
/// window of a lattice.
struct Link {
  std::uint64_t from, to;
  Vec2 at, next;  // where it crosses them
};
/// The ways through the cells whose lower left node is one of [i_begin, i_end) x [j_begin, j_end) of the window.
void add_links(const Lattice& field, double level, int i_begin, int i_end, int j_begin, int j_end,
               std::vector<Link>& links);
/// The closed lines that all links of a lattice make up, lowest first.
std::vector<Loop> join_links(std::vector<Link> links);

/// Area to the left: > 0 for a loop that runs counter-clockwise.
double enclosed_area(const Loop& loop);

}  // namespace adit
