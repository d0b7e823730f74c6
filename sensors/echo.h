// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/laser.h"
#include "sensors/settings.h"

#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace adit {

/// Rays that stand for a beam's spot: places in the unit disc, the axis first, then rings of 6, 12, 18; weights sum to 1.
struct Bundle {
  std::vector<Vec2> place;     // (n)
  std::vector<double> weight;  // (n) share of the pulse's power
};
/// @param rays  1, 7, 19 or 37; else Error
Bundle make_bundle(int rays);

/// What one part of a pulse brings back: its share times reflectivity times cos(incidence), before the fall with range.
struct Return {
  double range_m = 0;  // +inf: nothing
  double power = 0;
};

/// When an echo is noticed.
struct Threshold {
  const LaserModel* model = nullptr;
  bool always = false;  // whatever there is
  double spread = 0.1;  // width in ln(reflectivity)
  double factor = 1;    // of a dirty window
  double chance = 0.5;  // of this beam, in [0, 1)

  /// Effective reflectivity over the least that the model notices at a range.
  double margin(double effective_reflectivity, double range_m) const {
    const double least = factor * model->least_reflectivity(range_m);
    return least > 0 ? effective_reflectivity / least : std::numeric_limits<double>::infinity();
  }
  bool passes(double margin) const;
};

/// The echo that a time-of-flight laser measures.
struct Echo {
  bool noticed = false;
  double range_m = 0;
  double effective_reflectivity = 0;
  double margin = 0;    // of the echo, or of the strongest where none is noticed
  double spread_m = 0;  // sd of the surfaces that merged into it
  int surfaces = 0;     // of the spot, also behind the echo
};

/// First-pulse logic: from the nearest return on, the returns within one pulse length merge into one echo at the mean of
/// their ranges by power; the first that passes the threshold is told, what lies behind is ignored. Reorders `returns`.
/// Sources: SICK telegram listing 8007954 (first pulse, merging); Sanz-Cortiella et al., Sensors 2011 (length, by power).
Echo first_echo(std::span<Return> returns, const Threshold& threshold, double pulse_m);

/// The same of a spot that is taken for its axis.
inline Echo echo_of_one(const Return& r, const Threshold& threshold) {
  Echo echo;
  if (!(r.power > 0) || std::isinf(r.range_m)) return echo;
  echo.surfaces = 1;
  echo.margin = threshold.margin(r.power, r.range_m);
  if (!threshold.passes(echo.margin)) return echo;
  echo.noticed = true;
  echo.range_m = r.range_m;
  echo.effective_reflectivity = r.power;
  return echo;
}

}  // namespace adit
