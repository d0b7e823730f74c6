// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "worlds/route_graph.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace adit {
namespace {

void check_junction(const World& world, const std::string& key, int id) {
  if (id < 0 || id >= static_cast<int>(world.junctions.size()))
    throw Error(key + ": there is no junction " + std::to_string(id) + "; this mine has 0 to " +
                std::to_string(world.junctions.size() - 1));
}

std::vector<int> junctions_of(const World& world, const std::vector<char>& passages) {
  std::vector<int> all;
  for (size_t i = 0; i < passages.size(); ++i)
    if (passages[i]) all.insert(all.end(), {world.passages[i].a, world.passages[i].b});
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

size_t drawn_start(size_t count, std::uint64_t seed) {
  return random_bits(seed, Draw::route, 1000) % count;
}

// Whether some passages are driven again in the same direction and some in the opposite one.
bool both_ways(const std::vector<Leg>& legs) {
  std::map<int, bool> first;
  bool same = false, opposite = false;
  for (const Leg& leg : legs) {
    const auto [known, fresh] = first.emplace(leg.passage, leg.forward);
    if (!fresh) (known->second == leg.forward ? same : opposite) = true;
  }
  return same && opposite;
}

// The first tour from one of the junctions that has both; what is driven twice can make that impossible without a
// U-turn, and more of it possible again. Else the first tour.
std::vector<Leg> tour_both_ways(const World& world, const std::vector<char>& core, const std::vector<int>& starts,
                                double twice_share, std::uint64_t seed) {
  std::vector<Leg> first;
  for (double share : {twice_share, twice_share + 0.15, twice_share + 0.3}) {
    for (int start : starts) {
      std::vector<Leg> legs = tour(world, core, start, std::min(share, 0.9), seed);
      if (both_ways(legs) || twice_share <= 0) return legs;
      if (first.empty()) first = std::move(legs);
    }
  }
  return first;
}

// Neither blocked nor to be avoided; empty where all passages are allowed.
std::vector<char> allowed_of(const World& world, const RouteSettings& s) {
  std::vector<char> allowed;
  for (const Passage& passage : world.passages) allowed.push_back(!passage.blocked);
  for (const int id : s.avoid) {
    if (id < 0 || id >= static_cast<int>(world.passages.size()))
      throw Error("route.avoid: there is no passage " + std::to_string(id) + "; this mine has 0 to " +
                  std::to_string(world.passages.size() - 1));
    allowed[id] = 0;
  }
  if (std::find(allowed.begin(), allowed.end(), 0) == allowed.end()) allowed.clear();
  return allowed;
}

std::vector<Leg> way_to(const World& world, int from, int to, const std::vector<char>& allowed, const char* key) {
  const Ways ways(world, from, allowed);
  if (!std::isfinite(ways.distance_m(to)))
    throw Error(std::string(key) + ": junction " + std::to_string(to) + " cannot be reached from " +
                std::to_string(from) + " without the passages that are blocked or in route.avoid");
  return ways.to(to);
}

// The greatest part that hangs together.
std::vector<char> greatest_part(const World& world, const std::vector<char>& of) {
  std::vector<char> best, seen(of.size(), 0);
  double most = -1;
  for (size_t i = 0; i < of.size(); ++i) {
    if (!of[i] || seen[i]) continue;
    std::vector<char> part = reached(world, world.passages[i].a, of);
    double length = 0;
    for (size_t k = 0; k < part.size(); ++k)
      if (part[k]) seen[k] = 1, length += world.passages[k].length_m;
    if (length > most) most = length, best = std::move(part);
  }
  return best;
}

// A dead end shorter than it is wide is seen from its junction, and no vehicle turns in it.
bool is_niche(const World& world, const Passage& passage) {
  const auto dead_end = [&](int j) { return world.junctions[static_cast<size_t>(j)].degree() == 1; };
  return passage.length_m < passage.width_m && dead_end(passage.a) != dead_end(passage.b);
}

std::vector<Leg> all_passages(const World& world, const RouteSettings& s, std::uint64_t seed) {
  std::vector<char> allowed = allowed_of(world, s);
  if (allowed.empty()) allowed.assign(world.passages.size(), 1);
  if (s.start >= 0) check_junction(world, "route.start", s.start);
  for (size_t i = 0; i < allowed.size(); ++i) {
    const Passage& passage = world.passages[i];
    if (is_niche(world, passage) && passage.a != s.start && passage.b != s.start) allowed[i] = 0;
  }
  const std::vector<char> part = s.start >= 0 ? reached(world, s.start, allowed) : greatest_part(world, allowed);
  std::vector<int> among = junctions_of(world, part);
  const auto dead_end = [&](int j) { return world.junctions[static_cast<size_t>(j)].degree() < 2; };
  if (!std::all_of(among.begin(), among.end(), dead_end)) std::erase_if(among, dead_end);
  if (among.empty()) throw Error("route.avoid: with what is blocked it leaves no passage to drive");
  const int start = s.start >= 0 ? s.start : among[drawn_start(among.size(), seed)];
  return tour(world, part, start, 0, seed);
}

std::vector<Leg> around(const World& world, const RouteSettings& s) {
  if (s.pillars.empty()) throw Error("route.pillars: mode \"around\" needs one pillar at least");
  const std::vector<char> allowed = allowed_of(world, s);
  if (s.start >= 0) check_junction(world, "route.start", s.start);
  std::vector<Leg> legs;
  int at = s.start;
  for (const int id : s.pillars) {
    if (id < 0 || id >= static_cast<int>(world.pillars.size()))
      throw Error("route.pillars: there is no pillar " + std::to_string(id) + "; this mine has 0 to " +
                  std::to_string(static_cast<int>(world.pillars.size()) - 1));
    std::vector<Leg> loop = loop_about(world, world.pillars[id].outline.front(), allowed);
    if (loop.empty()) throw Error("route.pillars: no loop of passages leads about pillar " + std::to_string(id));
    if (at >= 0) {
      const Ways ways(world, at, allowed);
      const auto nearer = [&](const Leg& a, const Leg& b) {
        return ways.distance_m(from_of(world, a)) < ways.distance_m(from_of(world, b));
      };
      std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end(), nearer), loop.end());
      const std::vector<Leg> way = way_to(world, at, from_of(world, loop.front()), allowed, "route.pillars");
      legs.insert(legs.end(), way.begin(), way.end());
    }
    legs.insert(legs.end(), loop.begin(), loop.end());
    at = to_of(world, legs.back());
  }
  return legs;
}

