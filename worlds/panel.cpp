// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "worlds/entry_set.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double least_pillar_m = 2.6;  // else nothing is left between its rounded corners
constexpr double longest_gob_m = 6;     // how far entries run towards the gob beyond the last crosscut

std::string metres(double v) {
  const std::string text = std::to_string(v);
  return text.substr(0, text.find('.') + 3) + " m";
}

void check_retreat(const PanelSettings& s) {
  if (s.retreat_rows == 0) return;
  if (s.crosscut_angle_deg != 90 || s.stagger != 0)
    throw Error("world.panel.retreat_rows: pillars are split in panels with crosscut_angle_deg = 90 and stagger = 0");
  if (s.retreat_rows >= s.crosscuts)
    throw Error("world.panel.retreat_rows = " + std::to_string(s.retreat_rows) + ": at most " +
                std::to_string(s.crosscuts - 1) + ", the rows between the crosscuts");
  const double pillar = std::min(s.entry_spacing_m, s.crosscut_spacing_m) - s.width_m - 2 * s.spacing_sd_m;
  if (pillar - 2 * s.stump_m < 2)
    throw Error("world.panel.stump_m = " + metres(s.stump_m) + ": the pillars leave room for stumps of at most " +
                metres((pillar - 2) / 2));
}

void check_panel(const PanelSettings& s) {
  const double room =
      std::min(s.entry_spacing_m, s.crosscut_spacing_m * std::sin(s.crosscut_angle_deg * std::numbers::pi / 180)) -
      4 * s.spacing_sd_m;
  if (s.width_m <= 0) throw Error("world.panel.width_m = " + metres(s.width_m) + ": must be above 0");
  if (s.width_m + least_pillar_m > room)
    throw Error("world.panel.width_m = " + metres(s.width_m) + ": entries and crosscuts must leave pillars of " +
                metres(least_pillar_m) +
                "; with entry_spacing_m, crosscut_spacing_m and spacing_sd_m as they are, at most " +
                metres(room - least_pillar_m) + " wide");
  if (s.entries == 1 && s.stub_length_m * s.stub_share <= 0 && s.crosscuts < 2)
    throw Error("world.panel.entries = 1: one entry needs crosscuts >= 2 or stubs to have any length");
  if (s.missing_share + s.dead_end_share + s.stopping_share > 1)
    throw Error("world.panel.missing_share, dead_end_share, stopping_share: their sum must not be above 1");
  check_retreat(s);
}

// Splits the pillar between two entries and two crosscuts by a cut along and one across, which leave four stumps.
void split_pillar(MinePlan& plan, const PanelSettings& s, EntrySet& set, size_t gap, double x0, double x1, int near,
                  int far) {
  const double x = 0.5 * (x0 + x1), high = set.offset_m[gap + 1] - set.offset_m[gap];
  const double across_m = std::min(12.0, x1 - x0 - s.width_m - 2 * s.stump_m);
  const double along_m = std::min(12.0, high - s.width_m - 2 * s.stump_m);
  const int centre = add_node(plan, 0.5 * (set.at(gap, x) + set.at(gap + 1, x)));
  join(plan, node_at(plan, set, gap, x), centre, across_m);
  join(plan, centre, node_at(plan, set, gap + 1, x), across_m);
  join(plan, near, centre, along_m);
  join(plan, centre, far, along_m);
}

// Crosscuts where pillars were robbed: each has a node in its middle, where the cuts along end.
void retreat(MinePlan& plan, const PanelSettings& s, EntrySet& set, size_t gap, const std::vector<double>& x) {
  int near = -1;
  for (size_t k = x.size() - 1 - s.retreat_rows; k < x.size(); ++k) {
    const int a = node_at(plan, set, gap, x[k]), b = node_at(plan, set, gap + 1, x[k]);
    const int middle = add_node(plan, 0.5 * (plan.nodes[a] + plan.nodes[b]));
    join(plan, a, middle, s.width_m);
    join(plan, middle, b, s.width_m);
    if (near >= 0) split_pillar(plan, s, set, gap, x[k - 1], x[k], near, middle);
    near = middle;
  }
}

