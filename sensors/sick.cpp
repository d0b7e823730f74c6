// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sick.h"

#include <cmath>

namespace adit {

double detection_chance(const LaserModel& model, double effective_reflectivity, double range_m, double spread) {
  const double least = model.least_reflectivity(range_m);
  if (least <= 0) return 1;
  if (effective_reflectivity <= 0) return 0;
  return 1 / (1 + std::exp(-std::log(effective_reflectivity / least) / spread));
}

}  // namespace adit
