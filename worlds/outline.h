// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/drift.h"
#include "worlds/lattice.h"
#include "worlds/polygons.h"

#include <vector>

namespace adit {

/// The void of a mine in plan, before roughness.
struct Outline {
  Lattice depth;             // signed distance from the ribs near them, negative in the void
  std::vector<int> nearest;  // (nodes of depth) the passage whose void a node is in or nearest to, -1 far from all
  std::vector<Loop> loops;   // void to the left; exactly one runs counter-clockwise, the outer one: it comes first
};

/// Unites the drifts and rounds the corners of the rock by corner_radius_m: rock is kept where a disc of this radius
/// fits into it (the morphological opening; exact distances on a lattice of 0.2 m: straight ribs are good to some
/// millimetres, corners to some centimetres).
Outline outline_of(const std::vector<Drift>& drifts, double corner_radius_m);

/// Signed distance from the ribs of a void that is given, negative within, up to 8 m either way.
Lattice depth_of(const std::vector<Polygon>& polygons, double corner_radius_m);
/// The outline of such a void, whose passages are the drifts.
Outline outline_of(const Lattice& depth, const std::vector<Drift>& drifts, double corner_radius_m);

/// The passage nearest to a point in or near the void.
int passage_at(const Outline& outline, const Vec2& p);

}  // namespace adit
