// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "rays/caster.h"
#include "tests/support/shapes.h"
#include "worlds/route_graph.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace adit {
namespace {

const World& mini() {
  static const World world = [] {
    WorldSettings s;
    s.kind = "panel";
    s.mesh_edge_m = 0.3;
    return make_world(s, 21);
  }();
  return world;
}

const World& bruceton() {
  static const World world = [] {
    WorldSettings s;
    s.x_max = -45;
    s.y_max = 182;
    s.mesh_edge_m = 0.5;
    return make_world(s, 21);
  }();
  return world;
}

// The route's passages as legs: each begins where the one before ended.
std::vector<Leg> legs_of(const World& world, const Route& route) {
  for (bool forward : {true, false}) {
    std::vector<Leg> legs{{route.passages[0], forward}};
    for (size_t i = 1; i < route.passages.size(); ++i) {
      const int at = to_of(world, legs.back());
      const Passage& p = world.passages[route.passages[i]];
      if (p.a != at && p.b != at) break;
      legs.push_back({route.passages[i], p.a == at});
    }
    const Vec2 begin = world.junctions[from_of(world, legs[0])].p_W.head<2>();
    if (legs.size() == route.passages.size() && (begin - route.line.front()).norm() < 1e-6) return legs;
  }
  ADD_FAILURE() << "the passages do not join";
  return {};
}

double least_radius(const std::vector<Vec2>& line) {
  double least = 1e9;
  for (size_t i = 2; i + 2 < line.size(); ++i) {
    const Vec2 a = line[i] - line[i - 2], b = line[i + 2] - line[i];
    const double angle = std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0));
    if (angle > 1e-6) least = std::min(least, 0.5 * (a.norm() + b.norm()) / angle);
  }
  return least;
}

void expect_loops_route(const World& world, std::uint64_t seed) {
  const Route route = plan_route(world, {}, seed);
  const std::vector<Leg> legs = legs_of(world, route);
  const std::vector<char> core = two_core(world);
  std::map<int, std::vector<bool>> driven;
  for (const Leg& leg : legs) driven[leg.passage].push_back(leg.forward);
  for (size_t i = 0; i < core.size(); ++i)
    EXPECT_EQ(core[i] != 0, driven.contains(static_cast<int>(i))) << "seed " << seed << ", passage " << i;
  double all = 0, twice = 0, same = 0, opposite = 0;
  for (const auto& [id, ways] : driven) {
    const double length = world.passages[id].length_m;
    all += static_cast<double>(ways.size()) * length;
    if (ways.size() > 1) twice += static_cast<double>(ways.size()) * length;
    for (size_t k = 1; k < ways.size(); ++k) (ways[k] == ways[0] ? same : opposite) += length;
  }
  EXPECT_GE(twice / all, 0.25) << "seed " << seed;
  EXPECT_GT(same, 0) << "seed " << seed;
  EXPECT_GT(opposite, 0) << "seed " << seed;
  for (size_t i = 1; i < legs.size(); ++i)
    EXPECT_NE(legs[i].passage, legs[i - 1].passage) << "seed " << seed << ": U-turn";
  EXPECT_NEAR(route.length_m, all, 0.06 * all);  // rounded corners are shorter
}

TEST(Router, LoopsDrivesEveryPassageOfTheLoopsSomeTwiceInBothDirectionsWithoutUTurn) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    expect_loops_route(mini(), seed);
    expect_loops_route(bruceton(), seed);
  }
}

TEST(Router, TheLineKeepsClearOfTheRibsAndItsPointsAreAQuarterMetreApart) {
  for (const World* world : {&mini(), &bruceton()}) {
    const Route route = plan_route(*world, {}, 3);
    const Caster caster(world->mesh);
    double sum = 0;
    for (size_t i = 0; i < route.line.size(); ++i) {
      const Vec2 p = route.line[i];
      const double roof = 1e3;  // from far below: the first face met is the floor, seen from the rock
      const double floor = -roof + caster.nearest({{p.x(), p.y(), -roof}, {0, 0, 1}, 1e4}).range_m;
      EXPECT_FALSE(caster.closest({p.x(), p.y(), floor + 0.85}, 0.6)) << "at " << p.transpose();
      if (i == 0) continue;
      const double step = (p - route.line[i - 1]).norm();
      EXPECT_NEAR(step, 0.25, 0.01);  // chords of arcs
      sum += step;
    }
    EXPECT_NEAR(sum, route.length_m, 1e-9 * sum);
  }
}

