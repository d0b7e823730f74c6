// SPDX-License-Identifier: BSD-3-Clause
#include "eval/verdict.h"

#include "base/error.h"
#include "eval/metric_list.h"
#include "eval/verdict_nights.h"
#include "eval/verdict_questions.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <set>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

std::string number(double value, int digits = 4) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return std::isfinite(value) ? text : "-";
}

// "0.0283 -> 0.0312, by +0.0029 [0.0018, 0.0041]"
std::string change_words(const MetricVerdict& m) {
  std::string words = number(m.baseline) + " -> " + number(m.value) + ", by " + (m.difference.median > 0 ? "+" : "") +
                      number(m.difference.median, 3);
  if (std::isfinite(m.difference.low))
    words += " [" + number(m.difference.low, 3) + ", " + number(m.difference.high, 3) + "]";
  return words + " over " + std::to_string(m.difference.n) + " seeds";
}

// Everything that is looked at of one scenario and method.
struct Case {
  RunGroup group;
  NightRuns now;
  RunsByNight baseline;  // newest first
  RunsByNight stretch;   // nights that creep is looked for in, oldest first
  std::string obstacle;
};

class Judge {
 public:
  Judge(const Night& tonight, const std::vector<Night>& past, const SuiteRules& rules)
      : tonight_(tonight), past_(past), rules_(rules), level_(rules.alpha / 2) {}

  Verdict all() {
    const std::vector<const Night*> candidates = candidates_of(tonight_, past_, rules_);
    std::vector<RunGroup> groups;  // in the order of the night's cells
    for (const NightCell& c : tonight_.cells)
      if (const RunGroup g{c.scenario, c.method}; std::find(groups.begin(), groups.end(), g) == groups.end())
        groups.push_back(g);
    for (const RunGroup& group : groups) {
      Case c{group, runs_of(tonight_, group), {}, {}, {}};
      ComparableNights comparable = comparable_of(tonight_, c.now, group, candidates);
      if (comparable.nights.size() > static_cast<size_t>(rules_.window))
        comparable.nights.resize(static_cast<size_t>(rules_.window));
      c.baseline = std::move(comparable.nights), c.obstacle = comparable.obstacle;
      c.stretch = stretch_of(tonight_, c.now, group, past_, rules_);
      look_at(c);
      out_.speed.push_back(speed_of(tonight_, c.group, c.now, c.baseline));
      cases_.push_back(std::move(c));
    }
    answer();
    finish();
    return std::move(out_);
  }

 private:
  const Night& tonight_;
  const std::vector<Night>& past_;
  const SuiteRules& rules_;
  double level_;
  Verdict out_;
  std::vector<Case> cases_;
  std::vector<Question> worse_, better_, crept_;
  std::map<size_t, std::pair<double, std::string>> creep_;  // by metric: how much, and the words

  void claim(const MetricVerdict& m) { out_.claims.push_back({m.scenario, m.method, m.metric.name, m.kind, m.words}); }

  void look_at(const Case& c) {
    look_for_failures(c);
    for (const SuiteMetric& metric : rules_.metric) {
      MetricVerdict m;
      m.scenario = c.group.first, m.method = c.group.second, m.metric = metric;
      std::vector<double> values;
      for (const auto& [seed, run] : c.now)
        if (const auto v = value_of(c.now, seed, metric.name)) values.push_back(*v);
      m.runs = static_cast<std::int64_t>(values.size());
      m.value = median_of(values);
      m.difference = spread_of({});
      const SeedPairs pairs = pairs_of(c.now, c.baseline, metric);
      m.kind = !c.obstacle.empty() ? "not comparable" : pairs.seed.empty() ? "new" : "pass";
      if (!pairs.seed.empty()) compare(pairs, m);
      out_.metric.push_back(m);
      look_for_creep(c, out_.metric.size() - 1);
      look_for_losses(c, out_.metric.back());
      look_at_tolerance(c, out_.metric.back());
    }
  }

  void compare(const SeedPairs& pairs, MetricVerdict& m) {
    std::vector<double> difference;
    for (size_t k = 0; k < pairs.now.size(); ++k) difference.push_back(pairs.now[k] - pairs.before[k]);
    m.baseline = median_of(pairs.before);
    m.difference = spread_of(difference);
    m.relevant = relevant_of(m.metric, m.baseline);
    const bool steady = m.metric.better == Direction::steady;
    const auto size = [&](double d) { return steady ? std::abs(d) : d; };
    size_t worst = 0;
    for (size_t k = 1; k < pairs.worse.size(); ++k)
      if (size(pairs.worse[k]) > size(pairs.worse[worst])) worst = k;
    if (size(pairs.worse[worst]) > 0) m.worst_seed = pairs.seed[worst];
    const size_t index = out_.metric.size();
    worse_.push_back(ask(index, pairs.worse, rules_.test, steady));
    if (steady) return;
    std::vector<double> better = pairs.worse;
    for (double& b : better) b = -b;
    better_.push_back(ask(index, better, rules_.test, false));
  }

