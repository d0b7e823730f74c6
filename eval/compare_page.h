// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/compare.h"
#include "eval/page.h"

#include <string>
#include <vector>

namespace adit {

/// How far one run's path lies from the truth, along the way driven.
struct PathErrors {
  int seed = 0;
  std::vector<double> along_m, plan_m, height_m;  // way, distance in plan, map - truth; by the best rigid fit
};
PathErrors path_errors(const Score& score, int seed);

/// Several runs on one page.
struct SideBySide {
  std::vector<ScoredRun> runs;
  Comparison comparison;              // of those runs
  std::vector<std::string> headline;  // metrics that stand first
  std::vector<Plate> plans;           // (groups) of one run of each, over one range of colours
  std::vector<PathErrors> paths;      // (groups) of the same runs; empty where there is none
};

/// For each group of a comparison the run whose plan is shown: of the smallest seed that all have, else of its first.
std::vector<size_t> shown_runs(const std::vector<ScoredRun>& runs, const Comparison& comparison);
/// End of the range of colours that holds the errors of all.
double common_range_m(const std::vector<ScoredRun>& runs);
/// The plan of errors of one run.
Plate plan_plate(const ReportInput& input, const ReportSettings& settings);

/// @param link_of  where a run's own page lies as seen from this one, or "" where it has none: (runs)
std::string comparison_html(const SideBySide& all, const std::vector<std::string>& link_of);

}  // namespace adit