std::vector<Leg> loops(const World& world, const RouteSettings& s, std::uint64_t seed) {
  const std::vector<char> allowed = allowed_of(world, s);
  const std::vector<char> core = allowed.empty() ? two_core(world) : greatest_part(world, two_core(world, allowed));
  const std::vector<int> among = junctions_of(world, core);
  if (among.empty())
    throw Error(
        "route.mode = \"loops\": this mine has no loop that is free; use \"all\", \"there_and_back\" or \"waypoints\"");
  std::vector<int> starts = among;
  std::rotate(starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(drawn_start(starts.size(), seed)),
              starts.end());
  starts.resize(std::min<size_t>(starts.size(), 12));
  std::vector<Leg> legs;
  if (s.start >= 0) {
    // From outside of the loops the shortest way in.
    check_junction(world, "route.start", s.start);
    const Ways ways(world, s.start, allowed);
    const auto nearer = [&](int a, int b) { return ways.distance_m(a) < ways.distance_m(b); };
    starts = {*std::min_element(among.begin(), among.end(), nearer)};
    legs = way_to(world, s.start, starts[0], allowed, "route.start");
  }
  const std::vector<Leg> round = tour_both_ways(world, core, starts, s.twice_share, seed);
  legs.insert(legs.end(), round.begin(), round.end());
  return legs;
}

std::vector<Leg> by_waypoints(const World& world, const RouteSettings& s) {
  std::vector<int> stops = s.waypoints;
  if (s.start >= 0) stops.insert(stops.begin(), s.start);
  if (stops.size() < 2) throw Error("route.waypoints: two junctions at least are needed for mode \"waypoints\"");
  for (int id : stops) check_junction(world, "route.waypoints", id);
  const std::vector<char> allowed = allowed_of(world, s);
  std::vector<Leg> legs;
  for (size_t i = 1; i < stops.size(); ++i) {
    if (stops[i] == stops[i - 1])
      throw Error("route.waypoints: junction " + std::to_string(stops[i]) + " follows itself");
    const std::vector<Leg> way = way_to(world, stops[i - 1], stops[i], allowed, "route.waypoints");
    legs.insert(legs.end(), way.begin(), way.end());
  }
  return legs;
}

std::vector<Leg> there_and_back(const World& world, const RouteSettings& s, std::uint64_t seed) {
  const std::vector<char> allowed = allowed_of(world, s);
  std::vector<int> among = junctions_of(world, two_core(world, allowed));
  if (among.empty()) {  // no loop: from a dead end
    std::vector<int> degree(world.junctions.size(), 0);
    for (size_t i = 0; i < world.passages.size(); ++i)
      if (allowed.empty() || allowed[i]) ++degree[world.passages[i].a], ++degree[world.passages[i].b];
    for (size_t j = 0; j < degree.size(); ++j)
      if (degree[j] == 1) among.push_back(static_cast<int>(j));
  }
  if (s.start >= 0) check_junction(world, "route.start", s.start);
  if (s.start < 0 && among.empty()) throw Error("route.avoid: with what is blocked it leaves no passage to drive");
  const int start = s.start >= 0 ? s.start : among[drawn_start(among.size(), seed)];
  const Ways ways(world, start, allowed);
  int farthest = start;
  for (size_t j = 0; j < world.junctions.size(); ++j)
    if (std::isfinite(ways.distance_m(static_cast<int>(j))) &&
        ways.distance_m(static_cast<int>(j)) > ways.distance_m(farthest))
      farthest = static_cast<int>(j);
  if (farthest == start)
    throw Error("route.avoid: with what is blocked it leaves no passage to drive from junction " +
                std::to_string(start));
  std::vector<Leg> legs = ways.to(farthest);
  for (size_t i = legs.size(); i > 0; --i) legs.push_back({legs[i - 1].passage, !legs[i - 1].forward});
  return legs;
}

}  // namespace

Route plan_route(const World& world, const RouteSettings& s, std::uint64_t seed) {
  if (world.passages.empty()) throw Error("route: this mine has no passages to drive; its truth.json lists none");
  const std::vector<Leg> legs = s.mode == "loops"       ? loops(world, s, seed)
                                : s.mode == "all"       ? all_passages(world, s, seed)
                                : s.mode == "around"    ? around(world, s)
                                : s.mode == "waypoints" ? by_waypoints(world, s)
                                                        : there_and_back(world, s, seed);
  return route_along(world, legs, s);
}

}  // namespace adit