  // Against the first nights since the metric improved, or was accepted.
  void look_for_creep(const Case& c, size_t index) {
    const MetricVerdict& m = out_.metric[index];
    size_t from = 0;
    for (size_t k = 0; k < c.stretch.size(); ++k)
      for (const Claim& claim : c.stretch[k].first->claims)
        if (claim.kind == "improved" && claim.metric == m.metric.name && claim.scenario == m.scenario &&
            claim.method == m.method)
          from = k;
    const auto window = static_cast<size_t>(rules_.window);
    if (m.kind == "not comparable" || c.stretch.size() < from + 2 * window) return;
    const RunsByNight stretch(c.stretch.begin() + static_cast<std::ptrdiff_t>(from), c.stretch.end());
    const RunsByNight first(stretch.begin(), stretch.begin() + static_cast<std::ptrdiff_t>(window));
    const SeedPairs pairs = pairs_of(c.now, first, m.metric);
    if (pairs.seed.empty()) return;
    const bool steady = m.metric.better == Direction::steady;
    const double median = median_of(pairs.worse), before = median_of(pairs.before);
    if ((steady ? std::abs(median) : median) < relevant_of(m.metric, before)) return ask_creep(index, pairs, steady);
    std::vector<double> by_night;
    for (const auto& [night, runs] : stretch) by_night.push_back(median_of(pairs_of(runs, first, m.metric).now));
    by_night.push_back(median_of(pairs.now));
    const auto step = greatest_step(by_night);
    const Night* since = step && *step < stretch.size() ? stretch[*step].first : &tonight_;
    creep_[index] = {median, "has crept from " + number(before) + " to " + number(median_of(pairs.now)) + " since " +
                                 name_of(*stretch.front().first) + ", its greatest step at " +
                                 (since == &tonight_ ? "tonight" : name_of(*since))};
    ask_creep(index, pairs, steady);
  }
  void ask_creep(size_t index, const SeedPairs& pairs, bool steady) {
    crept_.push_back(ask(index, pairs.worse, rules_.test, steady));
  }

  void look_for_failures(const Case& c) {
    std::string seeds, why;
    int count = 0;
    for (const auto& [seed, run] : c.now) {
      if (run->failure.empty()) continue;
      const auto before = c.baseline.empty() ? NightRuns::const_iterator{} : c.baseline[0].second.find(seed);
      if (!c.baseline.empty() && before != c.baseline[0].second.end() && !before->second->failure.empty()) continue;
      seeds += (count++ ? ", " : "") + std::to_string(seed);
      if (why.empty()) why = run->failure;
    }
    if (count > rules_.failures)
      out_.claims.push_back({c.group.first, c.group.second, "", "failing",
                             std::to_string(count) + " of " + std::to_string(c.now.size()) +
                                 " runs failed which did not before (seeds " + seeds + "); the first: " + why});
  }

  // NightRuns that have a score, but not this metric any more.
  void look_for_losses(const Case& c, MetricVerdict& m) {
    int lost = 0;
    for (const auto& [seed, run] : c.now)
      lost +=
          run->failure.empty() && !value_of(c.now, seed, m.metric.name) && value_of(c.baseline, seed, m.metric.name);
    if (lost <= rules_.failures) return;
    m.kind = "failing";
    m.words = "could not be had in " + std::to_string(lost) + " of " + std::to_string(c.now.size()) +
              " runs that had it before";
  }

  void look_at_tolerance(const Case& c, MetricVerdict& m) {
    double worst = 0;
    int seed_of_worst = 0;
    for (const auto& [seed, run] : c.now) {
      const auto v = value_of(c.now, seed, m.metric.name);
      if (!v || (*v <= m.metric.at_most && *v >= m.metric.at_least)) continue;
      const double by = std::max(*v - m.metric.at_most, m.metric.at_least - *v);
      if (by > worst) worst = by, seed_of_worst = seed;
    }
    if (worst == 0) return;
    const double value = *value_of(c.now, seed_of_worst, m.metric.name);
    m.kind = "beyond";
    m.worst_seed = seed_of_worst;
    m.words =
        number(value) + " at seed " + std::to_string(seed_of_worst) + ", must be " +
        (value > m.metric.at_most ? "at most " + number(m.metric.at_most) : "at least " + number(m.metric.at_least));
  }

