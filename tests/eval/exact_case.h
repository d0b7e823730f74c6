// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "base/recording.h"
#include "base/world.h"
#include "eval/score.h"

#include <vector>

namespace adit {

/// A mine, a drive through it with noise-free lasers, and the estimate that equals the truth: path, points, surface,
/// grid.
struct ExactCase {
  World world;
  Truth truth;
  Rig nominal;
  Estimate estimate;
};

/// A cart with three lasers of 91 beams (front level, up, down), 0.2 m of way between scans, along `line` (turning on
/// the spot).
ExactCase drive_exactly(const World& world, const std::vector<Vec3>& line);

/// Once round a ring of 20 m with passages 4 m wide and 2 m high, and 8 m of it again.
const ExactCase& ring_case();
/// 12 m along the middle of a tunnel of 20 x 4 x 2 m.
const ExactCase& tunnel_case();

/// Mine, true path and all that the truth holds, moved by X; the estimate, which is in M, stays.
ExactCase moved(const ExactCase& exact, const Pose& X);

Score score_of(const ExactCase& exact, const ScoreSettings& settings = {});
/// The value of a metric that there is; fails the test if there is none by that name.
double value(const Score& score, const std::string& name);

}  // namespace adit
