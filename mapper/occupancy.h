// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/grid.h"
#include "base/progress.h"
#include "base/recording.h"
#include "mapper/scan_points.h"

#include <vector>

namespace adit {

struct OccupancySettings {
  double cell_m = 0.1;
  double step_m = 0.05;  // a scan this near to the last one used says nothing new: a vehicle that stands does not vote
  double near_m = 8;     // echoes up to here are ribs; beyond they may be floor or roof and count less and less
  double no_echo_m = 4;  // a beam without echo frees so far: rock nearer than this would have been seen
  double free_odds = 0.4;  // taken off the log odds of a cell that a scan's beams cross
  double hit_odds = 0.85;  // added to those of a cell where one ends
  double most_odds = 5;    // bound of the log odds either way
};
Fields fields(OccupancySettings& s);

/// The plan of free space and ribs as the scans of one horizontal laser tell it at given poses. A scan counts once for
/// every cell: as a hit where an echo that lies on a rib ends, else as free where a beam crosses. Echoes beyond
/// points.range_max_m and mixed pixels fill nothing, beams are followed up to that range. Each beam leaves from where
/// the laser was at its instant. Parallel; the same bits on any number of threads.
/// @param X_MB one a scan
/// @return     cells that cover all that was seen; origin a multiple of cell_m
/// Source: Moravec, Elfes, "High resolution maps from wide angle sonar", ICRA 1985, in log odds.
Grid map_grid(const Scans& scans, const Mount& mount, const std::vector<Pose2>& X_MB, const OccupancySettings& settings,
              const ScanPointSettings& points = {}, const Progress& progress = {});

}  // namespace adit
