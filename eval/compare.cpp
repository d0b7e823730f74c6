// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare.h"

#include "base/error.h"
#include "base/rng.h"
#include "eval/metric_list.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr int bootstrap_samples = 2000, least_for_interval = 5, most_exact = 16, drawn_patterns = 1 << 16;

std::vector<std::string> lines_of(const std::string& settings) {
  std::vector<std::string> lines;
  std::istringstream text(settings);
  std::string table;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("["))
      table = line.substr(1, line.find(']') - 1) + ".";
    else if (line.find('=') != std::string::npos)
      lines.push_back(table + line);
  }
  return lines;
}

// The settings of `other` that are not those of `first`, "key = value" each.
std::string difference_of(const std::string& first, const std::string& other) {
  const std::vector<std::string> known = lines_of(first);
  const std::set<std::string> same(known.begin(), known.end());
  std::string out;
  for (const std::string& line : lines_of(other))
    if (!same.contains(line)) out += (out.empty() ? "" : ", ") + line;
  return out;
}

std::string truth_of(const Score& score) {
  for (const auto& [key, value] : score.meta)
    if (key == "truth_hash") return value;
  return "";
}

double badness(const Metric& m) {
  return badness(m.name, m.better, m.value);
}

using Runs = std::map<int, const ScoredRun*>;  // by seed

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? none : sum / static_cast<double>(values.size());
}

// Mean over deviation: Cohen's d of paired values.
double effect_of(const std::vector<double>& differences) {
  const double mean = mean_of(differences);
  double squares = 0;
  for (const double d : differences) squares += (d - mean) * (d - mean);
  const auto n = static_cast<double>(differences.size());
  return n > 1 && squares > 0 ? mean / std::sqrt(squares / (n - 1)) : none;
}

// What nobody would act on, whatever the metric.
double least_relevant(const std::string& unit) {
  static const std::map<std::string, double> by_unit{{"m", 0.005},     {"deg", 0.05},   {"deg/m", 0.005},
                                                     {"percent", 0.5}, {"share", 0.01}, {"ratio", 0.01},
                                                     {"count", 0.5},   {"m3", 1}};
  const auto found = by_unit.find(unit);
  return found == by_unit.end() ? 0 : found->second;
}

struct Paired {
  ComparedMetric::Group group;
  std::vector<double> worse;  // by how much each pair is worse than the first group
};

Paired group_of(const std::string& name, const Runs& runs, const Runs& first) {
  Paired paired;
  ComparedMetric::Group& out = paired.group;
  std::vector<double> values, differences;
  double worst = -std::numeric_limits<double>::infinity();
  for (const auto& [seed, run] : runs) {
    if (!run->score) continue;
    const Metric* m = run->score->find(name);
    if (!m || !std::isfinite(m->value)) {
      ++out.missing;
      continue;
    }
    values.push_back(m->value);
    if (badness(*m) > worst) worst = badness(*m), out.worst_seed = seed;
    const auto pair = first.find(seed);
    const Metric* other =
        &runs != &first && pair != first.end() && pair->second->score ? pair->second->score->find(name) : nullptr;
    if (!other || !std::isfinite(other->value)) continue;
    differences.push_back(m->value - other->value);
    paired.worse.push_back(badness(*m) - badness(*other));
  }
  if (std::all_of(values.begin(), values.end(), [&](double v) { return v == values.front(); })) out.worst_seed.reset();
  out.value = spread_of(values);
  out.mean = mean_of(values);
  out.difference = spread_of(differences);
  out.effect = effect_of(differences);
  out.p = sign_flip_p(paired.worse);
  return paired;
}

std::string verdict_of(const Paired& paired, double relevant) {
  const Spread worse = spread_of(paired.worse);
  if (worse.n == 0) return "unclear";
  const double p = paired.group.p_holm.value_or(paired.group.p);
  if (p <= 0.05 && std::abs(worse.median) >= relevant) return worse.median > 0 ? "worse" : "better";
  const bool all_equal = std::all_of(paired.worse.begin(), paired.worse.end(), [](double d) { return d == 0; });
  if (all_equal || (std::isfinite(worse.low) && worse.low > -relevant && worse.high < relevant)) return "same";
  return "unclear";
}

ComparedMetric compared(const Metric& like, const std::vector<Runs>& groups, std::vector<Paired>& paired) {
  ComparedMetric out{like.name, like.unit, like.better, 0, {}};
  paired.clear();
  for (const Runs& group : groups) paired.push_back(group_of(like.name, group, groups[0]));
  const double median = paired[0].group.value.median;
  out.relevant = std::max(least_relevant(like.unit), std::isfinite(median) ? 0.05 * std::abs(median) : 0);
  return out;
}

}  // namespace

double badness(const std::string& name, Better better, double value) {
  const bool by_size = name.find("bias") != std::string::npos || name.ends_with("error_percent");
  return better == Better::higher ? -value : by_size ? std::abs(value) : value;
}

Spread spread_of(const std::vector<double>& values) {
  Spread s;
  s.n = static_cast<std::int64_t>(values.size());
  std::vector<double> sorted = values;
  std::sort(sorted.begin(), sorted.end());
  s.median = quantile(sorted, 0.5);
  s.low = s.high = none;
  if (s.n < least_for_interval) return s;
  std::vector<double> medians, sample(values.size());
  for (int b = 0; b < bootstrap_samples; ++b) {
    for (size_t k = 0; k < sample.size(); ++k) {
      const double u = uniform(0, Draw::bootstrap, static_cast<std::uint64_t>(b), k);
      sample[k] = sorted[static_cast<size_t>(u * static_cast<double>(sorted.size()))];
    }
    medians.push_back(quantile(sample, 0.5));
  }
  s.low = quantile(medians, 0.025);
  s.high = quantile(medians, 0.975);
  return s;
}

