// SPDX-License-Identifier: BSD-3-Clause
#include "eval/closure_score.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;
constexpr double reach_m = 5;  // along the path from a closure to the samples that it covers

// Poses of the true path about every metre.
struct Sample {
  size_t match;
  double along_m;
  Vec3 p_W;  // of the laser
  double yaw_rad;
};

struct Revisit {
  size_t earlier, later;  // samples
  bool along;             // parallel or opposite
};

std::vector<Sample> samples_of(const PathMatch& match, const Vec3& p_BL) {
  std::vector<Sample> samples;
  for (size_t i = 0; i < match.size(); ++i)
    if (samples.empty() || match.along_m[i] - samples.back().along_m >= 1)
      samples.push_back({i, match.along_m[i], match.X_WB[i] * p_BL, flatten(match.X_WB[i]).yaw_rad});
  return samples;
}

bool in_plain_sight(const Caster& caster, const Vec3& a, const Vec3& b) {
  const double apart = (b - a).norm();
  return apart < 1e-3 || caster.nearest({a, (b - a) / apart, apart}).range_m >= apart;
}

// How far two headings are from parallel or opposite.
double crossing_rad(double yaw_a, double yaw_b) {
  const double d = std::abs(wrap_angle(yaw_a - yaw_b));
  return std::min(d, std::numbers::pi - d);
}

std::vector<Revisit> revisits_of(const std::vector<Sample>& samples, const Caster& caster,
                                 const ScoreSettings& settings) {
  std::vector<Revisit> revisits;
  for (size_t b = 0; b < samples.size(); ++b)
    for (size_t a = 0; a < b && samples[b].along_m - samples[a].along_m > settings.revisit_m; ++a) {
      if ((samples[a].p_W - samples[b].p_W).norm() > settings.place_m) continue;
      if (!in_plain_sight(caster, samples[a].p_W, samples[b].p_W)) continue;
      revisits.push_back({a, b, crossing_rad(samples[a].yaw_rad, samples[b].yaw_rad) <= settings.place_deg * deg});
    }
  return revisits;
}

bool is_right(const Closure& closure, const Pose& X_WI, const Pose& X_WJ, const ScoreSettings& settings) {
  const Pose2 truth = flatten(X_WI.inverse() * X_WJ);
  if (!closure.measured)
    return truth.position().norm() <= settings.place_m &&
           std::abs(wrap_angle(truth.yaw_rad - closure.X_ij.yaw_rad)) <= settings.place_deg * deg;
  return (truth.position() - closure.X_ij.position()).norm() <= settings.closure_m &&
         std::abs(wrap_angle(truth.yaw_rad - closure.X_ij.yaw_rad)) <= settings.closure_deg * deg;
}

// Number of independent ones among rows of whole numbers, told one by one.
class Rank {
 public:
  void add(std::vector<double> row) {
    for (double& v : row) v = std::round(v);
    for (const auto& [pivot, basis] : basis_) {
      const double factor = row[pivot] / basis[pivot];
      if (factor != 0)
        for (size_t k = 0; k < row.size(); ++k) row[k] -= factor * basis[k];
    }
    const auto largest =
        std::max_element(row.begin(), row.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (largest != row.end() && std::abs(*largest) > 1e-6)
      basis_.push_back({static_cast<size_t>(largest - row.begin()), std::move(row)});
  }
  std::int64_t value() const { return static_cast<std::int64_t>(basis_.size()); }

 private:
  std::vector<std::pair<size_t, std::vector<double>>> basis_;
};

// What the path goes round from one sample to a later one, as passages followed.
class Rounds {
 public:
  Rounds(const PassageMap& passages, const PathMatch& match, const std::vector<Sample>& samples) : passages_(passages) {
    std::vector<double> chain(passages.size(), 0.0);
    for (const Sample& s : samples) {
      const OnPassage at = passages.locate(match.X_WB[s.match].translation().head<2>());
      if (!at_.empty()) passages.add_way(at_.back(), at, chain);
      at_.push_back(at);
      chain_.push_back(chain);
    }
  }
  std::vector<double> cycle(size_t earlier, size_t later) const {
    std::vector<double> c = chain_[later];
    for (size_t k = 0; k < c.size(); ++k) c[k] -= chain_[earlier][k];
    passages_.add_way(at_[later], at_[earlier], c);
    return c;
  }

