// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <vector>

namespace adit {

/// A line with the points left out that are nearer than tolerance_m to what remains (Douglas and Peucker 1973).
std::vector<Vec2> simplified(const std::vector<Vec2>& line, double tolerance_m);

/// Area within a closed ring, positive where it runs counter-clockwise.
double signed_area(const std::vector<Vec2>& ring);
/// Does a closed ring go round the point?
bool contains(const std::vector<Vec2>& ring, const Vec2& p);

}  // namespace adit
