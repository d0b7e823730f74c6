// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/route_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace adit {
namespace {

constexpr double heading_over_m = 4;

// From one end of a centre line to the point some metres in.
Vec2 inwards(const Passage& p, bool from_a) {
  const size_t n = p.centre_line.size();
  const Vec2 end = (from_a ? p.centre_line.front() : p.centre_line.back()).head<2>();
  for (size_t k = 1; k < n; ++k) {
    const Vec2 d = (from_a ? p.centre_line[k] : p.centre_line[n - 1 - k]).head<2>() - end;
    if (d.norm() >= heading_over_m || k + 1 == n) return d.normalized();
  }
  return {1, 0};
}

}  // namespace

Vec2 leaving(const World& world, const Leg& leg) {
  return inwards(world.passages[leg.passage], leg.forward);
}
Vec2 arriving(const World& world, const Leg& leg) {
  return -inwards(world.passages[leg.passage], !leg.forward);
}

std::vector<char> two_core(const World& world) {
  std::vector<char> in(world.passages.size(), 1);
  std::vector<int> degree(world.junctions.size(), 0);
  for (const Passage& p : world.passages) {
    ++degree[p.a];
    ++degree[p.b];
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t i = 0; i < in.size(); ++i) {
      const Passage& p = world.passages[i];
      if (!in[i] || (degree[p.a] > 1 && degree[p.b] > 1)) continue;
      in[i] = 0;
      --degree[p.a];
      --degree[p.b];
      changed = true;
    }
  }
  return in;
}

// Dijkstra; ties by junction id.
Ways::Ways(const World& world, int from, const std::vector<char>& allowed, int without)
    : world_(&world),
      distance_(world.junctions.size(), std::numeric_limits<double>::infinity()),
      last_(world.junctions.size(), Leg{-1, true}) {
  std::set<std::pair<double, int>> open{{0.0, from}};
  distance_[from] = 0;
  while (!open.empty()) {
    const auto [d, at] = *open.begin();
    open.erase(open.begin());
    for (int id : world.junctions[at].passages) {
      if (id == without || (!allowed.empty() && !allowed[id])) continue;
      const Leg leg{id, world.passages[id].a == at};
      const int next = to_of(world, leg);
      const double longer = d + world.passages[id].length_m;
      if (longer >= distance_[next]) continue;
      open.erase({distance_[next], next});
      distance_[next] = longer;
      last_[next] = leg;
      open.insert({longer, next});
    }
  }
}

std::vector<Leg> Ways::to(int junction) const {
  std::vector<Leg> legs;
  for (int at = junction; last_[at].passage >= 0; at = from_of(*world_, last_[at])) legs.push_back(last_[at]);
  std::reverse(legs.begin(), legs.end());
  return legs;
}

}  // namespace adit
