// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "base/recording.h"
#include "base/world.h"
#include "eval/map_error.h"
#include "eval/observable.h"
#include "eval/passage_map.h"
#include "eval/score.h"
#include "eval/true_scans.h"
#include "eval/volume_error.h"

#include <optional>
#include <string>

namespace adit {

/// What every map of one recording is held against, from mine and truth alone: made once, however many maps are judged by
/// it. World, truth and rig must outlive it.
struct Yardstick {
  const World& world;
  const Truth& truth;
  const Rig& nominal;  // the rig that the mapper was told
  ScoreSettings settings;
  Surface surface;
  PassageMap passages;
  TrueScans scans;
  Patches patches;
  Observable observable;
  std::optional<VolumeDomain> domain;
  std::string no_domain;  // why there is none

  /// @throws Error as check_comparable() does
  Yardstick(const World& world, const Truth& truth, const Rig& nominal, const ScoreSettings& settings,
            const Progress& progress = {});
};

/// @throws Error (not_comparable) where the truth is another world's, or the rig has not as many lasers as the truth
void check_comparable(const World& world, const Truth& truth, const Rig& nominal);

/// As score_map() in score.h, to the bit.
Score score_map(const Yardstick& yardstick, const Estimate& estimate, const Progress& progress = {});

}  // namespace adit
