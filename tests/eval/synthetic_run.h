// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "base/recording.h"
#include "base/world.h"
#include "eval/report.h"

namespace adit {

/// A run that was never driven: a ring with a pillar and undulating ground, a path of two rounds, a map that is the
/// truth bent by `drift_m` per round, scored by hand. For pictures and pages.
struct SyntheticRun {
  World world;
  Log log;
  Truth truth;
  Estimate estimate;
  Score score;

  ReportInput input() const {
    return {world, log, truth, estimate, score, "seed = 1\n[world]\nname = \"ring\"\n", "ring"};
  }
};
SyntheticRun synthetic_run(double drift_m = 0.4, double edge_m = 0.5);

}  // namespace adit
