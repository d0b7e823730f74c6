// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/plan.h"

#include <vector>

namespace adit {

/// Adds a node; adds a straight passage between two nodes.
int add_node(MinePlan& plan, const Vec2& p);
void join(MinePlan& plan, int a, int b, double width_m);

/// Parallel entries that are driven together. Entry e runs along `along`, offset_m[e] to the left of it.
struct EntrySet {
  struct Mark {
    double s_m;  // along the entry
    int node;
  };
  Vec2 origin, along;
  double width_m;
  std::vector<double> offset_m;
  std::vector<std::vector<Mark>> marks = {};  // (entries) the nodes of each, in no order

  Vec2 at(size_t entry, double s_m) const;
};

EntrySet entry_set(const Vec2& origin, const Vec2& along, double width_m, std::vector<double> offset_m);
/// A set that leaves the outermost entry of another at a right angle: to the left (side 1) or right (-1), its entries at
/// `offset_m` from `s_m` on. They begin at nodes of the entry that they leave.
EntrySet branch(MinePlan& plan, EntrySet& parent, int side, double s_m, double width_m, std::vector<double> offset_m);

/// The node of an entry at s; one that is there already within half a width is used again.
int node_at(MinePlan& plan, EntrySet& set, size_t entry, double s_m);
/// Drives the entries: joins the nodes of each in their order.
void drive_entries(MinePlan& plan, EntrySet& set);

/// n values, the first at 0, by steps of `spacing` that scatter by `sd`; `which` is the address of the scatter.
std::vector<double> scattered(int n, double spacing_m, double sd_m, std::uint64_t seed, std::uint64_t which);

/// A crosscut between two nodes as chance has it: driven through, driven from one side only, closed by a stopping, or
/// left out. A closed one is cut in two by a wall.
struct CrosscutShares {
  double missing = 0, dead_end = 0, stopping = 0;
  double stopping_m = 0.4;  // thickness of the wall
};
void drive_crosscut(MinePlan& plan, int a, int b, double width_m, const CrosscutShares& shares, std::uint64_t seed,
                    std::uint64_t which);

/// Cuts off corners: from a share of the junctions a diagonal joins two passages that meet there at about a right
/// angle, where both are long enough to leave a pillar between.
void add_turnouts(MinePlan& plan, double share, std::uint64_t seed);

}  // namespace adit
