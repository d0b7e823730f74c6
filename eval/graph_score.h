// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"
#include "eval/grid_error.h"
#include "eval/metric_list.h"
#include "eval/passage_map.h"

#include <string>
#include <vector>

namespace adit {

/// The graph of the map's free space (eval/junction_graph.h) against the mine's own:
///   junctions_true    junctions of the mine where three passages or more meet that the graph of the true section shows too
///   junctions_found, junction_recall; junction_precision: junctions of the map's graph that are a junction of the mine
///   passages_true     passages of the mine that were swept from end to end
///   passages_found    those that free cells of the map lead through, along them; passage_recall; broken_connections: the rest
///   passage_precision edges of the map's graph that run along a passage of the mine
///   path_ratio, path_ratio_worst   shortest way in the map over that in the true section, between junctions: median, farthest from 1
///   unreachable       pairs of junctions that have a way in the section and none in the map
/// @param cells   of the map, over those of the section
/// @param X_WM    how M is laid on W; junctions are laid at their own height
void add_graph(const MetricList& list, const World& world, const PassageMap& passages, const TrueSection& section,
               const std::vector<Grid::Cell>& cells, const Pose& X_WM, const ScoreSettings& settings,
               const std::string& why);

}  // namespace adit
