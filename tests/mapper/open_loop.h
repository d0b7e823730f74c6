// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// Tours of a square lattice of passages and what a front end that drifts makes of them: tests of the back end need no
// scans.

#include "base/estimate.h"
#include "mapper/odometry.h"

#include <cstdint>
#include <vector>

namespace adit {

/// Errors of a front end, white from step to step (0.15 m); it states them truly.
struct Drift {
  double along_m = 0, across_m = 0, yaw_rad = 0;  // sd per step
  double scale = 0;                               // share of the step's length, not stated
};

/// 0.02 % of 100 m, as rough ribs give; about 1 % as smooth ones do.
inline constexpr Drift rough_ribs{5e-4, 3e-4, 2e-5, 0};
inline constexpr Drift smooth_ribs{3e-2, 6e-4, 1e-4, 0};

struct OpenLoop {
  std::vector<Pose2> X_true;  // (scans) first = identity
  Odometry odometry;
};

/// A walk over a lattice of side x side crossings pitch_m apart, never back at once, `legs` long, corners rounded,
/// swaying by a quarter of a metre off the centre line; a scan every 0.15 m.
OpenLoop walk_panel(int side, double pitch_m, int legs, const Drift& drift, std::uint64_t seed);
/// `laps` times around a square block.
OpenLoop walk_ring(double side_m, int laps, const Drift& drift, std::uint64_t seed);

/// Root mean square distance after the best rigid fit.
double ate_m(const std::vector<Pose2>& X_true, const std::vector<Pose2>& X);
/// Closures whose true poses are not within 3 m, or neither parallel nor opposite within 30 degrees.
int wrong_places(const std::vector<Closure>& closures, const std::vector<Pose2>& X_true);
/// Share of the scans every 5 m that truly were somewhere before (within 2.5 m, parallel or opposite, 20 m of way
/// apart) and have a closure within 5 m of way.
double recall(const std::vector<Closure>& closures, const std::vector<Pose2>& X_true);

}  // namespace adit