  void answer() {
    const std::map<size_t, double> worse = answers(worse_, level_), better = answers(better_, level_),
                                   crept = answers(crept_, level_);
    for (size_t k = 0; k < out_.metric.size(); ++k) {
      MetricVerdict& m = out_.metric[k];
      if (const auto p = worse.find(k); p != worse.end()) m.p_holm = p->second;
      if (const auto p = crept.find(k); p != crept.end()) m.p_creep = p->second;
      if (m.kind != "pass") continue;
      const double by = m.metric.better == Direction::higher   ? -m.difference.median
                        : m.metric.better == Direction::steady ? std::abs(m.difference.median)
                                                               : m.difference.median;
      const double worse_by = m.metric.better == Direction::zero ? median_worse(k) : by;
      if (m.p_holm && *m.p_holm <= level_ && worse_by >= m.relevant)
        m.kind = "regressed", m.words = change_words(m) + ", p " + number(*m.p_holm, 2);
      else if (m.p_creep && *m.p_creep <= level_ && creep_.contains(k))
        m.kind = "crept", m.words = creep_[k].second + ", p " + number(*m.p_creep, 2);
      else if (const auto p = better.find(k); p != better.end() && p->second <= level_ && -worse_by >= m.relevant)
        m.kind = "improved", m.words = change_words(m) + ", p " + number(p->second, 2);
      else if (const double seeds = least_seeds(m.metric.better); static_cast<double>(m.difference.n) < seeds)
        m.kind = "few", m.words = change_words(m) + "; a verdict needs " + number(seeds, 3) + " seeds";
      else
        m.words = change_words(m);
    }
  }

  // With which a metric that changes in every seed the same way is significant among all.
  double least_seeds(Direction better) const {
    const double ways = better == Direction::steady ? 2 : 1;
    return std::ceil(std::log2(ways * static_cast<double>(worse_.size()) / level_));
  }

  // Of a number that is good near 0: by how much its distance from 0 grew.
  double median_worse(size_t index) const {
    const MetricVerdict& m = out_.metric[index];
    for (const Case& c : cases_)
      if (c.group == RunGroup{m.scenario, m.method}) return median_of(pairs_of(c.now, c.baseline, m.metric).worse);
    return none;
  }

  void finish() {
    bool bad = !out_.claims.empty(), apart = false, good = false, first = true;
    for (const MetricVerdict& m : out_.metric) {
      if (m.kind == "regressed" || m.kind == "crept" || m.kind == "beyond" || m.kind == "failing") bad = true, claim(m);
      if (m.kind == "improved") good = true, claim(m);
      apart |= m.kind == "not comparable";
      first &= m.kind == "new";
    }
    std::set<std::string> nights;
    for (const Case& c : cases_) {
      if (!c.obstacle.empty()) {
        out_.claims.push_back({c.group.first, c.group.second, "", "not comparable", c.obstacle});
        apart = true;
      }
      for (const auto& [night, runs] : c.baseline) nights.insert(name_of(*night));
      if (!c.baseline.empty()) first = false;
    }
    for (const std::string& n : nights) out_.baseline += (out_.baseline.empty() ? "" : ", ") + n;
    out_.verdict = bad ? "regressed" : apart ? "not comparable" : good ? "improved" : first ? "first" : "pass";
    out_.exit_code = bad ? 1 : apart ? 3 : 0;
    if (first && !apart) out_.notes.push_back("Nothing in the history to compare with: this night is the baseline.");
    const bool few = std::any_of(out_.metric.begin(), out_.metric.end(), [](const auto& m) { return m.kind == "few"; });
    if (few)
      out_.notes.push_back("Some metrics have too few seeds for a verdict; they are held to their tolerances alone.");
    for (const SpeedVerdict& s : out_.speed) {
      if (s.ratio.low > 1.2)
        out_.notes.push_back(s.scenario + ", " + s.method + ": runs take " + number(100 * (s.ratio.median - 1), 3) +
                             " % longer than before on this machine.");
      if (s.memory_ratio.low > 1.2)
        out_.notes.push_back(s.scenario + ", " + s.method + ": runs hold " +
                             number(100 * (s.memory_ratio.median - 1), 3) +
                             " % more memory than before on this machine.");
    }
  }
};

}  // namespace

Verdict judge(const Night& tonight, const std::vector<Night>& past, const SuiteRules& rules) {
  ADIT_CHECK(rules.window > 0 && rules.alpha > 0 && rules.alpha < 1);
  return Judge(tonight, past, rules).all();
}

std::optional<size_t> greatest_step(const std::vector<double>& by_night) {
  // The split whose two means leave the least squares.
  std::vector<double> sum{0};
  for (const double v : by_night) sum.push_back(sum.back() + v);
  const auto n = static_cast<double>(by_night.size());
  std::optional<size_t> best;
  double most = 0;
  for (size_t k = 1; k < by_night.size(); ++k) {
    const auto before = static_cast<double>(k);
    const double step = (sum.back() - sum[k]) / (n - before) - sum[k] / before;
    const double gain = step * step * before * (n - before) / n;
    if (gain > most) most = gain, best = k;
  }
  return best;
}

}  // namespace adit
