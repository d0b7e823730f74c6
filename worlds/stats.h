// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"

#include <map>
#include <vector>

namespace adit {

/// What mines measure, passage by passage: by rays within their meshes, not by their truth.
struct MineSamples {
  std::vector<double> width_m, height_m;        // (passages) means over places away from the junctions
  std::vector<double> grade_percent, length_m;  // (passages) of the line from end to end; along the centre line
  // (passages) rms of what is met along stretches of 4 m from the straight line through it, in places where that is plain
  // floor, roof or rib
  std::vector<double> floor_rough_m, roof_rough_m, rib_rough_m;
  std::vector<double> pillar_m2, extraction;        // (pillars), (mines)
  std::map<int, int> junctions;                     // how many of each degree
  std::map<Label, std::vector<double>> per_100m;    // (mines that have any) things in 100 m of passages
  std::vector<double> blocked_share, bodies_share;  // (mines) of the passages' length; of the bare void
};

/// Adds a mine's.
void measure(const World& world, MineSamples& samples);

/// Puts another's behind.
void append(MineSamples& all, const MineSamples& more);

struct Spread {
  size_t n = 0;
  double mean = 0, sd = 0, p5 = 0, p50 = 0, p95 = 0;
};
Spread spread_of(std::vector<double> values);

}  // namespace adit
