// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/grid.h"

#include <string>
#include <vector>

namespace adit {

struct RibLineSettings {
  double least_m2 = 2;        // rings of less area are specks
  double tolerance_m = 0.04;  // points nearer to the line are left out
};

/// Where free space ends, as closed rings in M: the outer rim of each part of it counter-clockwise, what stands in it
/// (pillars, and rock that no beam went behind) clockwise. By marching squares on the log odds, clipped to what one sure
/// cell has, so that corners lie between the cells as the odds say; rings sorted by area, the largest first.
/// Source: Lorensen and Cline, SIGGRAPH 1987, in the plane; where two free cells touch at a corner they are apart.
std::vector<std::vector<Vec2>> rib_lines(const Grid& grid, const RibLineSettings& settings = {});

/// FILE.geojson: a Polygon for each part of free space, pillars as its holes, as worlds/ reads plans; FILE.dxf: layers
/// VOID and PILLARS. Metres in M.
void write_rib_lines(const std::string& file, const std::vector<std::vector<Vec2>>& rings);

}  // namespace adit