std::vector<double> holm(const std::vector<double>& p) {
  std::vector<size_t> order(p.size());
  for (size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return p[a] < p[b]; });
  std::vector<double> out(p.size());
  double most = 0;
  for (size_t k = 0; k < order.size(); ++k) {
    most = std::max(most, std::min(1.0, static_cast<double>(p.size() - k) * p[order[k]]));
    out[order[k]] = most;
  }
  return out;
}

namespace {

// The sum under every pattern of signs, each summed in the same order.
std::vector<double> all_sums(const std::vector<double>& values) {
  std::vector<double> sums{0};
  for (const double v : values) {
    const size_t half = sums.size();
    sums.resize(2 * half);
    for (size_t k = 0; k < half; ++k) sums[half + k] = sums[k] + v, sums[k] -= v;
  }
  return sums;
}

std::vector<double> drawn_sums(const std::vector<double>& values) {
  std::vector<double> sums(drawn_patterns, 0.0);
  for (std::uint64_t k = 0; k < sums.size(); ++k) {
    std::uint64_t signs = 0;
    for (size_t i = 0; i < values.size(); ++i, signs >>= 1U) {
      if (i % 64 == 0) signs = random_bits(1, Draw::bootstrap, k, i / 64);
      sums[k] += signs & 1U ? values[i] : -values[i];
    }
  }
  return sums;
}

}  // namespace

double sign_flip_p(const std::vector<double>& differences, Tail tail) {
  const size_t n = differences.size();
  if (n == 0) return 1;
  double sum = 0, size = 0;
  for (const double d : differences) sum += d, size += std::abs(d);
  const bool exact = n <= most_exact;
  const std::vector<double> flipped = exact ? all_sums(differences) : drawn_sums(differences);
  const double slack = 1e-12 * size;  // of sums that are equal but for rounding
  const auto as_far = std::count_if(flipped.begin(), flipped.end(), [&](double f) {
    return tail == Tail::both ? std::abs(f) >= std::abs(sum) - slack : f >= sum - slack;
  });
  // Drawn patterns: the one that was seen counts as one of them, so that p is never 0.
  const auto patterns = static_cast<double>(flipped.size()), far = static_cast<double>(as_far);
  return exact ? far / patterns : (far + 1) / (patterns + 1);
}

std::vector<double> signed_ranks(const std::vector<double>& differences) {
  std::vector<double> sizes;
  for (const double d : differences) sizes.push_back(std::abs(d));
  std::sort(sizes.begin(), sizes.end());
  std::vector<double> ranks;
  for (const double d : differences) {
    const auto [low, high] = std::equal_range(sizes.begin(), sizes.end(), std::abs(d));
    const double rank = 0.5 * static_cast<double>((low - sizes.begin()) + (high - sizes.begin()) + 1);
    ranks.push_back(d == 0 ? 0 : std::copysign(rank, d));
  }
  return ranks;
}

Comparison compare_runs(const std::vector<ScoredRun>& runs, const std::vector<std::string>& suite) {
  Comparison out;
  std::vector<std::string> settings;
  std::vector<Runs> groups;
  for (const ScoredRun& run : runs) {
    const auto known = std::find(settings.begin(), settings.end(), run.settings);
    const auto g = static_cast<size_t>(known - settings.begin());
    if (known == settings.end()) {
      settings.push_back(run.settings);
      groups.emplace_back();
      out.group.push_back({g == 0 ? "" : difference_of(settings[0], run.settings), {}, {}});
    }
    const auto [there, fresh] = groups[g].emplace(run.seed, &run);
    if (!fresh)
      throw Error(run.folder + " and " + there->second->folder + " are runs of the same settings and seed " +
                  std::to_string(run.seed) + "; each may be given once");
    if (run.score && groups[0].contains(run.seed) && groups[0][run.seed]->score &&
        out.group[g].label.find("world.") == std::string::npos &&
        truth_of(*run.score) != truth_of(*groups[0][run.seed]->score))
      throw Error(run.folder + " was scored against another mine than " + groups[0][run.seed]->folder +
                      " though their settings of the mine are the same: they come from different versions",
                  Fault::not_comparable);
  }
  for (size_t g = 0; g < groups.size(); ++g)
    for (const auto& [seed, run] : groups[g]) {
      out.group[g].seed.push_back(seed);
      if (!run->score) out.group[g].failed.push_back(seed);
    }
  std::set<std::string> named;
  std::vector<std::vector<Paired>> all;  // (metric) (group)
  for (const ScoredRun& run : runs) {
    if (!run.score) continue;
    for (const Metric& m : run.score->metrics) {
      if (!named.insert(m.name).second) continue;
      out.metric.push_back(compared(m, groups, all.emplace_back()));
    }
  }
  for (size_t g = 1; g < groups.size(); ++g) {
    std::vector<double> p;
    std::vector<size_t> of;
    for (size_t k = 0; k < out.metric.size(); ++k) {
      const bool judged = std::find(suite.begin(), suite.end(), out.metric[k].name) != suite.end();
      if (judged && all[k][g].group.difference.n > 0) p.push_back(all[k][g].group.p), of.push_back(k);
    }
    const std::vector<double> together = holm(p);
    for (size_t k = 0; k < of.size(); ++k) all[of[k]][g].group.p_holm = together[k];
  }
  for (size_t k = 0; k < out.metric.size(); ++k)
    for (size_t g = 0; g < groups.size(); ++g) {
      if (g > 0) all[k][g].group.verdict = verdict_of(all[k][g], out.metric[k].relevant);
      out.metric[k].group.push_back(std::move(all[k][g].group));
    }
  return out;
}

}  // namespace adit