TEST(Router, CornersAreRoundedToWhatCanBeDriven) {
  EXPECT_GT(least_radius(plan_route(mini(), {}, 1).line), 1.4);      // asked for 1.75, wandering centre lines take some
  EXPECT_GT(least_radius(plan_route(bruceton(), {}, 1).line), 1.0);  // two sharp turns within 7 m leave less room
}

TEST(Router, ASeedIsARoute) {
  const Route one = plan_route(bruceton(), {}, 5), again = plan_route(bruceton(), {}, 5),
              other = plan_route(bruceton(), {}, 6);
  EXPECT_EQ(one.line, again.line);
  EXPECT_NE(one.passages, other.passages);
}

TEST(Router, ARingIsDrivenRound) {
  const World ring = ring_world(20, 3, 2, 1e9);
  RouteSettings s;
  s.start = 2;
  s.twice_share = 0;
  const Route route = plan_route(ring, s, 1);
  ASSERT_EQ(route.passages.size(), 4u);
  EXPECT_LT((route.line.front() - ring.junctions[2].p_W.head<2>()).norm(), 1e-9);
  EXPECT_LT((route.line.back() - ring.junctions[2].p_W.head<2>()).norm(), 1e-9);
  // Three corners of four are rounded (the route begins in the other one): each saves (2 - pi / 2) r.
  EXPECT_NEAR(route.length_m, 4 * 17 - 3 * (2 - std::acos(0.0)) * s.turn_radius_m, 0.05);
}

TEST(Router, WaypointsAreJoinedByShortestWays) {
  const World ring = ring_world(20, 3, 2, 1e9);
  RouteSettings s;
  s.mode = "waypoints";
  s.waypoints = {0, 1, 2};
  EXPECT_EQ(plan_route(ring, s, 1).passages, (std::vector<int>{0, 1}));
}

TEST(Router, ThereAndBackTurnsAboutWithinThePassage) {
  const World tunnel = tunnel_world(60, 4, 2);
  RouteSettings s;
  s.mode = "there_and_back";
  s.start = 0;
  const Route route = plan_route(tunnel, s, 1);
  EXPECT_EQ(route.passages, (std::vector<int>{0, 0}));
  EXPECT_LT((route.line.back() - route.line.front()).norm(), 1e-6);
  double farthest = 0;
  for (const Vec2& p : route.line) {
    EXPECT_LT(std::abs(p.y()), 2 - 0.6);
    farthest = std::max(farthest, p.x());
  }
  EXPECT_GT(farthest, 55);
  EXPECT_LT(farthest, 59.4);
  EXPECT_GT(least_radius(route.line), 0.9);
}

TEST(Router, AllDrivesEveryPassageDeadEndsTooAndComesBack) {
  for (const World* world : {&mini(), &bruceton()}) {
    RouteSettings s;
    s.mode = "all";
    const Route route = plan_route(*world, s, 4);
    const std::vector<Leg> legs = legs_of(*world, route);
    std::vector<int> times(world->passages.size(), 0);
    double all = 0, driven = 0;
    for (const Leg& leg : legs) ++times[leg.passage], driven += world->passages[leg.passage].length_m;
    for (size_t i = 0; i < times.size(); ++i) {
      const Passage& passage = world->passages[i];
      const bool dead_end = world->junctions[passage.a].degree() == 1 || world->junctions[passage.b].degree() == 1;
      if (!dead_end || passage.length_m > passage.width_m) {
        EXPECT_GE(times[i], 1) << "passage " << i;
      }
      EXPECT_LE(times[i], 2) << "passage " << i;  // a shortest tour drives none three times
      all += world->passages[i].length_m;
    }
    EXPECT_EQ(from_of(*world, legs.front()), to_of(*world, legs.back()));
    EXPECT_LT(driven, 1.6 * all);
  }
}

