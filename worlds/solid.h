// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "worlds/lattice.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace adit {

/// A closed body, its faces counter-clockwise seen from outside of it.
struct Solid {
  std::vector<Vec3> vertex;
  std::vector<std::array<std::uint32_t, 3>> face;
  Material material = Material::timber;

  double volume_m3() const;
  /// Every side joins two faces that run it in opposite directions, and no face has its corners on one line (exact).
  bool closed() const;
};

/// Rings of equally many points joined one to the next; the first and the last, which must be convex, closed by fans.
/// Seen from the last ring towards the first, points run counter-clockwise.
Solid loft(const std::vector<std::vector<Vec3>>& rings);
/// A box whose frame stands at X_WO, from -half to +half.
Solid box(const Pose& X_WO, const Vec3& half);
/// A tube of n sides about a line.
Solid tube_along(const std::vector<Vec3>& line, double radius_m, int sides);
/// A convex polygon, counter-clockwise, between two heights over the plan.
Solid slab(const Loop& polygon, const std::function<double(const Vec2&)>& bottom_z,
           const std::function<double(const Vec2&)>& top_z);

/// A rectangle about a point: `along` half_along_m either way, and half_across_m beside it; counter-clockwise.
Loop rectangle(const Vec2& middle, const Vec2& along, double half_along_m, double half_across_m);
/// A regular polygon.
Loop regular(const Vec2& middle, double radius_m, int sides, double turned_rad);

/// A place of the plan with floor and roof over it.
struct LevelPoint {
  Vec2 p;
  double floor_z, roof_z;
};

/// What a polygon cuts out of the plan's triangles.
struct LevelPatch {
  std::vector<LevelPoint> vertex;
  std::vector<std::vector<std::uint32_t>> piece;  // convex, counter-clockwise

  double floor_high() const;
  double floor_low() const;
  double roof_low() const;
};

/// The body over a patch between two heights, each a function of the place: exactly as the floor and roof are over the
/// patch, where it is told to follow them. None where it would be thinner than a centimetre somewhere.
std::optional<Solid> column(const LevelPatch& patch, const std::function<double(const LevelPoint&)>& bottom_z,
                            const std::function<double(const LevelPoint&)>& top_z);

}  // namespace adit
