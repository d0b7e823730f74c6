// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "worlds/route_graph.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace adit {
namespace {

// Numbers drawn one after the other, for a search whose steps have no addresses of their own.
class Drawn {
 public:
  Drawn(std::uint64_t seed, std::uint64_t purpose) : seed_(seed), purpose_(purpose) {}
  size_t below(size_t n) { return static_cast<size_t>(random_bits(seed_, Draw::route, purpose_, next_++) % n); }

 private:
  std::uint64_t seed_, purpose_, next_ = 0;
};

using Times = std::vector<int>;  // (passages) how often each is driven

std::vector<int> odd_junctions(const World& world, const Times& times) {
  std::vector<int> degree(world.junctions.size(), 0);
  for (size_t i = 0; i < times.size(); ++i) {
    degree[world.passages[i].a] += times[i];
    degree[world.passages[i].b] += times[i];
  }
  std::vector<int> odd;
  for (size_t j = 0; j < degree.size(); ++j)
    if (degree[j] % 2) odd.push_back(static_cast<int>(j));
  return odd;
}

// Partners 2k and 2k + 1 of a list in the order that makes the sum of their distances small: exchanges of partners
// between two pairs until none helps, from several shuffles.
std::vector<int> matched(const std::vector<std::vector<double>>& distance, std::uint64_t seed) {
  const size_t n = distance.size();
  std::vector<int> best;
  double best_sum = 1e300;
  for (std::uint64_t start = 0; start < 12; ++start) {
    Drawn drawn(seed, start);
    std::vector<int> order(n);
    for (size_t i = 0; i < n; ++i) order[i] = static_cast<int>(i);
    for (size_t i = n; i > 1; --i) std::swap(order[i - 1], order[drawn.below(i)]);
    const auto d = [&](size_t i, size_t j) { return distance[order[i]][order[j]]; };
    for (bool better = true; better;) {
      better = false;
      for (size_t p = 0; p + 1 < n; p += 2) {
        for (size_t q = p + 2; q + 1 < n; q += 2) {
          const double now = d(p, p + 1) + d(q, q + 1) - 1e-9;
          if (d(p, q) + d(p + 1, q + 1) < now) {
            std::swap(order[p + 1], order[q]);
            better = true;
          } else if (d(p, q + 1) + d(p + 1, q) < now) {
            std::swap(order[p + 1], order[q + 1]);
            better = true;
          }
        }
      }
    }
    double sum = 0;
    for (size_t p = 0; p + 1 < n; p += 2) sum += d(p, p + 1);
    if (sum < best_sum - 1e-9) {
      best_sum = sum;
      best = order;
    }
  }
  return best;
}

// Drives passages again so that every junction is left as often as it is reached.
void make_even(const World& world, const std::vector<char>& allowed, Times& times, std::uint64_t seed) {
  const std::vector<int> odd = odd_junctions(world, times);
  std::vector<Ways> ways;
  for (int j : odd) ways.emplace_back(world, j, allowed);
  std::vector<std::vector<double>> distance(odd.size(), std::vector<double>(odd.size()));
  for (size_t i = 0; i < odd.size(); ++i)
    for (size_t j = 0; j < odd.size(); ++j) distance[i][j] = ways[i].distance_m(odd[j]);
  const std::vector<int> order = matched(distance, seed);
  std::vector<int> again(times.size(), 0);
  for (size_t p = 0; p + 1 < order.size(); p += 2)
    for (const Leg& leg : ways[order[p]].to(odd[order[p + 1]])) again[leg.passage] ^= 1;
  for (size_t i = 0; i < times.size(); ++i) times[i] += again[i];
}

double share_twice(const World& world, const Times& times) {
  double all = 0, twice = 0;
  for (size_t i = 0; i < times.size(); ++i) {
    all += times[i] * world.passages[i].length_m;
    if (times[i] > 1) twice += times[i] * world.passages[i].length_m;
  }
  return twice / all;
}

// Drives the loop again that brings the most new passages for its length.
bool add_loop(const World& world, const std::vector<char>& allowed, Times& times) {
  std::vector<Leg> best;
  double best_value = 0;
  for (size_t i = 0; i < times.size(); ++i) {
    const Passage& p = world.passages[i];
    if (!allowed[i] || times[i] > 1) continue;
    const Ways round(world, p.b, allowed, static_cast<int>(i));
    if (!std::isfinite(round.distance_m(p.a))) continue;
    std::vector<Leg> loop = round.to(p.a);
    double fresh = p.length_m;
    for (const Leg& leg : loop)
      if (times[leg.passage] == 1) fresh += world.passages[leg.passage].length_m;
    const double length = p.length_m + round.distance_m(p.a);
    const double value = fresh / length - 1e-3 * length;  // of loops alike the shorter
    if (!best.empty() && value <= best_value) continue;
    best_value = value;
    best = std::move(loop);
    best.push_back({static_cast<int>(i), true});
  }
  for (const Leg& leg : best) ++times[leg.passage];
  return !best.empty();
}

// Hierholzer: goes on until it is back, then puts in what was left out.
std::vector<Leg> euler_tour(const World& world, Times left, int start) {
  std::vector<Leg> stack, done;
  int at = start;
  for (;;) {
    const auto& here = world.junctions[at].passages;
    const auto next = std::find_if(here.begin(), here.end(), [&](int id) { return left[id] > 0; });
    if (next != here.end()) {
      --left[*next];
      stack.push_back({*next, world.passages[*next].a == at});
      at = to_of(world, stack.back());
    } else if (!stack.empty()) {
      at = from_of(world, stack.back());
      done.push_back(stack.back());
      stack.pop_back();
    } else {
      break;
    }
  }
  std::reverse(done.begin(), done.end());
  return done;
}

// U-turns weigh most; then each of both directions shall have a quarter of what is driven again; then sharp turns.
double cost_of(const World& world, const std::vector<Leg>& legs) {
  double cost = 0;
  for (size_t i = 1; i < legs.size(); ++i) {
    if (legs[i].passage == legs[i - 1].passage && legs[i].forward != legs[i - 1].forward) cost += 1000;
    const double c = std::clamp(arriving(world, legs[i - 1]).dot(leaving(world, legs[i])), -1.0, 1.0);
    cost += std::pow(std::acos(c) / std::numbers::pi, 2);
  }
  std::map<int, bool> first;
  double same = 0, opposite = 0;
  for (const Leg& leg : legs) {
    const auto [known, fresh] = first.emplace(leg.passage, leg.forward);
    if (!fresh) (known->second == leg.forward ? same : opposite) += world.passages[leg.passage].length_m;
  }
  const double less = std::min(same, opposite) / std::max(1e-9, same + opposite);
  return same + opposite > 0 ? cost + 200 * std::max(0.0, 0.25 - less) : cost;
}

void turn_round(std::vector<Leg>& legs, size_t begin, size_t end) {
  std::reverse(legs.begin() + static_cast<std::ptrdiff_t>(begin), legs.begin() + static_cast<std::ptrdiff_t>(end));
  for (size_t i = begin; i < end; ++i) legs[i].forward = !legs[i].forward;
}

// A part of the tour between two visits to a junction can be driven backwards, or two such parts in the other order:
// the tour stays a tour. Descends by random ones.
void improve(const World& world, std::vector<Leg>& legs, std::uint64_t seed) {
  Drawn drawn(seed, 100);
  double cost = cost_of(world, legs);
  const auto at = [&](size_t i) { return i < legs.size() ? from_of(world, legs[i]) : to_of(world, legs.back()); };
  for (int trial = 0; trial < 6000; ++trial) {
    const size_t i = drawn.below(legs.size());
    std::vector<size_t> visits;
    for (size_t k = i + 1; k <= legs.size(); ++k)
      if (at(k) == at(i)) visits.push_back(k);
    if (visits.empty()) continue;
    const size_t j = visits[drawn.below(visits.size())];
    std::vector<Leg> other = legs;
    if (trial % 2 || j == visits.back()) {
      turn_round(other, i, j);
    } else {
      std::rotate(other.begin() + static_cast<std::ptrdiff_t>(i), other.begin() + static_cast<std::ptrdiff_t>(j),
                  other.begin() + static_cast<std::ptrdiff_t>(visits.back()));
    }
    const double now = cost_of(world, other);
    if (now > cost) continue;
    cost = now;
    legs = std::move(other);
  }
}

}  // namespace

std::vector<Leg> tour(const World& world, const std::vector<char>& allowed, int start, double twice_share,
                      std::uint64_t seed) {
  Times times(allowed.begin(), allowed.end());
  make_even(world, allowed, times, seed);
  while (share_twice(world, times) < twice_share && add_loop(world, allowed, times)) {
  }
  std::vector<Leg> legs = euler_tour(world, times, start);
  size_t driven = 0;
  for (int t : times) driven += t;
  ADIT_CHECK(legs.size() == driven);  // else the passages were not connected
  improve(world, legs, seed);
  return legs;
}

}  // namespace adit
