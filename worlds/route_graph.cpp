// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/route_graph.h"

#include "base/polyline.h"

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

std::vector<char> two_core(const World& world, const std::vector<char>& allowed) {
  std::vector<char> in = allowed.empty() ? std::vector<char>(world.passages.size(), 1) : allowed;
  std::vector<int> degree(world.junctions.size(), 0);
  for (size_t i = 0; i < in.size(); ++i) {
    degree[world.passages[i].a] += in[i];
    degree[world.passages[i].b] += in[i];
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

std::vector<char> reached(const World& world, int from, const std::vector<char>& allowed) {
  const Ways ways(world, from, allowed);
  std::vector<char> in(world.passages.size(), 0);
  for (size_t i = 0; i < in.size(); ++i)
    in[i] = (allowed.empty() || allowed[i]) && std::isfinite(ways.distance_m(world.passages[i].a));
  return in;
}

namespace {

// The leg with which a loop goes on when it keeps the rock on its left: the one farthest to the left.
Leg leftmost(const World& world, const Leg& leg, const std::vector<char>& allowed) {
  const Vec2 in = arriving(world, leg);
  Leg best{leg.passage, !leg.forward};
  double best_rad = -10;
  const int at = to_of(world, leg);
  for (const int id : world.junctions[at].passages) {
    if (!allowed.empty() && !allowed[id]) continue;
    for (const bool forward : {true, false}) {
      const Leg next{id, forward};
      if (from_of(world, next) != at || (id == leg.passage && forward != leg.forward)) continue;
      const Vec2 out = leaving(world, next);
      const double left_rad = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
      if (left_rad > best_rad) best_rad = left_rad, best = next;
    }
  }
  return best;
}

// Twice the area to the left, and whether the point lies there.
std::pair<double, bool> round_of(const World& world, const std::vector<Leg>& legs, const Vec2& p) {
  std::vector<Vec2> line;
  for (const Leg& leg : legs) {
    const std::vector<Vec3>& centre = world.passages[leg.passage].centre_line;
    for (size_t k = 0; k + 1 < centre.size(); ++k)
      line.push_back(centre[leg.forward ? k : centre.size() - 1 - k].head<2>());
  }
  return {signed_area(line), contains(line, p)};
}

}  // namespace

std::vector<Leg> loop_about(const World& world, const Vec2& p_W, const std::vector<char>& allowed) {
  const std::vector<char> core = two_core(world, allowed);
  std::vector<Leg> best;
  double least = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < core.size(); ++i) {
    if (!core[i]) continue;
    for (const bool forward : {true, false}) {
      const Leg first{static_cast<int>(i), forward};
      std::vector<Leg> legs{first};
      for (;;) {
        const Leg next = leftmost(world, legs.back(), core);
        if (next.passage == first.passage && next.forward == first.forward) break;
        legs.push_back(next);
        if (legs.size() > 2 * core.size()) break;
      }
      const auto [area, inside] = round_of(world, legs, p_W);
      if (inside && area > 0 && area < least) least = area, best = std::move(legs);
    }
  }
  return best;
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
