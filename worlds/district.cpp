// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "worlds/entry_set.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double least_pillar_m = 2.6;
enum Address : std::uint64_t { main_entry = 50, panel_step, panel_entry, submain_entry };

std::string metres(double v) {
  const std::string text = std::to_string(v);
  return text.substr(0, text.find('.') + 3) + " m";
}

void check_district(const DistrictSettings& s) {
  const double room =
      std::min({s.main_spacing_m, s.panel_spacing_m, s.crosscut_spacing_m}) - 4 * s.spacing_sd_m - least_pillar_m;
  if (s.width_m > room)
    throw Error("world.district.width_m = " + metres(s.width_m) +
                ": with main_spacing_m, panel_spacing_m, crosscut_spacing_m and spacing_sd_m as they are, at most " +
                metres(room));
  if (s.submain_entries == 1)
    throw Error("world.district.submain_entries = 1: sub-mains have two entries or more, or 0: none");
  if (s.missing_share + s.stopping_share > 1)
    throw Error("world.district.missing_share, stopping_share: their sum must not be above 1");
}

double length_of(const MinePlan& plan, size_t first) {
  double length = 0;
  for (size_t i = first; i < plan.passages.size(); ++i)
    length += (plan.passages[i].line.back() - plan.passages[i].line.front()).norm();
  return length;
}

// Crosscuts of a set from `first_m` on, at steps that scatter; those between every second pair of entries are moved.
void add_crosscuts(MinePlan& plan, EntrySet& set, double first_m, int count, const DistrictSettings& s,
                   std::uint64_t seed, std::uint64_t which) {
  const std::vector<double> x = scattered(count, s.crosscut_spacing_m, s.spacing_sd_m, seed, panel_step + 100 * which);
  for (size_t k = 0; k < x.size(); ++k) {
    const bool end = k == 0 || k + 1 == x.size();
    for (size_t e = 0; e + 1 < set.offset_m.size(); ++e) {
      const double at = first_m + x[k] + (e % 2 == 1 ? s.stagger * s.crosscut_spacing_m : 0);
      drive_crosscut(plan, node_at(plan, set, e, at), node_at(plan, set, e + 1, at), s.width_m,
                     end ? CrosscutShares{} : CrosscutShares{s.missing_share, 0, s.stopping_share, s.stopping_m}, seed,
                     which * 100000 + 100 * k + e);
    }
  }
}

// How far a panel reaches from the entry that it leaves, and how wide it is with its barrier pillar.
double panel_reach_m(const DistrictSettings& s) {
  return s.barrier_m + s.width_m + (s.panel_crosscuts - 1 + s.stagger) * (s.crosscut_spacing_m + 2 * s.spacing_sd_m);
}
double panel_pitch_m(const DistrictSettings& s) {
  return (s.panel_entries - 1) * s.panel_spacing_m + 4 * s.spacing_sd_m + s.width_m + s.barrier_m;
}

// A panel off other entries: its own run through the barrier pillar before the first crosscut joins them.
void add_panel(MinePlan& plan, EntrySet& parent, int side, double x, const DistrictSettings& s, std::uint64_t seed,
               std::uint64_t which) {
  EntrySet panel =
      branch(plan, parent, side, x, s.width_m,
             scattered(s.panel_entries, s.panel_spacing_m, s.spacing_sd_m, seed, panel_entry + 100 * which));
  add_crosscuts(plan, panel, s.barrier_m + s.width_m, s.panel_crosscuts, s, seed, which + 1);
  drive_entries(plan, panel);
}

// Crosscuts of entries from which sets turn off at each pitch: over pitch k.
void add_through_crosscuts(MinePlan& plan, EntrySet& set, double from_m, double pitch, const DistrictSettings& s,
                           std::uint64_t seed, std::uint64_t which) {
  const int crosscuts = std::max(1, static_cast<int>(pitch / s.crosscut_spacing_m));
  for (int c = 0; c < crosscuts; ++c) {
    const CrosscutShares shares =
        c == 0 ? CrosscutShares{} : CrosscutShares{s.missing_share, 0, s.stopping_share, s.stopping_m};
    for (size_t e = 0; e + 1 < set.offset_m.size(); ++e) {
      const double at = from_m + (c + 0.5 + (e % 2 == 1 ? 0.9 * s.stagger : 0)) / crosscuts * pitch;
      drive_crosscut(plan, node_at(plan, set, e, at), node_at(plan, set, e + 1, at), s.width_m, shares, seed,
                     (std::uint64_t{1} << 40) + 1000 * (100 * which + c) + e);
    }
  }
}

// Sub-mains off the mains, a pair of panels at each of their pitches.
void add_submain(MinePlan& plan, EntrySet& mains, int side, double x, const DistrictSettings& s, std::uint64_t seed,
                 std::uint64_t which) {
  EntrySet set =
      branch(plan, mains, side, x, s.width_m,
             scattered(s.submain_entries, s.main_spacing_m, s.spacing_sd_m, seed, submain_entry + 100 * which));
  const double pitch = panel_pitch_m(s), wide = (s.panel_entries - 1) * s.panel_spacing_m;
  for (int k = 0; k < s.submain_panels; ++k) {
    const double from = s.barrier_m + s.width_m + k * pitch;
    for (int to : {1, -1})
      add_panel(plan, set, to, from + 0.5 * (pitch - wide), s, seed, 1000 * (which + 1) + 2 * k + (to > 0));
    add_through_crosscuts(plan, set, from, pitch, s, seed, 1000 * (which + 1) + k);
  }
  drive_entries(plan, set);
}

}  // namespace

// Mains grow by one pitch at a time, with a panel or sub-mains to either side, until the district is as long as asked.
MinePlan district_plan(const DistrictSettings& s, std::uint64_t seed) {
  check_district(s);
  MinePlan plan;
  EntrySet mains =
      entry_set({0, 0}, {1, 0}, s.width_m, scattered(s.mains, s.main_spacing_m, s.spacing_sd_m, seed, main_entry));
  const bool sub = s.submain_entries > 0;
  const double wide = sub ? (s.submain_entries - 1) * s.main_spacing_m : (s.panel_entries - 1) * s.panel_spacing_m;
  const double pitch =
      wide + 4 * s.spacing_sd_m + s.width_m + (sub ? 2 * panel_reach_m(s) + s.width_m : 0) + s.barrier_m;
  double crosscuts_m = 0;  // of all but the mains' entries, which are joined when all their nodes are known
  for (int k = 0; k == 0 || crosscuts_m + s.mains * k * pitch < s.length_m; ++k) {
    const size_t before = plan.passages.size();
    const double x = (k + 0.5) * pitch - 0.5 * wide;
    for (int side : {1, -1}) {
      const std::uint64_t which = 2 * k + (side > 0);
      sub ? add_submain(plan, mains, side, x, s, seed, which) : add_panel(plan, mains, side, x, s, seed, which);
    }
    add_through_crosscuts(plan, mains, k * pitch, pitch, s, seed, k);
    crosscuts_m += length_of(plan, before);
  }
  drive_entries(plan, mains);
  return plan;
}

}  // namespace adit