 private:
  const PassageMap& passages_;
  std::vector<OnPassage> at_;               // (samples)
  std::vector<std::vector<double>> chain_;  // (samples x passages) from the start
};

// Does the map lay the two visits of a place as they truly lie to each other?
bool laid_together(const PathMatch& match, size_t a, size_t b, double loop_m) {
  const Pose truth = match.X_WB[a].inverse() * match.X_WB[b], map = match.X_MB[a].inverse() * match.X_MB[b];
  return (truth.translation() - map.translation()).norm() <= loop_m;
}

struct Judged {
  std::int64_t accepted = 0, wrong = 0, ambiguous = 0, unmatched = 0;
  std::vector<std::pair<size_t, size_t>> right;  // matched poses, earlier and later
};

Judged judge(const PathMatch& match, const std::vector<Closure>& closures, const ScoreSettings& settings) {
  constexpr size_t none = static_cast<size_t>(-1);
  std::vector<size_t> where(match.asked, none);
  for (size_t k = 0; k < match.size(); ++k) where[match.index[k]] = k;
  Judged judged;
  for (const Closure& c : closures) {
    if (c.ambiguous) ++judged.ambiguous;
    if (!c.accepted) continue;
    const auto at = [&](int i) { return i >= 0 && static_cast<size_t>(i) < where.size() ? where[i] : none; };
    const size_t a = at(c.i), b = at(c.j);
    if (a == none || b == none) {
      ++judged.unmatched;
      continue;
    }
    ++judged.accepted;
    if (is_right(c, match.X_WB[a], match.X_WB[b], settings))
      judged.right.push_back(std::minmax(a, b));
    else
      ++judged.wrong;
  }
  return judged;
}

}  // namespace

void add_closures(const MetricList& list, const PassageMap& passages, const Caster& caster, const PathMatch& match,
                  const std::vector<Closure>& closures, const Vec3& p_BL, const ScoreSettings& settings,
                  const std::string& why) {
  const Judged judged = judge(match, closures, settings);
  const auto right = static_cast<std::int64_t>(judged.right.size());
  const std::vector<Sample> samples = samples_of(match, p_BL);
  const std::vector<Revisit> revisits = revisits_of(samples, caster, settings);
  const auto sample_at = [&](size_t matched) {  // the last one not after it
    const auto next = std::upper_bound(samples.begin(), samples.end(), matched,
                                       [](size_t m, const Sample& s) { return m < s.match; });
    return static_cast<size_t>(next - samples.begin()) - 1;
  };
  std::vector<char> revisited(samples.size(), 0), found(samples.size(), 0);
  for (const Revisit& r : revisits)
    if (r.along) revisited[r.later] = 1;
  for (const auto& [a, b] : judged.right)
    for (size_t s = 0; s < samples.size(); ++s)
      if (std::abs(samples[s].along_m - match.along_m[b]) <= reach_m) found[s] = 1;
  std::int64_t places = 0, places_found = 0;
  for (size_t s = 0; s < samples.size(); ++s) {
    places += revisited[s];
    places_found += revisited[s] && found[s];
  }
  Rank driven, closed, tied;
  if (!passages.empty() && !samples.empty()) {
    const Rounds rounds(passages, match, samples);
    for (const Revisit& r : revisits) {
      const std::vector<double> cycle = rounds.cycle(r.earlier, r.later);
      driven.add(cycle);
      if (laid_together(match, samples[r.earlier].match, samples[r.later].match, settings.loop_m)) closed.add(cycle);
    }
    for (const auto& [a, b] : judged.right) tied.add(rounds.cycle(sample_at(a), sample_at(b)));
  }
  const auto share = [](std::int64_t a, std::int64_t b) {
    return b ? static_cast<double>(a) / static_cast<double>(b) : NAN;
  };
  const std::string no_graph = !why.empty() ? why : passages.empty() ? "the world has no passages" : "";
  list.count("accepted", judged.accepted, Better::higher, why);
  list.count("wrong", judged.wrong, Better::lower, why);
  list.count("ambiguous", judged.ambiguous, Better::lower, why);
  list.count("unmatched", judged.unmatched, Better::lower, why);
  list.add("precision", share(right, judged.accepted), "share", Better::higher, judged.accepted,
           !why.empty() ? why : "no closure was accepted");
  list.add("recall", share(places_found, places), "share", Better::higher, places,
           !why.empty() ? why : "the path revisits no place");
  list.count("loops_true", driven.value(), Better::higher, no_graph);
  list.count("loops_closed", closed.value(), Better::higher, no_graph);
  list.count("loops_by_closure", tied.value(), Better::higher, no_graph);
}

}  // namespace adit
