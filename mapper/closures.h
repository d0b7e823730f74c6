// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "mapper/chain.h"

#include <functional>
#include <vector>

namespace adit {

/// A place that seems to have been passed twice: a scan of the path, and the foot of the perpendicular from it to an
/// earlier stretch of the path.
struct Encounter {
  int scan = 0;           // the later one
  int foot_scan = 0;      // the earlier scan that is nearest to the foot
  double foot = 0;        // where the foot is: in scans, between floor(foot) and the next one
  bool opposite = false;  // passed the other way
  double offset_m = 0;    // from the later to the earlier, across, to the left of the later's direction > 0
};

/// The paper's three criteria, and what counts as another passage.
struct EncounterCriteria {
  double near_m = 2.5;
  double parallel_rad = 0.44;    // between the directions of travel and the headings, modulo a half turn
  double orthogonal_rad = 0.52;  // between the joining line and the perpendicular of either direction
  double gap_m = 20;             // of way between the two
};

/// Which earlier stretches of the path were passed again at the scans `from` (indices that rise), by the poses X_MB as
/// they stand now. Two passages never place their scans side by side, so the foot of the perpendicular is interpolated
/// along the path; where the two poses nearly coincide and the joining line has no direction, up to half a metre along
/// the path is allowed. Ordered by scan, then by foot. Source: Thrun et al., ICRA 2003, section III-B (the criteria
/// without their thresholds).
std::vector<Encounter> find_encounters(const Chain& chain, const std::vector<Pose2>& X_MB, const std::vector<int>& from,
                                       const EncounterCriteria& criteria);

/// Direction of travel at each scan, radians in M, from the positions half a metre before and behind; the body's
/// heading where the path is shorter than that. (scans)
std::vector<double> directions(const Chain& chain, const std::vector<Pose2>& X_MB);

}  // namespace adit