TEST(Router, TurnsInPlaceRunBackOnTheirOwnLine) {
  const World tunnel = tunnel_world(60, 2.6, 2);
  RouteSettings s;
  s.mode = "there_and_back";
  s.turn = "in_place";
  s.start = 0;
  const Route route = plan_route(tunnel, s, 1);
  double farthest = 0;
  for (const Vec2& p : route.line) {
    EXPECT_LT(std::abs(p.y()), 1e-6);
    farthest = std::max(farthest, p.x());
  }
  EXPECT_GT(farthest, 55);
  EXPECT_LT((route.line.back() - route.line.front()).norm(), 1e-6);
}

// Things stand beside passages from 1.5 m beyond a junction's half width on: a turn ends where they begin.
TEST(Router, TurnsAtAJunctionAreDrivenWhereNothingStands) {
  const World& world = mini();
  const auto crossing =
      std::find_if(world.junctions.begin(), world.junctions.end(), [](const Junction& j) { return j.degree() > 2; });
  ASSERT_NE(crossing, world.junctions.end());
  const int there = static_cast<int>(crossing - world.junctions.begin());
  const Passage& way = world.passages[static_cast<size_t>(crossing->passages[0])];
  for (const char* turn : {"arc", "in_place", "three_point"}) {
    RouteSettings s;
    s.mode = "waypoints";
    s.turn = turn;
    s.waypoints = {way.a == there ? way.b : way.a, there, way.a == there ? way.b : way.a};
    const Route route = plan_route(world, s, 1);
    double reach = 0;
    for (const Vec2& p : route.line) {
      double off = 1e9;
      for (const Vec3& q : way.centre_line) off = std::min(off, (q.head<2>() - p).norm());
      if (off > 0.6) reach = std::max(reach, (p - crossing->p_W.head<2>()).norm());  // off the lane
    }
    EXPECT_LT(reach, 0.5 * way.width_m + 1.5) << turn;
  }
}

// Arcs of 60 degrees and radius R: sqrt(3)/2 R ahead and R/2 to either side, back where it began.
TEST(Router, AThreePointTurnIsThreeArcsTheMiddleOneDrivenBackwards) {
  for (const double width : {2.8, 3.7, 6.0}) {
    const World tunnel = tunnel_world(60, width, 2);
    RouteSettings s;
    s.mode = "there_and_back";
    s.turn = "three_point";
    s.start = 0;
    const Route route = plan_route(tunnel, s, 1);
    const double radius = std::clamp(width - 2.6, 0.5, s.turn_radius_m);
    ASSERT_EQ(route.backwards.size(), 1u);
    const auto [first, last] = route.backwards[0];
    const auto turn_at = [&](int i) {
      const Vec2 in = route.line[i] - route.line[i - 1], out = route.line[i + 1] - route.line[i];
      return in.dot(out) / in.norm() / out.norm();
    };
    for (int i = 1; i + 1 < static_cast<int>(route.line.size()); ++i)
      EXPECT_EQ(turn_at(i) < 0, i == first || i == last) << "point " << i << " of width " << width;
    EXPECT_NEAR(route.line[first].y(), radius / 2, 1e-6);
    EXPECT_NEAR(route.line[last].y(), -radius / 2, 1e-6);
    EXPECT_NEAR(route.line[first].x(), route.line[last].x(), 1e-6);
    EXPECT_LT(route.line[first].x(), 60 - 1.4);
    EXPECT_LT((route.line.back() - route.line.front()).norm(), 1e-6);
  }
}

TEST(Router, RoutesBeginAndEndOffTheFaceOfADeadEnd) {
  const World tunnel = tunnel_world(60, 3.7, 2);
  RouteSettings s;
  s.mode = "waypoints";
  s.waypoints = {0, 1};
  const Route route = plan_route(tunnel, s, 1);
  EXPECT_NEAR(route.line.front().x(), 1.3, 1e-6);
  EXPECT_NEAR(route.line.back().x(), 60 - 1.3, 1e-6);
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    s = {};
    s.mode = "all";
    EXPECT_GT(mini().junctions[from_of(mini(), legs_of(mini(), plan_route(mini(), s, seed)).front())].degree(), 1);
  }
}

