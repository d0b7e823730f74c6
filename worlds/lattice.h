// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <vector>

namespace adit {

/// Numbers on the nodes of a square lattice in plan: node (i, j) stands at origin + (i, j) * cell_m.
struct Lattice {
  double cell_m = 0;
  Vec2 origin = Vec2::Zero();
  int width = 0, height = 0;
  std::vector<float> value;  // (height x width)

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
  Vec2 node(int i, int j) const { return origin + cell_m * Vec2(i, j); }
  /// Bilinear; the border's value outside.
  double at(const Vec2& p) const;
};

/// A closed line; the part where the field was below the level lies to its left.
using Loop = std::vector<Vec2>;

/// The closed lines on which the field has a level, lowest first (marching squares; two opposite corners below the
/// level are held to be joined). Nodes on the lattice's border must be above the level.
std::vector<Loop> contours(const Lattice& field, double level);

/// Area to the left: > 0 for a loop that runs counter-clockwise.
double enclosed_area(const Loop& loop);

}  // namespace adit
