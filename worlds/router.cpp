// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "worlds/route_graph.h"

#include <algorithm>
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

std::vector<Leg> loops(const World& world, const RouteSettings& s, std::uint64_t seed) {
  const std::vector<char> core = two_core(world);
  const std::vector<int> among = junctions_of(world, core);
  if (among.empty())
    throw Error("route.mode = \"loops\": this mine has no loop; use \"there_and_back\" or \"waypoints\"");
  std::vector<int> starts = among;
  std::rotate(starts.begin(), starts.begin() + static_cast<std::ptrdiff_t>(drawn_start(starts.size(), seed)),
              starts.end());
  starts.resize(std::min<size_t>(starts.size(), 12));
  std::vector<Leg> legs;
  if (s.start >= 0) {
    // From outside of the loops the shortest way in.
    check_junction(world, "route.start", s.start);
    const Ways ways(world, s.start, {});
    const auto nearer = [&](int a, int b) { return ways.distance_m(a) < ways.distance_m(b); };
    starts = {*std::min_element(among.begin(), among.end(), nearer)};
    legs = ways.to(starts[0]);
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
  std::vector<Leg> legs;
  for (size_t i = 1; i < stops.size(); ++i) {
    if (stops[i] == stops[i - 1])
      throw Error("route.waypoints: junction " + std::to_string(stops[i]) + " follows itself");
    const std::vector<Leg> way = Ways(world, stops[i - 1], {}).to(stops[i]);
    legs.insert(legs.end(), way.begin(), way.end());
  }
  return legs;
}

std::vector<Leg> there_and_back(const World& world, const RouteSettings& s, std::uint64_t seed) {
  std::vector<int> among = junctions_of(world, two_core(world));
  if (among.empty())
    for (size_t j = 0; j < world.junctions.size(); ++j)
      if (world.junctions[j].degree() == 1) among.push_back(static_cast<int>(j));
  if (s.start >= 0) check_junction(world, "route.start", s.start);
  const int start = s.start >= 0 ? s.start : among[drawn_start(among.size(), seed)];
  const Ways ways(world, start, {});
  int farthest = start;
  for (size_t j = 0; j < world.junctions.size(); ++j)
    if (ways.distance_m(static_cast<int>(j)) > ways.distance_m(farthest)) farthest = static_cast<int>(j);
  std::vector<Leg> legs = ways.to(farthest);
  for (size_t i = legs.size(); i > 0; --i) legs.push_back({legs[i - 1].passage, !legs[i - 1].forward});
  return legs;
}

}  // namespace

Route plan_route(const World& world, const RouteSettings& s, std::uint64_t seed) {
  if (world.passages.empty()) throw Error("route: this mine has no passages to drive; its truth.json lists none");
  const std::vector<Leg> legs = s.mode == "loops"       ? loops(world, s, seed)
                                : s.mode == "waypoints" ? by_waypoints(world, s)
                                                        : there_and_back(world, s, seed);
  Route route;
  route.line = line_of(world, legs, s.turn_radius_m);
  for (const Leg& leg : legs) route.passages.push_back(leg.passage);
  for (size_t i = 1; i < route.line.size(); ++i) route.length_m += (route.line[i] - route.line[i - 1]).norm();
  return route;
}

}  // namespace adit
