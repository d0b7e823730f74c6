// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/laser.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {

// What the sheets of the SICK LMS 2xx state, as laws. Reflectivities are diffuse, at 905 nm; the effective one of a
// surface is reflectivity * cos(incidence).
// Sources: SICK Technical Description 8008970/06-2003, its detection charts digitised; telegram listing 8007954/2006.

/// Chance that an echo is noticed: logistic in ln(reflectivity), one half at the model's least reflectivity, `spread`
/// its width.
double detection_chance(const LaserModel& model, double effective_reflectivity, double range_m, double spread);

/// Variance and sd of one range: the stated one, growing as an echo nears the threshold.
/// @param weakness  least reflectivity that is noticed over the target's effective one, 1 at the threshold
inline double range_variance_m2(const LaserModel& model, double weakness) {
  // Echoes below half of the threshold are not noticed; the law is not carried further.
  const double w = weakness < 2 ? weakness : 2;
  return model.sigma_m * model.sigma_m * (1 + w * w);
}
inline double range_sigma_m(const LaserModel& model, double weakness) {
  return std::sqrt(range_variance_m2(model, weakness));
}

/// Variance and sd that come on top where the spot is smeared along a slanting surface: diameter * tan(incidence) / 8.
/// @param cosine  of the incidence
inline double footprint_variance_m2(const LaserModel& model, double range_m, double cosine) {
  // Nearer to grazing than 85 degrees the tangent runs away, and the echo is lost anyway.
  constexpr double least = 0.08715574274765817;
  const double sound = cosine > least ? cosine : least, c = sound < 1 ? sound : 1;
  const double diameter_m = model.spot_m + model.divergence_rad * range_m;
  return diameter_m * diameter_m * (1 - c * c) / (64 * c * c);
}
inline double footprint_sigma_m(const LaserModel& model, double range_m, double cosine) {
  return std::sqrt(footprint_variance_m2(model, range_m, cosine));
}

/// The nearest step of a counter; 0 = it has none.
inline double stepped_m(double range_m, double step_m) {
  const double stepped = std::floor(range_m / step_m + 0.5) * step_m;
  return step_m > 0 ? stepped : range_m;
}

/// What the telegram says of a measured range: rounded to the resolution; +inf beyond the mode's range, NaN where
/// nothing positive is left.
inline float reported_range_m(const LaserModel& model, double range_m) {
  if (range_m > model.range_max_m) return std::numeric_limits<float>::infinity();
  const double told = stepped_m(range_m, model.resolution_m);
  return told > 0 ? static_cast<float>(told) : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace adit
