// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sick.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {

double detection_chance(const LaserModel& model, double effective_reflectivity, double range_m, double spread) {
  const double least = model.least_reflectivity(range_m);
  if (least <= 0) return 1;
  if (effective_reflectivity <= 0) return 0;
  return 1 / (1 + std::exp(-std::log(effective_reflectivity / least) / spread));
}

double range_sigma_m(const LaserModel& model, double weakness) {
  // Echoes below half of the threshold are not noticed; the law is not carried further.
  constexpr double weakest = 2;
  return model.sigma_m * std::hypot(1.0, std::min(weakness, weakest));
}

double footprint_sigma_m(const LaserModel& model, double range_m, double incidence_rad) {
  // Nearer to grazing the tangent runs away, and the echo is lost anyway.
  constexpr double most_rad = 85 * std::numbers::pi / 180;
  const double diameter_m = model.spot_m + model.divergence_rad * range_m;
  return diameter_m * std::tan(std::min(incidence_rad, most_rad)) / 8;
}

float reported_range_m(const LaserModel& model, double range_m) {
  if (range_m > model.range_max_m) return std::numeric_limits<float>::infinity();
  const double step_m = model.resolution_m;
  const double told = step_m > 0 ? std::round(range_m / step_m) * step_m : range_m;
  return told > 0 ? static_cast<float>(told) : std::numeric_limits<float>::quiet_NaN();
}

}  // namespace adit