void add_crosscuts(MinePlan& plan, const PanelSettings& s, EntrySet& set, std::uint64_t seed) {
  const double lean = 1 / std::tan(s.crosscut_angle_deg * std::numbers::pi / 180);
  const std::vector<double> x = scattered(s.crosscuts, s.crosscut_spacing_m, s.spacing_sd_m, seed, 1);
  const std::vector<double>& y = set.offset_m;
  for (int gap = 0; gap + 1 < s.entries; ++gap) {
    const size_t whole = s.retreat_rows > 0 ? x.size() - 1 - s.retreat_rows : x.size();
    for (size_t k = 0; k < whole; ++k) {
      const double low = x[k] + lean * y[gap] + s.stagger * s.crosscut_spacing_m * (gap % 2);
      const double high = low + lean * (y[gap + 1] - y[gap]);
      const int a = node_at(plan, set, gap, low), b = node_at(plan, set, gap + 1, high);
      // The first and the last join the entries: they are always driven through.
      const bool end = k == 0 || k + 1 == x.size();
      const CrosscutShares shares{s.missing_share, s.dead_end_share, s.stopping_share, s.stopping_m};
      drive_crosscut(plan, a, b, s.width_m, end ? CrosscutShares{} : shares, seed, gap * 1000 + k);
    }
    if (s.retreat_rows > 0) retreat(plan, s, set, gap, x);
  }
  if (s.entries == 1)
    for (double at : x) node_at(plan, set, 0, at);
}

void add_stub(MinePlan& plan, const PanelSettings& s, int node, double direction, std::uint64_t which,
              std::uint64_t seed) {
  if (uniform(seed, Draw::world_layout, 2, which) >= s.stub_share) return;
  const double length = s.stub_length_m * (0.8 + 0.4 * uniform(seed, Draw::world_layout, 3, which));
  if (length < s.width_m) return;  // it would drown in its junction
  const Vec2 end = plan.nodes[node] + Vec2(direction * length, 0);
  join(plan, node, add_node(plan, end), s.width_m);
}

// Beyond the pillar line the roof has come down: entries end at rubble, at a distance that is drawn.
void end_at_gob(MinePlan& plan, const PanelSettings& s, int node, std::uint64_t which, std::uint64_t seed) {
  const double length = s.width_m + longest_gob_m * uniform(seed, Draw::world_layout, 4, which);
  const int end = add_node(plan, plan.nodes[node] + Vec2(length, 0));
  plan.cut[end] = 1;
  join(plan, node, end, s.width_m);
}

// Half an oval that leads from the first entry's end round to the last one's.
void add_loop_road(MinePlan& plan, const PanelSettings& s, int first, int last) {
  const Vec2 from = plan.nodes[first], to = plan.nodes[last], middle = 0.5 * (from + to);
  const double high = 0.5 * (to.y() - from.y()), deep = std::max(high, 1.2 * s.stub_length_m + 2 * s.width_m + 6);
  std::vector<Vec2> line{from};
  for (int k = 1; k < 12; ++k) {
    const double a = std::numbers::pi * (k / 12.0 - 0.5);
    const double base = from.x() + (to.x() - from.x()) * k / 12.0;
    line.emplace_back(base + deep * std::cos(a), middle.y() + high * std::sin(a));
  }
  line.push_back(to);
  plan.passages.push_back({first, last, s.width_m, line});
}

}  // namespace

MinePlan panel_plan(const PanelSettings& s, std::uint64_t seed) {
  check_panel(s);
  MinePlan plan;
  EntrySet set = entry_set({0, 0}, {1, 0}, s.width_m, scattered(s.entries, s.entry_spacing_m, s.spacing_sd_m, seed, 0));
  add_crosscuts(plan, s, set, seed);
  drive_entries(plan, set);
  const bool loop = s.loop_road && s.entries > 1;
  for (int e = 0; e < s.entries; ++e) {
    add_stub(plan, s, set.marks[e].front().node, -1, 2 * e, seed);
    const int end = set.marks[e].back().node;
    if (s.retreat_rows > 0)
      end_at_gob(plan, s, end, e, seed);
    else if (!loop || (e > 0 && e + 1 < s.entries))
      add_stub(plan, s, end, 1, 2 * e + 1, seed);
  }
  if (loop && s.retreat_rows == 0) add_loop_road(plan, s, set.marks.front().back().node, set.marks.back().back().node);
  add_turnouts(plan, s.turnout_share, seed);
  return plan;
}

}  // namespace adit
