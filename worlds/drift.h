// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/plan.h"

#include <cstdint>
#include <vector>

namespace adit {

/// A passage as it was driven: its centre line has wandered, each rib has its own distance from it.
struct Drift {
  std::vector<Vec2> line;               // (n) about every half metre
  std::vector<double> left, right;      // (n) half widths
  bool flat_a = false, flat_b = false;  // a dead end at the first, the last point
  double face_a_m = 1, face_b_m = 1;    // how far beyond that point its face lies

  double width_m() const;  // mean
};

/// A wall across a drift as it was built: upright, of even thickness.
struct Wall {
  Vec2 middle, along;      // in plan; unit, through the wall
  double thick_m, wide_m;  // wide_m ends in the rock

  /// Distance from its faces, negative within; +inf beside it.
  double distance(const Vec2& p) const;
};

/// The walls of a plan whose passages were driven so.
std::vector<Wall> walls_of(const MinePlan& plan, const std::vector<Drift>& drifts);

/// How the passages of a plan were driven, one for each, by the settings' chance. All lines that meet at a node of the
/// plan meet in one point, with one width.
std::vector<Drift> drive_passages(const MinePlan& plan, const WorldSettings& settings, std::uint64_t seed);

/// Signed distance of a point from the ribs beside piece `segment` of a drift, and from the face of a dead end near it;
/// negative inside.
double signed_distance(const Drift& drift, size_t segment, const Vec2& p);

/// Signed distance from the face of a dead end of the drift, negative towards the drift.
double beyond_end(const Drift& drift, bool at_b, const Vec2& p);

}  // namespace adit
