// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"
#include "eval/grid_error.h"
#include "eval/metric_list.h"

#include <string>
#include <vector>

namespace adit {

/// Connected sets of cells that are not free, corners counting as contact (so free space connects by sides alone).
struct Islands {
  std::vector<int> of;         // (cells) island, -1 where the cell is free
  std::vector<size_t> cells;   // (islands)
  std::vector<char> enclosed;  // (islands) free space goes all round: it does not touch the border
};
Islands islands_of(const std::vector<char>& free, int width, int height);

/// loops_true, loops_found: islands of at least pillar_m2 that free space goes round, in the true section and in the
/// map's grid. pillars_true: pillars of the mine each of which alone is such an island of the true section;
/// pillars_found: those of them that are so in the grid too. false_connections: ways through these pillars: inside of a
/// pillar's outline the cells that are not free fall into more than one part (a part counts from a quarter of pillar_m2
/// on); all free counts as one. pillars_split: pillars through which such a way goes; pillars_merged: those that share
/// their island of the map's grid with another, or lie on one that free space does not go round.
/// pillar_area_error_percent: mean over the pillars found of the difference of their islands' areas, absolute;
/// extraction_ratio, extraction_ratio_true: free area over free area and islands.
/// @param X_WM  how M is laid on W
/// @return each pillar of pillars_true
std::vector<PillarScore> add_topology(const MetricList& list, const World& world, const TrueSection& section,
                                      const std::vector<Grid::Cell>& cells, const Pose& X_WM, double height_W_m,
                                      double pillar_m2, const std::string& why);

}  // namespace adit
