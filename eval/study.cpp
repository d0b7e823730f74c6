// SPDX-License-Identifier: BSD-3-Clause
#include "eval/study.h"

#include "base/error.h"
#include "base/rng.h"
#include "eval/metric_list.h"
#include "eval/study_effects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr int front_samples = 200, rho_samples = 2000;

// Where an objective is found.
struct Source {
  enum Kind { metric, fast, price, mass } kind;
  size_t index = 0;
  StudyColumn column;
};

Source source_of(const StudyTable& t, const std::string& name) {
  if (name == "price") return {Source::price, 0, {name, "", Better::lower}};
  if (name == "mass_kg") return {Source::mass, 0, {name, "kg", Better::lower}};
  for (size_t i = 0; i < fast_columns().size(); ++i)
    if (fast_columns()[i].name == name) return {Source::fast, i, fast_columns()[i]};
  for (size_t i = 0; i < t.metric.size(); ++i)
    if (t.metric[i].name == name) return {Source::metric, i, t.metric[i]};
  throw Error("objective '" + name +
              "' is no metric of any score of this study ('adit list metrics'), none of fast.*, price, mass_kg");
}

// Values of a point, one for each of its runs that has it; one alone for what does not depend on the seed.
std::vector<double> values_of(const StudyTable& t, const Source& source, size_t point,
                              const std::vector<const StudyCell*>& cells) {
  const StudyPoint& p = t.point[point];
  const double still = source.kind == Source::price  ? p.price
                       : source.kind == Source::mass ? p.mass_kg
                       : source.kind == Source::fast ? p.fast[source.index]
                                                     : none;
  if (source.kind != Source::metric) return std::isfinite(still) ? std::vector<double>{still} : std::vector<double>{};
  std::vector<double> values;
  for (const StudyCell* c : cells)
    if (c->failure.empty() && std::isfinite(c->value[source.index])) values.push_back(c->value[source.index]);
  return values;
}

double median_of(std::vector<double> values) {
  return quantile(values, 0.5);
}

// Rows of badness: the objectives' medians, what is missing being worst, and the share of failures.
std::vector<double> row_of(const StudyTable& t, const std::vector<Source>& sources, size_t point,
                           const std::vector<const StudyCell*>& cells) {
  std::vector<double> row;
  for (const Source& s : sources) {
    const double v = median_of(values_of(t, s, point, cells));
    row.push_back(std::isfinite(v) ? badness(s.column.name, s.column.better, v)
                                   : std::numeric_limits<double>::infinity());
  }
  const auto failed = std::count_if(cells.begin(), cells.end(), [](const auto* c) { return !c->failure.empty(); });
  row.push_back(cells.empty() ? 0 : static_cast<double>(failed) / static_cast<double>(cells.size()));
  return row;
}

// Ranks from 1, ties sharing their mean.
std::vector<double> ranks(const std::vector<double>& v) {
  std::vector<size_t> order(v.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return v[a] < v[b]; });
  std::vector<double> rank(v.size());
  for (size_t i = 0; i < order.size();) {
    size_t j = i;
    while (j < order.size() && v[order[j]] == v[order[i]]) ++j;
    for (size_t k = i; k < j; ++k) rank[order[k]] = 0.5 * static_cast<double>(i + j + 1);
    i = j;
  }
  return rank;
}

double correlation(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  double ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
  for (size_t i = 0; i < a.size(); ++i) ma += a[i] / n, mb += b[i] / n;
  for (size_t i = 0; i < a.size(); ++i) {
    aa += (a[i] - ma) * (a[i] - ma), bb += (b[i] - mb) * (b[i] - mb), ab += (a[i] - ma) * (b[i] - mb);
  }
  return aa > 0 && bb > 0 ? ab / std::sqrt(aa * bb) : none;
}

size_t drawn(size_t n, size_t sample, size_t i) {
  return std::min(n - 1, static_cast<size_t>(uniform(0, Draw::bootstrap, sample, i) * static_cast<double>(n)));
}

using CellsOfPoint = std::vector<std::vector<const StudyCell*>>;