TEST(Router, RoutesLeaveOutWhatIsBlocked) {
  World world = mini();
  const std::vector<char> core = two_core(world);
  const int blocked = static_cast<int>(std::find(core.begin(), core.end(), 1) - core.begin());
  world.passages[static_cast<size_t>(blocked)].blocked = true;
  RouteSettings avoiding;
  avoiding.avoid = {blocked};
  for (const char* mode : {"loops", "all", "there_and_back"}) {
    RouteSettings s;
    s.mode = avoiding.mode = mode;
    const Route route = plan_route(world, s, 3);
    EXPECT_EQ(std::count(route.passages.begin(), route.passages.end(), blocked), 0) << mode;
    EXPECT_EQ(route.passages, plan_route(mini(), avoiding, 3).passages) << mode;
  }
  for (Passage& passage : world.passages) passage.blocked = true;
  for (const char* mode : {"loops", "all", "there_and_back"}) {
    RouteSettings s;
    s.mode = mode;
    EXPECT_THROW(plan_route(world, s, 3), Error) << mode;
  }
}

TEST(Router, AroundDrivesTheLoopThatEnclosesThePillarAndNoOther) {
  const World& world = mini();
  ASSERT_GT(world.pillars.size(), 1u);
  for (size_t id = 0; id < world.pillars.size(); ++id) {
    RouteSettings s;
    s.mode = "around";
    s.pillars = {static_cast<int>(id)};
    const Route route = plan_route(world, s, 1);
    const std::vector<Leg> legs = legs_of(world, route);
    EXPECT_EQ(from_of(world, legs.front()), to_of(world, legs.back()));
    double winding[2] = {0, 0};  // about this pillar, about the next
    for (size_t k = 0; k < 2; ++k) {
      const Vec2 p = world.pillars[(id + k) % world.pillars.size()].outline.front();
      for (size_t i = 0; i < route.line.size(); ++i) {
        const Vec2 a = route.line[i] - p, b = route.line[(i + 1) % route.line.size()] - p;
        winding[k] += std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
      }
    }
    EXPECT_NEAR(winding[0], 2 * std::acos(-1.0), 1e-6) << "pillar " << id;
    EXPECT_NEAR(winding[1], 0, 1e-6) << "pillar " << id;
  }
}

TEST(Router, PassagesToAvoidAreNotDriven) {
  for (const char* mode : {"loops", "all"})
    for (const int passage : {0, 3}) {
      RouteSettings s;
      s.mode = mode;
      s.avoid = {passage};
      const Route route = plan_route(bruceton(), s, 2);
      EXPECT_EQ(std::count(route.passages.begin(), route.passages.end(), passage), 0) << mode << " " << passage;
      EXPECT_GT(route.length_m, 1000);
    }
}

TEST(Router, WhatCannotBeDrivenIsSaidWithItsKey) {
  const World tunnel = tunnel_world(60, 4, 2);
  const auto error_of = [&](const RouteSettings& s) -> std::string {
    try {
      plan_route(tunnel, s, 1);
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  RouteSettings s;
  EXPECT_NE(error_of(s).find("no loop"), std::string::npos) << error_of(s);
  s.mode = "waypoints";
  EXPECT_NE(error_of(s).find("route.waypoints"), std::string::npos) << error_of(s);
  s.waypoints = {0, 7};
  EXPECT_NE(error_of(s).find("no junction 7"), std::string::npos) << error_of(s);
  s.waypoints = {1, 1};
  EXPECT_NE(error_of(s).find("follows itself"), std::string::npos) << error_of(s);
  s.mode = "there_and_back";
  s.start = 5;
  EXPECT_NE(error_of(s).find("route.start"), std::string::npos) << error_of(s);
  s.start = 0;
  s.avoid = {0};
  EXPECT_NE(error_of(s).find("route.avoid"), std::string::npos) << error_of(s);
  s.avoid = {9};
  EXPECT_NE(error_of(s).find("no passage 9"), std::string::npos) << error_of(s);
  s.avoid = {};
  s.mode = "around";
  EXPECT_NE(error_of(s).find("route.pillars"), std::string::npos) << error_of(s);
  s.pillars = {4};
  EXPECT_NE(error_of(s).find("no pillar 4"), std::string::npos) << error_of(s);
}

}  // namespace
}  // namespace adit
