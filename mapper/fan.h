// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"

#include <vector>

namespace adit {

/// One beam in M: the laser stood at `origin` when it left.
struct FanBeam {
  Vec3 origin, end;  // end = origin + range * direction; meaningless where range_m is not finite
  float range_m;     // +inf = no echo, NaN = nothing readable
};

/// Every step-th beam of one scan, each from where its laser was at its own instant. X_MB is asked at the start and the
/// end of each turn of the mirror and taken as even between them (a turn lasts some 7 ms).
std::vector<FanBeam> fan_of(const Log& log, int laser, size_t scan, const Trajectory& X_MB, int step = 1);

/// Scans of a laser whose beams all leave within the time that X_MB covers. (indices, rising)
std::vector<size_t> covered_scans(const Log& log, int laser, const Trajectory& X_MB);

}  // namespace adit
