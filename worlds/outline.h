// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/drift.h"
#include "worlds/lattice.h"
#include "worlds/polygons.h"

#include <vector>

namespace adit {

/// A part of the plan.
struct Frame2 {
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  bool meets(const Frame2& o, double margin) const {
    return (low.array() - margin <= o.high.array()).all() && (o.low.array() - margin <= high.array()).all();
  }
};

/// The void of a mine in plan, before roughness, or what a window shows of it.
struct Outline {
  Lattice depth;             // signed distance from the ribs near them, negative in the void
  std::vector<int> nearest;  // (nodes of depth) the passage whose void a node is in or nearest to, -1 far from all
};

/// What unites the drifts of a mine and rounds the corners of the rock by corner_radius_m: rock is kept where a disc of
/// this radius fits into it (the morphological opening; exact distances on a lattice of 0.2 m: straight ribs are good to
/// some millimetres, corners to some centimetres). Walls are built into that. All of it depends on what lies near, so
/// that windows show the same numbers as the whole.
class Workings {
 public:
  Workings(std::vector<Drift> drifts, std::vector<Wall> walls, double corner_radius_m);
  /// A void that is given by its depth, whose passages are the drifts. It has no windows but the whole.
  Workings(Lattice depth, std::vector<Drift> drifts, double corner_radius_m);

  const std::vector<Drift>& drifts() const { return drifts_; }
  const std::vector<Wall>& walls() const { return walls_; }
  bool has_windows() const { return given_.value.empty(); }
  Outline whole() const;
  /// True for points up to 3 m beyond the frame.
  Outline window(const Frame2& frame) const;
  /// The ribs: void to the left; exactly one runs counter-clockwise, the outer one: it comes first. They are traced
  /// block by block: memory is that of the lines.
  std::vector<Loop> ribs() const;

 private:
  Outline nodes(int i0, int j0, int i1, int j1) const;

  std::vector<Drift> drifts_;
  std::vector<Wall> walls_;
  double radius_;
  Lattice given_, frame_;            // frame_ has no values
  std::vector<Frame2> drift_frame_;  // as far as their ribs
};

/// Signed distance from the ribs of a void that is given, negative within, up to 8 m either way.
Lattice depth_of(const std::vector<Polygon>& polygons, double corner_radius_m);

/// The passage nearest to a point in or near the void.
int passage_at(const Outline& outline, const Vec2& p);

}  // namespace adit
