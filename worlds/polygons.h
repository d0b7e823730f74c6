// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/lattice.h"

#include <string>
#include <vector>

namespace adit {

/// A region of the plan: its outer ring first, then its holes; rings are not closed by a repeated point.
using Polygon = std::vector<Loop>;

/// The void of a mine as GeoJSON tells it: Polygon and MultiPolygon features, in metres, whose property "kind" is
/// "void" or missing. Features of another kind are passed over, so that plan.geojson can be read again.
/// @throws Error naming file, feature and ring: not GeoJSON, fewer than three points, rings that cross, sizes beyond 30
///         km, degrees instead of metres
std::vector<Polygon> read_polygons(const std::string& file);

/// Whether a plan's name is that of a file of polygons: its ending is another one than .json.
bool names_polygons(const std::string& plan);

}  // namespace adit
