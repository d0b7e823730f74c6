// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/verdict.h"

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace adit {

// Which nights tonight's runs may be held against, and the numbers that stand beside each other then.

using NightRuns = std::map<int, const NightCell*>;     // by seed
using RunGroup = std::pair<std::string, std::string>;  // scenario, method
using RunsByNight = std::vector<std::pair<const Night*, NightRuns>>;

NightRuns runs_of(const Night& night, const RunGroup& group);
/// "night 7 (0123456789ab)"
std::string name_of(const Night& night);

/// Nights that may be a baseline, newest first. Error for a named one that there is not.
std::vector<const Night*> candidates_of(const Night& tonight, const std::vector<Night>& past, const SuiteRules& rules);

/// Of the nights those that a group's runs may be compared with, in their order; where there are none, why.
struct ComparableNights {
  RunsByNight nights;
  std::string obstacle;
};
ComparableNights comparable_of(const Night& tonight, const NightRuns& now, const RunGroup& group,
                               const std::vector<const Night*>& nights);

/// Nights in which creep is looked for: since the last one that was accepted, oldest first.
RunsByNight stretch_of(const Night& tonight, const NightRuns& now, const RunGroup& group,
                       const std::vector<Night>& past, const SuiteRules& rules);

double median_of(std::vector<double> values);

/// A seed's value; over nights their median.
std::optional<double> value_of(const NightRuns& runs, int seed, const std::string& metric);
std::optional<double> value_of(const RunsByNight& nights, int seed, const std::string& metric);

/// A metric's seeds, tonight and before.
struct SeedPairs {
  std::vector<int> seed;
  std::vector<double> now, before, worse;  // worse: by how much, as `better` says
};
SeedPairs pairs_of(const NightRuns& now, const RunsByNight& before, const SuiteMetric& metric);

/// The smallest difference from a baseline that matters.
double relevant_of(const SuiteMetric& metric, double baseline);

/// Time and memory of a group's runs against the nights of the same machine and compiler.
SpeedVerdict speed_of(const Night& tonight, const RunGroup& group, const NightRuns& now, const RunsByNight& baseline);

}  // namespace adit
