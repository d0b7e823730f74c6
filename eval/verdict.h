// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/compare.h"
#include "eval/history.h"

#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// Which way a metric gets worse: up, down, away from 0, or either way from where it was.
enum class Direction { lower, higher, zero, steady };

/// A metric that a suite watches.
struct SuiteMetric {
  std::string name;
  Direction better = Direction::lower;
  double relevant = 0, relevant_percent = 0;  // smallest difference that matters: the greater one of both
  double at_most = std::numeric_limits<double>::infinity(),
         at_least = -std::numeric_limits<double>::infinity();  // of every run, whatever came before
};

/// By what a night is judged.
struct SuiteRules {
  std::vector<SuiteMetric> metric;
  double alpha = 0.05;              // chance of a false alarm in a night of the whole suite
  std::string test = "wilcoxon";    // or "sign_flip": of means, which great differences sway
  std::string baseline = "window";  // of the same branch, or "branch:NAME", "commit:ID", "night:ID"
  int window = 7;                   // nights whose median is the baseline
  int reach = 120;                  // nights over which creep is looked for
  int failures = 0;                 // runs that may fail which did not before
};

/// What is said of one metric of one scenario and method.
struct MetricVerdict {
  std::string scenario, method;
  SuiteMetric metric;
  std::string kind;       // "pass", "regressed", "crept", "improved", "beyond", "failing", "few" (seeds), "new",
                          // "not comparable"
  std::int64_t runs = 0;  // that have the metric tonight
  double value = std::numeric_limits<double>::quiet_NaN();     // median over seeds; NaN: none
  double baseline = std::numeric_limits<double>::quiet_NaN();  // of the same seeds before
  Spread difference;                                           // tonight - baseline, paired by seed
  double relevant = 0;                                         // smallest difference that matters here
  std::optional<double> p_holm, p_creep;                       // of being no worse, after Holm; none: not in the family
  std::optional<int> worst_seed;                               // with the greatest change for the worse
  std::string words;
};

/// Time that the runs of a scenario and method took and memory that they held, against nights on the same machine and
/// compiler.
struct SpeedVerdict {
  std::string scenario, method;
  double seconds = 0, baseline_s = 0;     // medians; NaN: none
  Spread ratio;                           // paired by seed
  double peak_gib = 0, baseline_gib = 0;  // the same of NightCell::peak_gib
  Spread memory_ratio = {};
};

struct Verdict {
  std::string verdict;   // as Night::verdict
  int exit_code = 0;     // 1: regressed; 3: not comparable
  std::string baseline;  // which nights
  std::vector<MetricVerdict> metric;
  std::vector<SpeedVerdict> speed;
  std::vector<Claim> claims;
  std::vector<std::string> notes;
};

/// Holds a night against the nights before it.
///
/// Baseline of a seed is the median over the last `window` nights of its branch that did not regress, back to the last
/// one that was accepted or that improved. Per metric the differences by seed are put to an exact one-sided test
/// (sign_flip_p, of ranks or of values); Holm's correction runs over all metrics whose differences could reach
/// significance at all (Tarone, Biometrics 46, 1990: that depends on how many seeds changed, not on which way). Worse is
/// what is significant at alpha / 2 and relevant in the median. The other half of alpha goes to creep: the same test
/// against the first `window` nights since the metric was accepted or improved.
/// Nights of another evaluator, or other truths, are never compared.
/// @param past  of the same suite, oldest first
/// @throws Error for a named baseline that there is not
Verdict judge(const Night& tonight, const std::vector<Night>& past, const SuiteRules& rules);

/// Where the median over seeds of a metric's nights makes its greatest step: the index of the first night after it; none
/// for fewer than 2 or where all are equal.
std::optional<size_t> greatest_step(const std::vector<double>& by_night);

/// junit.xml (a case for each scenario, method and metric), verdict.json, verdict.md (for a pull request).
void write_junit(const std::string& file, const Night& night, const Verdict& verdict);
void write_verdict_json(const std::string& file, const Night& night, const Verdict& verdict);
void write_verdict_md(const std::string& file, const Night& night, const Verdict& verdict);

}  // namespace adit
