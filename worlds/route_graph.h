// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/worlds.h"

#include <cstdint>
#include <vector>

namespace adit {

/// A passage driven from its a to its b (forward) or back.
struct Leg {
  int passage;
  bool forward;
};

inline int from_of(const World& world, const Leg& leg) {
  return leg.forward ? world.passages[leg.passage].a : world.passages[leg.passage].b;
}
inline int to_of(const World& world, const Leg& leg) {
  return leg.forward ? world.passages[leg.passage].b : world.passages[leg.passage].a;
}

/// Direction in plan in which a leg leaves its first junction, or arrives at its last, taken over some metres.
Vec2 leaving(const World& world, const Leg& leg);
Vec2 arriving(const World& world, const Leg& leg);

/// Passages that are left of those allowed (empty: all) when dead ends are taken off again and again: those on loops or
/// between loops. (passages)
std::vector<char> two_core(const World& world, const std::vector<char>& allowed = {});

/// Passages allowed (empty: all) that can be reached from a junction. (passages)
std::vector<char> reached(const World& world, int from, const std::vector<char>& allowed);

/// The smallest loop of allowed passages (empty: all) about a point in plan, counter-clockwise; empty where there is
/// none.
std::vector<Leg> loop_about(const World& world, const Vec2& p_W, const std::vector<char>& allowed);

/// Shortest ways from one junction, over the passages that are allowed (empty: all).
class Ways {
 public:
  Ways(const World& world, int from, const std::vector<char>& allowed, int without = -1);
  double distance_m(int to) const { return distance_[to]; }  // +inf: no way
  std::vector<Leg> to(int junction) const;

 private:
  const World* world_;
  std::vector<double> distance_;
  std::vector<Leg> last_;  // by which a junction is reached
};

/// A closed tour from a junction over every allowed passage, with `twice_share` of its length on passages driven more
/// than once and no U-turn where one can be avoided. The allowed passages must be connected. Method:
/// Edmonds, Johnson, "Matching, Euler tours and the Chinese postman", Math. Prog. 1973, the matching by exchange.
std::vector<Leg> tour(const World& world, const std::vector<char>& allowed, int start, double twice_share,
                      std::uint64_t seed);

/// The route along legs, corners rounded. Between a leg and the same leg driven back there is a turn-about, a three-point
/// turn, or the line goes back on itself, as settings.turn has it.
Route route_along(const World& world, const std::vector<Leg>& legs, const RouteSettings& settings);

}  // namespace adit
