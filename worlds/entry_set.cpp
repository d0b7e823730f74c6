// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/entry_set.h"

#include "base/rng.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double face_beyond_m = 1;   // a dead end's face lies this far beyond its node
constexpr double turnout_widths = 3;  // how far from a junction its turnout leaves, in widths of the passage
enum Address : std::uint64_t { crosscut_fate = 20, crosscut_share, crosscut_side, turnout_drawn, turnout_pair };

// The piece of a straight passage that ends `from_m` after node `at`; the rest goes to the end of the list.
int cut_at(MinePlan& plan, size_t passage, int at, double from_m) {
  PlanPassage& p = plan.passages[passage];
  const int other = p.a == at ? p.b : p.a;
  const Vec2 way = (plan.nodes[other] - plan.nodes[at]).normalized();
  const double width = p.width_m;
  const int node = add_node(plan, plan.nodes[at] + from_m * way);
  plan.passages[passage] = {at, node, width, {plan.nodes[at], plan.nodes[node]}};
  join(plan, node, other, width);
  return node;
}

// The passages at a node that are straight and long enough to be cut for a turnout.
std::vector<size_t> long_ways(const MinePlan& plan, const std::vector<std::vector<size_t>>& at, size_t node) {
  std::vector<size_t> found;
  for (size_t i : at[node]) {
    const PlanPassage& p = plan.passages[i];
    const double length = (p.line.back() - p.line.front()).norm();
    if (p.line.size() == 2 && length > (turnout_widths + 2) * p.width_m && !plan.cut[p.a] && !plan.cut[p.b])
      found.push_back(i);
  }
  return found;
}

Vec2 heading(const MinePlan& plan, const PlanPassage& p, int from) {
  return (plan.nodes[p.a == from ? p.b : p.a] - plan.nodes[from]).normalized();
}

}  // namespace

int add_node(MinePlan& plan, const Vec2& p) {
  plan.nodes.push_back(p);
  plan.cut.push_back(0);
  return static_cast<int>(plan.nodes.size()) - 1;
}

void join(MinePlan& plan, int a, int b, double width_m) {
  plan.passages.push_back({a, b, width_m, {plan.nodes[a], plan.nodes[b]}});
}

Vec2 EntrySet::at(size_t entry, double s_m) const {
  return origin + s_m * along + offset_m[entry] * Vec2(-along.y(), along.x());
}

EntrySet entry_set(const Vec2& origin, const Vec2& along, double width_m, std::vector<double> offset_m) {
  EntrySet set{origin, along, width_m, std::move(offset_m)};
  set.marks.resize(set.offset_m.size());
  return set;
}

EntrySet branch(MinePlan& plan, EntrySet& parent, int side, double s_m, double width_m, std::vector<double> offset_m) {
  const auto [right, left] = std::minmax_element(parent.offset_m.begin(), parent.offset_m.end());
  const auto outer = static_cast<size_t>((side > 0 ? left : right) - parent.offset_m.begin());
  const Vec2 along = side * Vec2(-parent.along.y(), parent.along.x());
  // The child's left is against its parent's way where it leaves to the left.
  if (side > 0)
    for (double& x : offset_m) x = -x;
  EntrySet child = entry_set(parent.at(outer, s_m), along, width_m, offset_m);
  for (size_t e = 0; e < offset_m.size(); ++e) {
    const int node = node_at(plan, parent, outer, s_m + (side > 0 ? -offset_m[e] : offset_m[e]));
    child.marks[e].push_back({0, node});
  }
  return child;
}

int node_at(MinePlan& plan, EntrySet& set, size_t entry, double s_m) {
  for (const EntrySet::Mark& m : set.marks[entry])
    if (std::abs(m.s_m - s_m) < 0.5 * set.width_m) return m.node;
  set.marks[entry].push_back({s_m, add_node(plan, set.at(entry, s_m))});
  return set.marks[entry].back().node;
}

void drive_entries(MinePlan& plan, EntrySet& set) {
  for (auto& entry : set.marks) {
    std::sort(entry.begin(), entry.end(),
              [](const EntrySet::Mark& a, const EntrySet::Mark& b) { return a.s_m < b.s_m; });
    for (size_t i = 1; i < entry.size(); ++i) join(plan, entry[i - 1].node, entry[i].node, set.width_m);
  }
}

std::vector<double> scattered(int n, double spacing_m, double sd_m, std::uint64_t seed, std::uint64_t which) {
  std::vector<double> x(n, 0.0);
  for (int i = 1; i < n; ++i)
    x[i] = x[i - 1] + spacing_m + sd_m * std::clamp(normal(seed, Draw::world_layout, which, i), -2.0, 2.0);
  return x;
}

void drive_crosscut(MinePlan& plan, int a, int b, double width_m, const CrosscutShares& shares, std::uint64_t seed,
                    std::uint64_t which) {
  const double drawn = uniform(seed, Draw::world_layout, crosscut_fate, which);
  if (drawn < shares.missing) return;
  const Vec2 from = plan.nodes[a], way = (plan.nodes[b] - from).normalized();
  const double length = (plan.nodes[b] - from).norm(), closed_m = shares.stopping_m + 2 * face_beyond_m;
  const double free = length - 2 * width_m - closed_m;
  const bool dead = drawn < shares.missing + shares.dead_end;
  const bool closed = drawn < shares.missing + shares.dead_end + shares.stopping;
  if (!closed || free <= 0) return join(plan, a, b, width_m);
  const double share = uniform(seed, Draw::world_layout, crosscut_share, which);
  const double first = width_m + free * (dead ? share : 0.3 + 0.4 * share);
  const bool from_b = dead && uniform(seed, Draw::world_layout, crosscut_side, which) < 0.5;
  const int end = add_node(plan, from_b ? Vec2(plan.nodes[b] - first * way) : Vec2(from + first * way));
  join(plan, from_b ? b : a, end, width_m);
  if (dead) return;
  const int other = add_node(plan, plan.nodes[end] + closed_m * way);
  join(plan, other, b, width_m);
  plan.walls.push_back({end, other, shares.stopping_m});
}

void add_turnouts(MinePlan& plan, double share, std::uint64_t seed) {
  if (share <= 0) return;
  std::vector<std::vector<size_t>> at(plan.nodes.size());
  for (size_t i = 0; i < plan.passages.size(); ++i)
    for (int node : {plan.passages[i].a, plan.passages[i].b}) at[node].push_back(i);
  std::vector<char> used(plan.passages.size(), 0);
  for (size_t n = 0; n < at.size(); ++n) {
    if (at[n].size() < 3 || uniform(seed, Draw::world_layout, turnout_drawn, n) >= share) continue;
    const std::vector<size_t> ways = long_ways(plan, at, n);
    const size_t first = random_bits(seed, Draw::world_layout, turnout_pair, n);
    for (size_t k = 0; k < ways.size(); ++k) {
      const size_t i = ways[(first + k) % ways.size()], j = ways[(first + k + 1) % ways.size()];
      const int node = static_cast<int>(n);
      if (i == j || used[i] || used[j] ||
          std::abs(heading(plan, plan.passages[i], node).dot(heading(plan, plan.passages[j], node))) > 0.6)
        continue;
      const double width = std::min(plan.passages[i].width_m, plan.passages[j].width_m);
      const double reach = turnout_widths * std::max(plan.passages[i].width_m, plan.passages[j].width_m);
      used[i] = used[j] = 1;
      join(plan, cut_at(plan, i, node, reach), cut_at(plan, j, node, reach), width);
      break;
    }
  }
}

}  // namespace adit
