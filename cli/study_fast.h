// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/study_file.h"
#include "eval/placement.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// The mine and the true path of a scenario, ready to judge lasers on.
class FastCourse {
 public:
  /// Error where the drive ends early.
  FastCourse(const Scenario& scenario, const FastSettings& settings);
  ~FastCourse();
  const Course& course() const;
  const Hull& hull() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// What true geometry says of a point of a study.
struct FastResult {
  std::optional<FastScore> score;
  std::string failure;  // why there is none
};

/// Scores of scenarios, in their order. Kept in DIR by what they are made of, so that they are made once; scenarios of
/// one drive make it once.
std::vector<FastResult> fast_scores(const std::vector<Scenario>& scenarios, const FastSettings& settings,
                                    const std::string& dir, const Progress& progress);

/// Placements that go on to full runs, as changes of the rig (sensors.mounts), best first, and what was looked at.
struct Placements {
  std::vector<std::vector<std::string>> mounts;
  std::vector<std::string> label;  // where each one's lasers are, in words
  std::string words;               // how they were found
};
/// Kept in DIR too. DIR/placements.csv lists every set of the full number that was scored.
Placements find_placements(const Study& study, const Scenario& scenario, const std::string& dir,
                           const Progress& progress);

}  // namespace adit