void judge_points(const StudyTable& t, const std::vector<Source>& sources, const CellsOfPoint& cells,
                  StudyAnswer& answer) {
  const size_t n = t.point.size();
  std::vector<std::vector<double>> rows(n);
  for (size_t p = 0; p < n; ++p) {
    StudyAnswer::Point& point = answer.point[p];
    for (const Source& s : sources) point.value.push_back(spread_of(values_of(t, s, p, cells[p])));
    point.runs = cells[p].size();
    for (const StudyCell* c : cells[p]) point.failed += !c->failure.empty();
    rows[p] = row_of(t, sources, p, cells[p]);
  }
  const std::vector<bool> front = pareto_front(rows);
  for (size_t p = 0; p < n; ++p) answer.point[p].front = front[p];
  for (size_t o = 0; o <= sources.size() && n > 0; ++o) {
    std::vector<double> column(n);
    for (size_t p = 0; p < n; ++p) column[p] = rows[p][o];
    const std::vector<double> rank = ranks(column);
    for (size_t p = 0; p < n; ++p) answer.point[p].rank += rank[p] / static_cast<double>(sources.size() + 1);
  }
  for (size_t p = 0; p < n; ++p) {
    // A study by geometry alone has no runs: its points are judged by what geometry tells of them.
    const bool judged = cells[p].empty()
                            ? std::any_of(rows[p].begin(), rows[p].end() - 1, [](double v) { return std::isfinite(v); })
                            : answer.point[p].failed < cells[p].size();
    if (!judged) continue;
    if (front[p] && (!answer.best || answer.point[p].rank < answer.point[*answer.best].rank)) answer.best = p;
    if (!answer.worst || answer.point[p].rank > answer.point[*answer.worst].rank) answer.worst = p;
  }
  // Seeds are drawn for all points together: they share their mines.
  std::set<int> seeds;
  for (const StudyCell& c : t.cell) seeds.insert(c.seed);
  const std::vector<int> all(seeds.begin(), seeds.end());
  std::vector<size_t> times(n, 0);
  for (size_t b = 0; b < front_samples && !all.empty(); ++b) {
    for (size_t p = 0; p < n; ++p) {
      std::vector<const StudyCell*> some;
      for (size_t k = 0; k < all.size(); ++k)
        for (const StudyCell* c : cells[p])
          if (c->seed == all[drawn(all.size(), b, k)]) some.push_back(c);
      rows[p] = row_of(t, sources, p, some);
    }
    const std::vector<bool> sampled = pareto_front(rows);
    for (size_t p = 0; p < n; ++p) times[p] += sampled[p];
  }
  for (size_t p = 0; p < n; ++p) answer.point[p].front_share = static_cast<double>(times[p]) / front_samples;
}

StudyAnswer::Agreement agreement_of(const StudyTable& t, size_t fast, const Source& s, const CellsOfPoint& cells) {
  const StudyColumn& column = fast_columns()[fast];
  std::vector<double> a, b;
  for (size_t p = 0; p < t.point.size(); ++p) {
    const double predicted = t.point[p].fast[fast], found = median_of(values_of(t, s, p, cells[p]));
    if (!std::isfinite(predicted) || !std::isfinite(found)) continue;
    a.push_back(badness(column.name, column.better, predicted));
    b.push_back(badness(s.column.name, s.column.better, found));
  }
  StudyAnswer::Agreement agreement{column.name, s.column.name, a.size(), none, none, none};
  if (a.size() < 4) return agreement;
  agreement.rho = spearman(a, b);
  std::vector<double> sampled;
  for (size_t k = 0; k < rho_samples; ++k) {
    std::vector<double> x, y;
    for (size_t i = 0; i < a.size(); ++i) {
      const size_t from = drawn(a.size(), k, i);
      x.push_back(a[from]), y.push_back(b[from]);
    }
    if (const double rho = spearman(x, y); std::isfinite(rho)) sampled.push_back(rho);
  }
  if (std::isfinite(agreement.rho) && !sampled.empty())
    agreement.low = quantile(sampled, 0.025), agreement.high = quantile(sampled, 0.975);
  return agreement;
}

