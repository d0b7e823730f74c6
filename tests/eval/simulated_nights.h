// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/rng.h"
#include "eval/verdict.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

namespace adit {

/// Nights whose truth is known: metrics m0, m1, ... that are good when low, about 1 each, of seeds that differ by 30 %.
struct Simulation {
  int seeds = 12, metrics = 10;
  double noise = 0.01;  // sd of a value from night to night, half of it shared by all metrics of a seed
  std::uint64_t chance = 1;
  std::function<double(int metric, int night)> factor = [](int, int) { return 1.0; };

  double value(int metric, int seed, int night) const {
    const auto draw = [&](int n, int m) {
      return normal(chance, Draw::test, static_cast<std::uint64_t>(n), static_cast<std::uint64_t>(1000 * m + seed));
    };
    const double mine = std::exp(0.3 * draw(1000000, metric));
    // Now and then a run goes wrong by a lot, in either direction.
    const double own = draw(night, metric), tail = std::abs(own) > 2 ? 5 : 1;
    return mine * factor(metric, night) * (1 + noise * std::sqrt(0.5) * (tail * own + draw(night, 900)));
  }

  Night night(int k) const {
    Night n;
    n.id = k, n.suite = "simulated", n.branch = "main", n.commit = "c" + std::to_string(k), n.version = "1";
    n.evaluator = "evaluator 1", n.machine = "box", n.compiler = "gcc", n.date = "";
    for (int s = 1; s <= seeds; ++s) {
      NightCell cell{"mini", "adit", s, "truth" + std::to_string(s), "", "", 20, {}};
      for (int m = 0; m < metrics; ++m) cell.value["m" + std::to_string(m)] = value(m, s, k);
      n.cells.push_back(cell);
    }
    return n;
  }

  SuiteRules rules(double relevant_percent = 0) const {
    SuiteRules r;
    for (int m = 0; m < metrics; ++m) {
      r.metric.push_back({});
      r.metric.back().name = "m" + std::to_string(m);
      r.metric.back().relevant_percent = relevant_percent;
    }
    return r;
  }
};

/// Judges a night and puts it behind the others, as the command does.
inline Verdict live_through(Night night, std::vector<Night>& past, const SuiteRules& rules) {
  const Verdict v = judge(night, past, rules);
  night.verdict = v.verdict, night.claims = v.claims;
  past.push_back(std::move(night));
  return v;
}

}  // namespace adit
