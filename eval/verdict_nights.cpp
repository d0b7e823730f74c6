// SPDX-License-Identifier: BSD-3-Clause
#include "eval/verdict_nights.h"

#include "base/error.h"
#include "eval/metric_list.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

bool regressed(const Night& n) {
  return n.verdict == "regressed" && n.accepted.empty();
}

// Why two nights of a group must not be compared; empty: they may.
std::string obstacle(const Night& tonight, const NightRuns& now, const Night& then, const NightRuns& before) {
  if (tonight.evaluator != then.evaluator)
    return "the evaluator is another one than at " + name_of(then) + ": " + tonight.evaluator + " against " +
           then.evaluator;
  for (const auto& [seed, run] : now) {
    const auto other = before.find(seed);
    if (other == before.end() || run->truth.empty() || other->second->truth.empty()) continue;
    if (run->truth != other->second->truth)
      return "the truth of seed " + std::to_string(seed) + " is another one than at " + name_of(then);
  }
  return "";
}

double badness(Direction better, double value) {
  switch (better) {
    case Direction::higher:
      return -value;
    case Direction::zero:
      return std::abs(value);
    default:
      return value;
  }
}

// What a number of the runs is tonight, and in nights on the same machine; paired by seed.
struct Costs {
  double now, before;
  Spread ratio;
};

Costs costs_of(const Night& tonight, const NightRuns& now, const RunsByNight& baseline, double NightCell::*number) {
  const auto known = [&](const NightCell* run) { return std::isfinite(run->*number) && run->*number > 0; };
  std::vector<double> values, before, ratio;
  for (const auto& [seed, run] : now) {
    if (!known(run) || !run->failure.empty()) continue;
    values.push_back(run->*number);
    std::vector<double> then;
    for (const auto& [night, runs] : baseline)
      if (night->machine == tonight.machine && night->compiler == tonight.compiler)
        if (const auto other = runs.find(seed); other != runs.end() && known(other->second))
          then.push_back(other->second->*number);
    if (then.empty()) continue;
    before.push_back(median_of(then));
    ratio.push_back(run->*number / before.back());
  }
  return {median_of(values), median_of(before), spread_of(ratio)};
}

}  // namespace

double median_of(std::vector<double> values) {
  return quantile(values, 0.5);
}

NightRuns runs_of(const Night& night, const RunGroup& group) {
  NightRuns runs;
  for (const NightCell& c : night.cells)
    if (c.scenario == group.first && c.method == group.second) runs[c.seed] = &c;
  return runs;
}

std::string name_of(const Night& n) {
  return "night " + std::to_string(n.id) + (n.commit.empty() ? "" : " (" + n.commit.substr(0, 12) + ")");
}

std::vector<const Night*> candidates_of(const Night& tonight, const std::vector<Night>& past, const SuiteRules& rules) {
  const size_t colon = rules.baseline.find(':');
  const std::string kind = rules.baseline.substr(0, colon),
                    name = colon == std::string::npos ? "" : rules.baseline.substr(colon + 1);
  if (kind != "window" && (name.empty() || (kind != "branch" && kind != "commit" && kind != "night")))
    throw Error("baseline '" + rules.baseline + "': must be window, branch:NAME, commit:ID or night:ID");
  const bool named = kind == "commit" || kind == "night";
  const std::string branch = kind == "branch" ? name : tonight.branch;
  std::vector<const Night*> found;
  for (size_t k = past.size(); k-- > 0;) {
    const Night& n = past[k];
    if (kind == "commit"  ? !n.commit.starts_with(name)
        : kind == "night" ? std::to_string(n.id) != name
                          : n.branch != branch || regressed(n))
      continue;
    found.push_back(&n);
    if (!named && (!n.accepted.empty() || n.verdict == "improved")) break;
  }
  if (found.empty() && kind != "window")
    throw Error("baseline '" + rules.baseline + "': the history has no such night" +
                (kind == "branch" ? " that did not regress" : ""));
  return found;
}

ComparableNights comparable_of(const Night& tonight, const NightRuns& now, const RunGroup& group,
                               const std::vector<const Night*>& nights) {
  ComparableNights out;
  for (const Night* n : nights) {
    NightRuns runs = runs_of(*n, group);
    if (runs.empty()) continue;
    const std::string why = obstacle(tonight, now, *n, runs);
    if (why.empty())
      out.nights.emplace_back(n, std::move(runs));
    else if (out.obstacle.empty())
      out.obstacle = why;
  }
  if (!out.nights.empty()) out.obstacle.clear();
  return out;
}

std::optional<double> value_of(const NightRuns& runs, int seed, const std::string& metric) {
  const auto run = runs.find(seed);
  if (run == runs.end()) return {};
  const auto value = run->second->value.find(metric);
  return value == run->second->value.end() || !std::isfinite(value->second) ? std::nullopt
                                                                            : std::optional<double>(value->second);
}

std::optional<double> value_of(const RunsByNight& nights, int seed, const std::string& metric) {
  std::vector<double> values;
  for (const auto& [night, runs] : nights)
    if (const auto v = value_of(runs, seed, metric)) values.push_back(*v);
  if (values.empty()) return {};
  return median_of(values);
}

SeedPairs pairs_of(const NightRuns& now, const RunsByNight& before, const SuiteMetric& metric) {
  SeedPairs out;
  for (const auto& [seed, run] : now) {
    const auto a = value_of(now, seed, metric.name), b = value_of(before, seed, metric.name);
    if (!a || !b) continue;
    out.seed.push_back(seed);
    out.now.push_back(*a), out.before.push_back(*b);
    out.worse.push_back(badness(metric.better, *a) - badness(metric.better, *b));
  }
  return out;
}

double relevant_of(const SuiteMetric& m, double baseline) {
  return std::max(m.relevant, std::isfinite(baseline) ? m.relevant_percent / 100 * std::abs(baseline) : 0);
}

RunsByNight stretch_of(const Night& tonight, const NightRuns& now, const RunGroup& group,
                       const std::vector<Night>& past, const SuiteRules& rules) {
  if (rules.baseline != "window" && !rules.baseline.starts_with("branch:")) return {};
  const std::string branch = rules.baseline == "window" ? tonight.branch : rules.baseline.substr(7);
  std::vector<const Night*> nights;
  for (size_t k = past.size(); k-- > 0 && static_cast<int>(nights.size()) < rules.reach;) {
    if (past[k].branch != branch || regressed(past[k])) continue;
    nights.push_back(&past[k]);
    if (!past[k].accepted.empty()) break;
  }
  RunsByNight found = comparable_of(tonight, now, group, nights).nights;
  std::reverse(found.begin(), found.end());
  return found;
}

SpeedVerdict speed_of(const Night& tonight, const RunGroup& group, const NightRuns& now, const RunsByNight& baseline) {
  const Costs time = costs_of(tonight, now, baseline, &NightCell::seconds),
              memory = costs_of(tonight, now, baseline, &NightCell::peak_gib);
  return {group.first, group.second, time.now, time.before, time.ratio, memory.now, memory.before, memory.ratio};
}

}  // namespace adit
