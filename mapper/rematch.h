// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/progress.h"
#include "mapper/match.h"

#include <vector>

namespace adit {

struct RematchSettings {
  double prior_sigma_m = 0.03, prior_sigma_deg = 0.3;  // of an aligned pose
  double key_step_m = 0.4;                             // way between the scans of which maps are made
  int key_scans = 30;                                  // most of them in one map, the nearest first
  double reach_m = 4;                                  // they lie within
};
Fields fields(RematchSettings& s);

/// Places every scan once more, each against the scans that lie near it in space at the aligned poses, whenever they
/// were taken, with its own aligned pose as a quadratic prior. Parallel. What cannot be matched keeps its pose. Source:
/// Thrun et al., "A system for volumetric robotic mapping of abandoned mines", ICRA 2003, III-C.
/// @param X_MB aligned poses, one a scan
/// @return     (scans) poses
std::vector<Pose2> rematch(const std::vector<ScanPoints>& scans, const std::vector<Pose2>& X_MB,
                           const RematchSettings& settings, const MatchSettings& match, const Progress& progress = {});

}  // namespace adit
