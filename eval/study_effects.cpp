// SPDX-License-Identifier: BSD-3-Clause
#include "eval/study_effects.h"

#include "eval/metric_list.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <utility>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr size_t most_levels = 8;  // a factor of more numbers is taken in thirds

// (points) The level of a factor by which effects are told: its own, or of many numbers the third that it lies in.
std::vector<std::string> groups_of(const StudyTable& t, size_t factor) {
  std::vector<std::string> groups;
  std::vector<double> numbers;
  for (const StudyPoint& p : t.point) groups.push_back(p.level[factor]);
  for (const std::string& level : groups) {
    char* end = nullptr;
    numbers.push_back(std::strtod(level.c_str(), &end));
    if (*end != '\0') return groups;
  }
  std::vector<double> sorted = numbers;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() <= most_levels) return groups;
  const double low = quantile(sorted, 1.0 / 3), high = quantile(sorted, 2.0 / 3);
  for (size_t p = 0; p < groups.size(); ++p)
    groups[p] = numbers[p] < low ? "lower third" : numbers[p] < high ? "middle third" : "upper third";
  return groups;
}

// One run's value with what is common to its seed taken off, and its point.
struct Observed {
  double value;
  size_t point;
};

std::vector<Observed> observed(const StudyTable& t, size_t metric) {
  std::map<int, std::pair<double, double>> of_seed;  // sum, count
  for (const StudyCell& c : t.cell)
    if (c.failure.empty() && std::isfinite(c.value[metric]))
      of_seed[c.seed].first += c.value[metric], of_seed[c.seed].second += 1;
  std::vector<Observed> all;
  for (const StudyCell& c : t.cell)
    if (c.failure.empty() && std::isfinite(c.value[metric]))
      all.push_back({c.value[metric] - of_seed[c.seed].first / of_seed[c.seed].second, c.point});
  return all;
}

// The sum of squares that the means of groups account for.
template <class Key>
double between(const std::vector<Observed>& all, const Key& key) {
  std::map<std::string, std::pair<double, double>> group;
  double sum = 0;
  for (const Observed& o : all) {
    auto& [total, n] = group[key(o)];
    total += o.value, n += 1, sum += o.value;
  }
  double squares = 0;
  const double mean = all.empty() ? 0 : sum / static_cast<double>(all.size());
  for (const auto& [name, g] : group) squares += g.second * (g.first / g.second - mean) * (g.first / g.second - mean);
  return squares;
}

}  // namespace

void add_effects(const StudyTable& t, size_t metric, size_t objective, StudyAnswer& answer) {
  const std::vector<Observed> all = observed(t, metric);
  double squares = 0;
  for (const Observed& o : all) squares += o.value * o.value;  // their mean is 0
  const auto share = [&](double part) { return squares > 0 ? part / squares : none; };
  std::vector<double> own(t.factor.size());
  std::vector<std::vector<std::string>> group;
  for (size_t f = 0; f < t.factor.size(); ++f) {
    group.push_back(groups_of(t, f));
    own[f] = between(all, [&](const Observed& o) { return group[f][o.point]; });
    StudyAnswer::Effect effect{f, objective, {}, share(own[f])};
    std::vector<std::string> names;
    for (const std::string& name : group[f])
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    for (const std::string& name : names) {
      std::vector<double> values;
      for (const StudyCell& c : t.cell)
        if (c.failure.empty() && group[f][c.point] == name && std::isfinite(c.value[metric]))
          values.push_back(c.value[metric]);
      effect.level.push_back({name, spread_of(values)});
    }
    if (names.size() > 1) answer.effect.push_back(std::move(effect));
  }
  for (size_t a = 0; a < t.factor.size(); ++a)
    for (size_t b = a + 1; b < t.factor.size(); ++b) {
      const double both = between(all, [&](const Observed& o) { return group[a][o.point] + "\n" + group[b][o.point]; });
      if (own[a] > 0 && own[b] > 0)
        answer.interaction.push_back({a, b, objective, share(std::max(0.0, both - own[a] - own[b]))});
    }
}

}  // namespace adit
