// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "worlds/plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

std::string metres(double v) {
  const std::string text = std::to_string(v);
  return text.substr(0, text.find('.') + 3) + " m";
}

void check_panel(const PanelSettings& s) {
  const double least = 2.6;  // of a pillar, else nothing is left between its rounded corners
  const double room =
      std::min(s.entry_spacing_m, s.crosscut_spacing_m * std::sin(s.crosscut_angle_deg * std::numbers::pi / 180)) -
      4 * s.spacing_sd_m;
  if (s.width_m <= 0) throw Error("world.panel.width_m = " + metres(s.width_m) + ": must be above 0");
  if (s.width_m + least > room)
    throw Error("world.panel.width_m = " + metres(s.width_m) + ": entries and crosscuts must leave pillars of " +
                metres(least) + "; with entry_spacing_m, crosscut_spacing_m and spacing_sd_m as they are, at most " +
                metres(room - least) + " wide");
  if (s.entries == 1 && s.stub_length_m * s.stub_share <= 0 && s.crosscuts < 2)
    throw Error("world.panel.entries = 1: one entry needs crosscuts >= 2 or stubs to have any length");
}

// Offsets of `n` parallel lines, the first at 0.
std::vector<double> offsets(int n, double spacing, double sd, std::uint64_t seed, std::uint64_t which) {
  std::vector<double> x(n, 0.0);
  for (int i = 1; i < n; ++i)
    x[i] = x[i - 1] + spacing + sd * std::clamp(normal(seed, Draw::world_layout, which, i), -2.0, 2.0);
  return x;
}

struct Mark {
  double x;
  int node;
};

// The nodes of each entry, by x.
using Entries = std::vector<std::vector<Mark>>;

int add_node(MinePlan& plan, const Vec2& p) {
  plan.nodes.push_back(p);
  plan.cut.push_back(0);
  return static_cast<int>(plan.nodes.size()) - 1;
}

void join(MinePlan& plan, int a, int b, double width_m) {
  plan.passages.push_back({a, b, width_m, {plan.nodes[a], plan.nodes[b]}});
}

// A node of an entry at x; one that is there already within half a width is used again.
int node_at(MinePlan& plan, std::vector<Mark>& entry, double x, double y, double width_m) {
  for (const Mark& m : entry)
    if (std::abs(m.x - x) < 0.5 * width_m) return m.node;
  entry.push_back({x, add_node(plan, {x, y})});
  return entry.back().node;
}

void add_crosscuts(MinePlan& plan, const PanelSettings& s, const std::vector<double>& y, Entries& entries,
                   std::uint64_t seed) {
  const double lean = 1 / std::tan(s.crosscut_angle_deg * std::numbers::pi / 180);
  const std::vector<double> x = offsets(s.crosscuts, s.crosscut_spacing_m, s.spacing_sd_m, seed, 1);
  for (int gap = 0; gap + 1 < s.entries; ++gap) {
    for (double at : x) {
      const double low = at + lean * y[gap] + s.stagger * s.crosscut_spacing_m * (gap % 2);
      const double high = low + lean * (y[gap + 1] - y[gap]);
      const int a = node_at(plan, entries[gap], low, y[gap], s.width_m);
      const int b = node_at(plan, entries[gap + 1], high, y[gap + 1], s.width_m);
      join(plan, a, b, s.width_m);
    }
  }
  if (s.entries == 1)
    for (double at : x) node_at(plan, entries[0], at, y[0], s.width_m);
}

void add_stub(MinePlan& plan, const PanelSettings& s, int node, double direction, std::uint64_t which,
              std::uint64_t seed) {
  if (uniform(seed, Draw::world_layout, 2, which) >= s.stub_share) return;
  const double length = s.stub_length_m * (0.8 + 0.4 * uniform(seed, Draw::world_layout, 3, which));
  if (length < s.width_m) return;  // it would drown in its junction
  const Vec2 end = plan.nodes[node] + Vec2(direction * length, 0);
  join(plan, node, add_node(plan, end), s.width_m);
}

}  // namespace

MinePlan panel_plan(const PanelSettings& s, std::uint64_t seed) {
  check_panel(s);
  MinePlan plan;
  const std::vector<double> y = offsets(s.entries, s.entry_spacing_m, s.spacing_sd_m, seed, 0);
  Entries entries(s.entries);
  add_crosscuts(plan, s, y, entries, seed);
  for (int e = 0; e < s.entries; ++e) {
    std::sort(entries[e].begin(), entries[e].end(), [](const Mark& a, const Mark& b) { return a.x < b.x; });
    for (size_t i = 1; i < entries[e].size(); ++i) join(plan, entries[e][i - 1].node, entries[e][i].node, s.width_m);
    add_stub(plan, s, entries[e].front().node, -1, 2 * e, seed);
    add_stub(plan, s, entries[e].back().node, 1, 2 * e + 1, seed);
  }
  return plan;
}

}  // namespace adit
