// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/grid.h"
#include "eval/metric_list.h"
#include "eval/true_scans.h"

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// What a cell of a section truly is.
enum class CellTruth : std::uint8_t { unseen, free, wall };

/// The section of a mine that the mapping laser's plane really swept, in cells of M that lie as a grid's do.
struct TrueSection {
  double cell_m = 0;
  Vec2 origin = Vec2::Zero();  // a whole number of cells from the grid's origin
  int width = 0, height = 0;
  std::vector<CellTruth> cell;  // (height x width)

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
};

/// Free: the centre lies in the fan of a scan, between two neighbouring beams that both met the mine within range (cut
/// back to the nearer end where the ends are more than half a metre apart). Wall: a beam ends there, on neither floor
/// nor roof; wins over free. It covers the grid and all that was swept.
/// @param X_WM  how M is laid on W; points are dropped onto M's xy plane along its z
TrueSection true_section(const Grid& grid, const Pose& X_WM, const TrueScans& scans, size_t laser, const Mesh& mesh);

/// The cells of a map's grid over the cells of a section; unknown outside of the grid.
std::vector<Grid::Cell> cells_over(const TrueSection& section, const Grid& grid);

/// iou_free (of the cells free in map and truth), precision_, recall_, f_occupied (wall cells, a neighbour counts as
/// the same), brier (mean squared error of the map's probability over cells of known truth that it has seen).
void add_grid(const MetricList& list, const TrueSection& section, const Grid& grid, const std::string& why);

}  // namespace adit
