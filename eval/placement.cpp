// SPDX-License-Identifier: BSD-3-Clause
#include "eval/placement.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace adit {
namespace {

class Searcher {
 public:
  Searcher(const Course& course, const std::vector<Candidate>& candidates, const std::vector<Sight>& sights,
           const std::vector<Sight>& fixed, size_t k, const Budget& budget, double apart_m)
      : course_(course),
        candidates_(candidates),
        sights_(sights),
        fixed_(fixed),
        k_(k),
        budget_(budget),
        apart_m_(apart_m) {}

  Search run() {
    std::vector<size_t> chosen;
    while (chosen.size() < k_) {
      std::vector<std::vector<size_t>> sets;
      for (size_t c = 0; c < candidates_.size(); ++c)
        if (fits(chosen, c)) sets.push_back(with(chosen, c));
      chosen = best_of(sets);
    }
    for (bool better = true; better;) {
      const double value = seen_.at(chosen).value;
      std::vector<std::vector<size_t>> sets;
      for (size_t out = 0; out < k_; ++out) {
        std::vector<size_t> rest = chosen;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(out));
        for (size_t c = 0; c < candidates_.size(); ++c)
          if (c != chosen[out] && fits(rest, c)) sets.push_back(with(rest, c));
      }
      better = !sets.empty();
      if (!better) break;
      const std::vector<size_t> next = best_of(sets);
      better = seen_.at(next).value > value + 1e-12;
      if (better) chosen = next;
    }
    Search found;
    found.looked_at = seen_.size();
    found.guarantee = !limited_ && course_.every_laser_counts();
    for (const auto& [set, score] : seen_)
      if (set.size() == k_) found.scored.push_back({set, score});
    std::stable_sort(found.scored.begin(), found.scored.end(),
                     [](const Placement& a, const Placement& b) { return a.score.value > b.score.value; });
    return found;
  }

 private:
  const Course& course_;
  const std::vector<Candidate>& candidates_;
  const std::vector<Sight>&sights_, &fixed_;
  size_t k_;
  Budget budget_;
  double apart_m_;
  bool limited_ = false;
  std::map<std::vector<size_t>, FastScore> seen_;

  static std::vector<size_t> with(std::vector<size_t> set, size_t c) {
    set.insert(std::lower_bound(set.begin(), set.end(), c), c);
    return set;
  }

  Vec3 place(size_t c) const {
    const std::vector<double>& p = candidates_[c].mount.position_m;
    return {p[0], p[1], p[2]};
  }

  bool fits(const std::vector<size_t>& set, size_t c) {
    if (std::binary_search(set.begin(), set.end(), c)) return false;
    double price = candidates_[c].price, mass_kg = candidates_[c].mass_kg;
    bool fit = true;
    for (const size_t i : set) {
      price += candidates_[i].price, mass_kg += candidates_[i].mass_kg;
      fit = fit && (place(i) - place(c)).norm() >= apart_m_;
    }
    fit = fit && price <= budget_.price && mass_kg <= budget_.mass_kg;
    limited_ = limited_ || !fit;
    return fit;
  }

  std::vector<size_t> best_of(const std::vector<std::vector<size_t>>& sets) {
    if (sets.empty())
      throw Error("of " + std::to_string(candidates_.size()) + " candidate mounts no " + std::to_string(k_) +
                  " fit together under price_max, mass_max_kg and apart_m");
    std::vector<FastScore> scores(sets.size());
    parallel_for(sets.size(), [&](size_t i) {
      if (const auto known = seen_.find(sets[i]); known != seen_.end()) {
        scores[i] = known->second;
        return;
      }
      std::vector<const Sight*> lasers;
      for (const Sight& sight : fixed_) lasers.push_back(&sight);
      for (const size_t c : sets[i]) lasers.push_back(&sights_[c]);
      scores[i] = course_.score(lasers, false);
    });
    size_t best = 0;
    for (size_t i = 0; i < sets.size(); ++i) {
      seen_[sets[i]] = scores[i];
      if (scores[i].value > scores[best].value) best = i;
    }
    return sets[best];
  }
};

}  // namespace

double clearance_of(const Hull& hull, const Vec3& p_B) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Box& box : hull) nearest = std::min(nearest, (p_B - p_B.cwiseMax(box.min_B).cwiseMin(box.max_B)).norm());
  return nearest;
}

std::vector<Vec3> hull_points(const Hull& hull, double spacing_m, double clearance_m) {
  std::vector<Vec3> points;
  for (const Box& box : hull) {
    if (box.label == Label::pusher) continue;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool upper : {false, true}) {
        if (axis == 2 && !upper) continue;
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const Vec3 size = box.max_B - box.min_B;
        const auto steps = [&](int k) { return std::max(1, static_cast<int>(std::lround(size[k] / spacing_m))); };
        for (int i = 0; i < steps(u); ++i)
          for (int j = 0; j < steps(v); ++j) {
            Vec3 p;
            p[axis] = upper ? box.max_B[axis] + clearance_m : box.min_B[axis] - clearance_m;
            p[u] = box.min_B[u] + size[u] * (i + 0.5) / steps(u);
            p[v] = box.min_B[v] + size[v] * (j + 0.5) / steps(v);
            if (clearance_of(hull, p) >= clearance_m - 1e-9) points.push_back(p);
          }
      }
  }
  return points;
}

Search search(const Course& course, const std::vector<Candidate>& candidates, const std::vector<Sight>& sights,
              const std::vector<Sight>& fixed, size_t k, const Budget& budget, double apart_m) {
  ADIT_CHECK(candidates.size() == sights.size());
  if (k < 1 || k > candidates.size())
    throw Error("mounts.count is " + std::to_string(k) + ", there are " + std::to_string(candidates.size()) +
                " candidate mounts");
  return Searcher(course, candidates, sights, fixed, k, budget, apart_m).run();
}

}  // namespace adit
