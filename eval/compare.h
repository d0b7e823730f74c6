// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/score.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// One run among many: what it was made from and how it scored.
struct ScoredRun {
  std::string folder;
  std::string settings;  // its resolved scenario without the seed: what puts runs into one group
  int seed = 0;
  std::optional<Score> score;  // none: the run failed
};

/// How far from what would be best: the number itself, its negative where higher is better, its distance from 0 where it
/// is good near 0.
double badness(const std::string& name, Better better, double value);

/// A median with the interval that holds it with 95 %, where there are runs enough to say.
struct Spread {
  std::int64_t n = 0;
  double median = 0, low = 0, high = 0;  // NaN where n = 0, n < 5
};
/// Percentile bootstrap of the median, 2000 samples at fixed addresses: the same every time.
Spread spread_of(const std::vector<double>& values);
enum class Tail { both, above };  // of a test: either way off, or above 0
/// p of the hypothesis that the differences are as likely of either sign: the share of sign patterns whose mean is at
/// least as far from 0 (both), or at least as great (above). All 2^n of them up to n = 16, 65536 drawn ones beyond. 1 for
/// none.
double sign_flip_p(const std::vector<double>& differences, Tail tail = Tail::both);
/// Each difference's rank by size with its sign, ties sharing theirs, 0 for 0: sign_flip_p of them is Wilcoxon's
/// signed-rank test, which a few great differences cannot sway (Biometrics Bulletin 1, 1945; zeros after Pratt, 1959).
std::vector<double> signed_ranks(const std::vector<double>& differences);

/// Holm's correction of several p for each other (Scand. J. Statist. 6, 1979), in their order; never above 1.
std::vector<double> holm(const std::vector<double>& p);

struct ComparedMetric {
  std::string name, unit;
  Better better;
  double relevant =
      0;  // smallest difference that matters: 5 % of the first group's median, or what the unit makes of it
  struct Group {
    Spread value;
    double mean = 0;                // NaN where n = 0; of a share that is 0 or 1 in each run the share of the runs
    std::int64_t missing = 0;       // runs with a score that lacks it
    std::optional<int> worst_seed;  // none where all are equal
    Spread difference;              // to the first group, over the seeds that both have
    double effect = 0;              // mean of the differences over their deviation; NaN for fewer than 2
    double p = 1;                   // of no difference; of a number that is good near 0 by its distance from 0
    std::optional<double> p_holm;   // the same for all metrics of the suite together; none for others
    std::string verdict;            // "better", "worse", "same" or "unclear"; empty for the first group
  };
  std::vector<Group> group;
};

/// Runs side by side.
struct Comparison {
  struct Group {
    std::string label;      // what tells it from the first group: the lines of its settings that differ
    std::vector<int> seed;  // rising
    std::vector<int> failed;
  };
  std::vector<Group> group;
  std::vector<ComparedMetric> metric;  // those of any run, in the order of a score
};

/// Groups runs by their settings, in the order in which they first appear; seeds are what pairs runs across groups.
/// A group is better or worse than the first one when the difference is relevant in the median and its p (Holm's, for
/// metrics of the suite) is at most 0.05; the same when the whole interval of the difference is irrelevant.
/// @param suite  metrics that are judged together
/// @throws Error where one group has a seed twice; Error (not_comparable) where groups that are paired by a seed were
/// scored against different truths, unless the settings of the mine, the drive or the lasers differ
Comparison compare_runs(const std::vector<ScoredRun>& runs, const std::vector<std::string>& suite = {});

/// A table for people of the metrics named, those there are.
std::string comparison_table(const Comparison& comparison, const std::vector<std::string>& names);
/// comparison.json: groups and every metric.
void write_comparison(const std::string& file, const Comparison& comparison);

}  // namespace adit
