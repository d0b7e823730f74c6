// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "base/polyline.h"

#include <optional>
#include <utility>
#include <vector>

namespace adit {

/// The rims of a mine's floor in plan, each a closed ring: the outer walls and, inside of them, the pillars. Where the
/// mesh has no labels, faces whose normal looks down are the floor. Corners nearer than tolerance_m to the line are
/// left out.
std::vector<std::vector<Vec2>> plan_outline(const Mesh& mesh, double tolerance_m = 0.03);

/// The part of a closed ring inside of a box (Sutherland and Hodgman 1974): where the ring leaves and comes back, the
/// parts are joined along the box's border. Good for areas.
std::vector<Vec2> clipped_ring(const std::vector<Vec2>& ring, const Vec2& low, const Vec2& high);
/// The part of a stretch inside of a box, if any. Good for lines.
std::optional<std::pair<Vec2, Vec2>> clipped_stretch(Vec2 a, Vec2 b, const Vec2& low, const Vec2& high);

/// Where a mesh meets the upright plane through `origin` along the unit vector `along`: stretches as (way along,
/// height), metres, of those faces that come within `reach_m` of the origin in plan.
std::vector<std::pair<Vec2, Vec2>> upright_section(const Mesh& mesh, const Vec2& origin, const Vec2& along,
                                                   double reach_m);

/// Label of a face, or what its normal says where the mesh has none: roof looks up into the rock, floor down.
Label label_of(const Mesh& mesh, size_t face);

}  // namespace adit
