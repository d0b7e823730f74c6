// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "base/recording.h"
#include "base/world.h"
#include "cli/console.h"
#include "cli/scenario.h"
#include "eval/score.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// The mine of a scenario, checked: Error (bug) where mesh or truth is not sound.
World sound_world(const Scenario& s, const Progress& progress = {});

/// The stages of a run in their order, each reading what the one before it made. A stage that succeeds puts its files
/// in place and removes what later stages had made from older input, so that a folder never mixes two runs.
class Stages {
 public:
  Stages(std::string out, Console& console);

  World world(const Scenario& s);
  /// The same tile after tile, pictures too, where the mine is made in tiles: it is never held as a whole.
  void world_in_parts(const Scenario& s);
  /// OUT/world/plan.png, interior-1.png, interior-2.png
  void pictures(const World& world);
  struct Driven {
    Drive drive;    // of its path the last minute or two
    int exit_code;  // 1 where the drive ended early
  };
  /// OUT/recording, streamed: a part a minute, joined at the end.
  /// @param keep  or null: becomes the recording; without it memory does not hold more of it than a minute
  Driven drive(const Scenario& s, const World& world, Recording* keep);
  /// By adit's own mapper, or by the command of [map.external]; none where that failed, which is noted.
  std::optional<Estimate> map(const Scenario& s, const Log& log);
  /// The optimum of a bare pose graph: OUT/map/graph.g2o, covariance.txt and map.json.
  SolvedGraph map(const MapSettings& settings, const GraphFile& graph);
  Score score(const ScoreSettings& settings, const World& world, const Truth& truth, const Rig& nominal,
              const Estimate& estimate);
  void report(const Scenario& s, const World& world, const Recording& recording, const Estimate& estimate,
              const Score& score);

  /// OUT/timing.json: seconds and peak memory of every stage that ran.
  void save_timing() const;
  const std::string& out() const { return out_; }

 private:
  struct Timed {
    std::string stage;
    double seconds, peak_gib;
  };
  std::string out_;
  Console& console_;
  std::vector<Timed> times_;

  Drive stream(const Scenario& s, const World& world, const Rig& rig, const Vehicle& vehicle, Recording* keep);
  void timed(const std::string& stage, const std::function<void()>& work);
  void forget(const std::vector<std::string>& later) const;
};

}  // namespace adit
