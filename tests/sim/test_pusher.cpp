// SPDX-License-Identifier: BSD-3-Clause
#include "sim/pusher.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace adit {
namespace {

constexpr double step_s = 1.0 / 60;

struct Walk {
  std::vector<double> moving_mps, stops_s, gaps_m;
  double time_s = 0, way_m = 0;
};

// A vehicle that does at once what is wanted.
Walk walk(const DriveSettings& settings, std::uint64_t seed, double length_m, double curvature = 0) {
  Pusher pusher(settings, seed, length_m);
  Walk walk;
  double gap = 0, stop = 0;
  for (std::int64_t k = 0; k < 4'000'000; ++k) {
    walk.time_s = static_cast<double>(k) * step_s;
    if (pusher.done(walk.time_s)) return walk;
    const Intent intent = pusher.want(walk.time_s, step_s, walk.way_m, {.curvature_ahead = curvature});
    walk.way_m += intent.speed_mps * step_s;
    if (intent.hold) {
      if (gap > 0) walk.gaps_m.push_back(gap);
      gap = 0;
      stop += step_s;
    } else {
      if (stop > 0) walk.stops_s.push_back(stop);
      stop = 0;
      gap += intent.speed_mps * step_s;
      walk.moving_mps.push_back(intent.speed_mps);
    }
  }
  ADD_FAILURE() << "never arrived, seed " << seed;
  return walk;
}

TEST(Pusher, WalksAtTheMeanSpeedWithTheSpreadAsked) {
  DriveSettings settings;
  settings.stop_gap_min_m = settings.stop_gap_max_m = 1e6;
  const Walk w = walk(settings, 3, 3000);
  double sum = 0, square = 0;
  for (const double v : w.moving_mps) sum += v, square += v * v;
  const double n = static_cast<double>(w.moving_mps.size()), mean = sum / n;
  const double knots = w.time_s / 8;
  EXPECT_NEAR(mean, settings.speed_mps, 5 * settings.speed_sd_mps / std::sqrt(knots));  // five standard errors
  // Spread of the cruise and of a sine ripple of a tenth.
  const double expected = std::hypot(settings.speed_sd_mps, settings.gait_ripple * settings.speed_mps / std::sqrt(2));
  EXPECT_NEAR(std::sqrt(square / n - mean * mean), expected, 5 * expected / std::sqrt(2 * knots));
}

TEST(Pusher, StopsAsOftenAndAsLongAsAsked) {
  const DriveSettings settings;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Walk w = walk(settings, seed, 1000);
    ASSERT_GE(w.stops_s.size(), 8u) << "seed " << seed;
    EXPECT_NEAR(w.stops_s.front(), settings.lead_in_s, 0.01);
    for (size_t k = 1; k < w.stops_s.size(); ++k) {
      EXPECT_GE(w.stops_s[k], settings.stop_min_s - 0.01) << "seed " << seed;
      EXPECT_LE(w.stops_s[k], settings.stop_max_s + 0.01) << "seed " << seed;
    }
    for (size_t k = 0; k + 1 < w.gaps_m.size(); ++k) {  // the last one ends where the route does
      EXPECT_GE(w.gaps_m[k], settings.stop_gap_min_m - 0.02) << "seed " << seed;
      EXPECT_LE(w.gaps_m[k], settings.stop_gap_max_m + 0.02) << "seed " << seed;
    }
    EXPECT_NEAR(w.way_m, 1000, 0.02) << "seed " << seed;
  }
}

TEST(Pusher, TakesBendsNoFasterThanTheTurnRateAllows) {
  const DriveSettings settings;
  const double curvature = 1.5, limit = settings.turn_max_deg_s * M_PI / 180 / curvature;
  for (const double v : walk(settings, 4, 60, curvature).moving_mps)
    EXPECT_LE(v, limit * (1 + settings.gait_ripple) + 1e-9);
}

}  // namespace
}  // namespace adit
