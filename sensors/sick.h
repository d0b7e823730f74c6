// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/laser.h"

namespace adit {

// What the sheets of the SICK LMS 2xx state, as laws. Reflectivities are diffuse, at 905 nm; the effective one of a
// surface is reflectivity * cos(incidence).
// Sources: SICK Technical Description 8008970/06-2003, its detection charts digitised; telegram listing 8007954/2006.

/// Chance that an echo is noticed: logistic in ln(reflectivity), one half at the model's least reflectivity, `spread`
/// its width.
double detection_chance(const LaserModel& model, double effective_reflectivity, double range_m, double spread);

/// Sd of one range, metres: the stated one, growing as an echo nears the threshold.
/// @param weakness  least reflectivity that is noticed over the target's effective one, 1 at the threshold
double range_sigma_m(const LaserModel& model, double weakness);

/// Sd that comes on top where the spot is smeared along a slanting surface: diameter * tan(incidence) / 8.
double footprint_sigma_m(const LaserModel& model, double range_m, double incidence_rad);

/// What the telegram says of a measured range: rounded to the resolution; +inf beyond the mode's range, NaN where
/// nothing positive is left.
float reported_range_m(const LaserModel& model, double range_m);

}  // namespace adit
