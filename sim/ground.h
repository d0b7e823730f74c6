// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"
#include "sim/vehicle.h"

#include <optional>

namespace adit {

/// Height of the floor at a point in plan, the highest where there are several; none where there is no floor.
/// @param floor  what floor_of gives
std::optional<double> floor_height_m(const Mesh& floor, const Vec2& p_W);

/// Where a vehicle's wheels stand on the floor, B's origin at p_W: pitch and roll by the heights under the wheels.
/// @throws Error where there is no floor under a wheel or a corner of the solid hull: the place is rock or outside
Pose stand_on(const Mesh& floor, const Vehicle& vehicle, const Vec2& p_W, double yaw_rad);

}  // namespace adit
