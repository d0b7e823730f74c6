// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/route.h"
#include "base/trajectory.h"
#include "base/world.h"
#include "sim/vehicle.h"

#include <functional>
#include <vector>

namespace adit {

/// Ground z = height(x, y) over [low, high], in squares of about cell_m, each two triangles; no ribs, no roof.
World terrain_world(const Vec2& low, const Vec2& high, double cell_m, const std::function<double(const Vec2&)>& height);

/// A wall across x, facing both ways, 2 m high from the height z_m.
void add_wall(World& world, double x_m, double y_low_m, double y_high_m, double z_m = 0);

/// A route through the points, its corners rounded with arcs of radius_m (0: sharp), sampled every 0.25 m.
Route route_through(const std::vector<Vec2>& corners, double radius_m);

/// Along x from from_m to turn_at_m, a three-point turn of arcs of 60 degrees, and back.
Route three_point_route(double from_m, double turn_at_m, double radius_m);

/// Greatest distance of B's origin from the route's line.
double cross_track_m(const Trajectory& path, const Route& route);

}  // namespace adit