// What tells two groups apart is the point's number; Score::meta is left out: rigs are compared across drives too.
Comparison comparison_of(const StudyTable& t, const std::vector<Source>& sources) {
  std::vector<ScoredRun> runs;
  for (size_t p = 0; p < t.point.size(); ++p) {
    std::string levels;
    for (size_t f = 0; f < t.factor.size(); ++f) levels += t.factor[f] + " = " + t.point[p].level[f] + "\n";
    for (const StudyCell& c : t.cell) {
      if (c.point != p) continue;
      ScoredRun run{c.name, levels, c.seed, {}};
      if (c.failure.empty()) {
        run.score.emplace();
        for (const Source& s : sources)
          if (s.kind == Source::metric)
            run.score->metrics.push_back(
                {s.column.name, c.value[s.index], s.column.unit, s.column.better, 1, "not in the score"});
      }
      runs.push_back(std::move(run));
    }
  }
  std::vector<std::string> suite;
  for (const Source& s : sources)
    if (s.kind == Source::metric) suite.push_back(s.column.name);
  return runs.empty() ? Comparison{} : compare_runs(runs, suite);
}

}  // namespace

const std::vector<StudyColumn>& fast_columns() {
  static const std::vector<StudyColumn> columns{{"fast.value", "", Better::higher},
                                                {"fast.information", "share", Better::higher},
                                                {"fast.surface", "share", Better::higher},
                                                {"fast.volume", "share", Better::higher},
                                                {"fast.sigma_along_m", "m", Better::lower},
                                                {"fast.sigma_across_m", "m", Better::lower},
                                                {"fast.sigma_up_m", "m", Better::lower},
                                                {"fast.sigma_roll_deg", "deg", Better::lower},
                                                {"fast.sigma_pitch_deg", "deg", Better::lower},
                                                {"fast.sigma_yaw_deg", "deg", Better::lower},
                                                {"fast.blind_left", "share", Better::lower},
                                                {"fast.hull", "share", Better::lower}};
  return columns;
}

std::vector<double> fast_values(const FastScore& s) {
  return {s.value,    s.information, s.surface,  s.volume,   s.sigma[0],   s.sigma[1],
          s.sigma[2], s.sigma[3],    s.sigma[4], s.sigma[5], s.blind_left, s.hull};
}

double spearman(const std::vector<double>& a, const std::vector<double>& b) {
  ADIT_CHECK(a.size() == b.size());
  return a.empty() ? none : correlation(ranks(a), ranks(b));
}

std::vector<bool> pareto_front(const std::vector<std::vector<double>>& rows) {
  std::vector<bool> front(rows.size(), true);
  for (size_t p = 0; p < rows.size(); ++p)
    for (size_t q = 0; q < rows.size() && front[p]; ++q) {
      bool as_good = true, better = false;
      for (size_t o = 0; o < rows[p].size(); ++o) {
        as_good = as_good && rows[q][o] <= rows[p][o];
        better = better || rows[q][o] < rows[p][o];
      }
      front[p] = !(as_good && better);
    }
  return front;
}

StudyAnswer answer_of(const StudyTable& t) {
  StudyAnswer answer;
  answer.point.resize(t.point.size());
  for (const StudyPoint& p : t.point) ADIT_CHECK(p.fast.size() == fast_columns().size());
  CellsOfPoint cells(t.point.size());
  for (const StudyCell& c : t.cell) cells[c.point].push_back(&c);
  std::vector<Source> sources;
  for (const std::string& name : t.objective) sources.push_back(source_of(t, name));
  judge_points(t, sources, cells, answer);
  for (size_t o = 0; o < sources.size(); ++o) {
    if (sources[o].kind != Source::metric) continue;
    add_effects(t, sources[o].index, o, answer);
    for (size_t f = 0; f < fast_columns().size(); ++f)
      answer.agreement.push_back(agreement_of(t, f, sources[o], cells));
  }
  answer.comparison = comparison_of(t, sources);
  return answer;
}

}  // namespace adit
