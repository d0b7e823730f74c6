// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/space.h"

#include <vector>

namespace adit {

/// What stands, hangs and lies in a mine, as bodies in its void. None where it has no room: the list is empty then.
using Bodies = std::vector<Solid>;

/// A place on a passage's centre line and the way on, in plan.
struct Spot {
  Vec2 p, along;
  Vec2 left() const { return {-along.y(), along.x()}; }
  Vec2 beside(double left_m) const { return p + left_m * left(); }
};

/// A round prop from floor to roof, with a cap block.
Bodies post(const Space& space, const Vec2& p, const Vec2& along, double radius_m);
/// A bar across under the roof, on two legs; from `right_m` (< 0) to `left_m` beside the spot.
Bodies crossbar(const Space& space, const Spot& at, double right_m, double left_m);
/// A stack of timbers laid crosswise, from floor to roof.
Bodies crib(const Space& space, const Vec2& p, const Vec2& along, double side_m);
/// A roof bolt's plate and head.
Bodies bolt(const Space& space, const Vec2& p, const Vec2& along);
/// One rail's length over ties whose tops are below `top_z`, between two places.
Bodies rail(const Vec2& from, const Vec2& to, double from_z, double to_z);
/// A sleeper half bedded in the floor; its top comes back.
Bodies tie(const Space& space, const Spot& at, double half_length_m, double* top_z);
/// A length of belt conveyor: belt, return belt, stringers and legs.
Bodies belt(const Space& space, const Spot& middle, double length_m);
/// A mine car on four wheels, its wheels at `rail_z` over the spot.
Bodies car(const Spot& at, double wheel_z, double pitch);
/// A beam that lies from the floor at one place up to another.
Bodies fallen_beam(const Vec3& from, const Vec3& to);
/// A loose block with flat sides, on the floor.
Bodies loose_block(const Space& space, const Loop& footprint, double height_m, const Vec2& lean);
struct StoppingBodies {
  Bodies wall, door;
};
/// A wall of blocks across, its courses as wide as the ribs let them, with an opening for a door; and the door. None where
/// a course would reach further than widest_m to a side: there a wall would close more than one passage.
StoppingBodies stopping(const Space& space, const Spot& at, double door_left_m, double rib_gap_m, double widest_m);

/// How far to either side of a spot nothing is met at some heights over the floor, as shares of the height.
double free_m(const Space& space, const Spot& at, double sign, const std::vector<double>& shares);

}  // namespace adit
