// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/worlds.h"

#include <string>
#include <vector>

namespace adit {

/// A way between two nodes of a plan.
struct PlanPassage {
  int a, b;  // nodes
  double width_m;
  std::vector<Vec2> line;  // from a to b, both included
};

/// A wall built across a passage, between two dead ends a metre to either side of it: a stopping.
struct PlanWall {
  int a, b;  // nodes of the dead ends
  double thick_m;
};

/// Centre lines with widths: one connected graph. Nodes at which the plan was cut off by a selection's border are
/// marked.
struct MinePlan {
  std::vector<Vec2> nodes;
  std::vector<char> cut;  // (nodes)
  std::vector<PlanPassage> passages;
  std::vector<PlanWall> walls = {};
};

/// The plan that the settings ask for, checked: crossings are nodes, all is connected, widths are positive.
MinePlan make_plan(const WorldSettings& settings, std::uint64_t seed);

/// The kinds.
MinePlan read_plan(const WorldSettings& settings);
MinePlan panel_plan(const PanelSettings& settings, std::uint64_t seed);
MinePlan rooms_plan(const RoomSettings& settings, std::uint64_t seed);
MinePlan district_plan(const DistrictSettings& settings, std::uint64_t seed);

/// Makes each crossing of two passages a node.
MinePlan split_crossings(MinePlan plan);

}  // namespace adit
