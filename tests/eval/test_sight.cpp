// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "eval/placement.h"
#include "eval/sight.h"
#include "tests/support/shapes.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;

// A laser without rounding whose beams are a degree apart.
LaserModel laser(double sigma_m = 0.01) {
  LaserModel m;
  m.name = "exact";
  m.fov_rad = std::numbers::pi, m.beams = 181, m.range_max_m = 80, m.sigma_m = sigma_m;
  return m;
}
Mount mount(double yaw, double pitch, double roll, const Vec3& p = {0, 0, 1}) {
  return {.name = "m", .laser = laser(), .X_BS = pose_of(p, yaw * deg, pitch * deg, roll * deg)};
}
const Mount level = mount(0, 0, 0), up = mount(0, -90, 0), down = mount(0, 90, 0), ahead = mount(0, 0, 90);

// A path along x at floor height.
Trajectory along_x(double from, double to) {
  Trajectory path;
  for (int i = 0; from + 0.5 * i <= to; ++i) {
    path.stamp_s.push_back(i);
    path.X_WB.push_back(pose_of({from + 0.5 * i, 0, 0}, 0));
  }
  return path;
}

FastSettings every_beam(double information = 1) {
  FastSettings s;
  s.information = information;
  s.beam_step_deg = 1, s.step_m = 1;
  s.one_a_view = false, s.hull = 0;
  return s;
}

// A chamber 20 x 4 x 2 m and a way of 10 m through its middle.
struct Chamber {
  Mesh mesh = box_mesh({-10, -2, 0}, {10, 2, 2});
  Caster caster{mesh};
  Course course;

  explicit Chamber(double information = 1) : course(caster, along_x(-5, 5), every_beam(information)) {}

  FastScore of(const std::vector<Mount>& mounts, const Hull& hull = {}) const {
    std::vector<Sight> sights;
    for (const Mount& m : mounts) sights.push_back(course.sight(m, hull));
    std::vector<const Sight*> all;
    for (const Sight& s : sights) all.push_back(&s);
    return course.score(all);
  }
};

TEST(Sight, BetweenTwoWallsALevelFanTellsAcrossYawAndRollAsTheClosedFormSays) {
  const Mesh mesh = box_mesh({-500, -2, 0}, {500, 2, 2});
  const Caster caster(mesh);
  const Course course(caster, along_x(0, 3), every_beam());
  const Mat6 I = course.sight(level, {}).information[1];  // a place with others before and after
  // Beam a meets a wall 2 m aside at r = 2 / sin a: its range changes by 1 / sin a for a metre across, and the level arm
  // of a roll is the height of the plane, 1 m.
  double across = 0, yaw = 0;
  for (int k = 0; k < 181; ++k) {
    const double a = laser().beam_angle_rad(k), r = 2 / std::abs(std::sin(a));
    if (std::abs(std::sin(a)) < 0.03) continue;  // beyond the laser's range, or edge-on
    across += 1 / std::pow(std::sin(a), 2);
    yaw += std::pow(r * std::cos(a) / std::sin(a), 2);
  }
  const double weight = 1 / (0.01 * 0.01);
  EXPECT_NEAR(I(1, 1) / weight, across, 1e-3 * across);  // float rays
  EXPECT_NEAR(I(5, 5) / weight, yaw, 1e-3 * yaw);
  EXPECT_NEAR(I(3, 3), I(1, 1), 1e-3 * I(1, 1));
  for (const int k : {0, 2, 4}) EXPECT_NEAR(I(k, k), 0, 1e-6 * weight);  // along, up, pitch
}

TEST(Sight, AFanUpAndAFanDownSeeHalfASectionEachAndTogetherAllOfIt) {
  const Chamber c;
  EXPECT_NEAR(c.of({up}).surface, 0.5, 2.0 / 36);  // a sector at each side may count
  EXPECT_NEAR(c.of({down}).volume, 0.5, 2.0 / 36);
  EXPECT_NEAR(c.of({up, down}).surface, 1, 1e-9);
  EXPECT_NEAR(c.of({up, down}).volume, 1, 1e-9);
  EXPECT_LT(c.of({level}).surface, 0.2);  // two lines on the walls
}

TEST(Sight, OneLevelFanIsBlindUpAndInPitchAndAFanOnEdgeSeesBoth) {
  const Chamber c;
  const FastScore alone = c.of({level}), both = c.of({level, ahead});
  EXPECT_NEAR(alone.sigma[2], 1, 1e-3);  // the prior
  // Its plane is 1 m up: what x is told ties the pitch to x, whose prior of 1 m is left.
  EXPECT_NEAR(alone.sigma[4], 5 / std::hypot(1, 5 * deg), 1e-3);
  EXPECT_NEAR(alone.blind_left, 1, 1e-4);
  EXPECT_EQ(blind_words(alone), "up, roll and pitch");
  EXPECT_LT(both.sigma[2], 0.01);
  EXPECT_LT(both.sigma[4], 0.1);
  EXPECT_GT(both.value, alone.value);
}

TEST(Sight, ABoxInFrontOfAMirrorBlindsItAndTheOneAroundItIsItsHousing) {
  const Chamber c;
  const Box wall{"wall", {0.2, -2, 0}, {0.3, 2, 3}}, housing{"housing", {-0.1, -0.1, 0.9}, {0.1, 0.1, 1.1}};
  EXPECT_EQ(c.of({level}, {housing}).value, c.of({level}).value);
  // Beams square to the way, a degree to each side, pass by the wall and tell of across alone.
  EXPECT_LT(c.of({level}, {wall}).information, 0.6 * c.of({level}).information);
  EXPECT_NEAR(c.of({level}, {wall}).sigma[0], 1, 0.05);
}

TEST(Sight, BeamsThatEndOnTheVehicleAreCountedAndCostWhatTheWeightSays) {
  const Mesh mesh = box_mesh({-10, -2, 0}, {10, 2, 2});
  const Caster caster(mesh);
  FastSettings free = every_beam(), costly = every_beam();
  costly.hull = 3;
  const Trajectory path = along_x(-5, 5);
  const Course a(caster, path, free), b(caster, path, costly);
  const Hull deck{{"deck", {-5, -5, 0.5}, {5, 5, 0.6}}};  // wider than the chamber: all of what looks down ends on it
  const Sight down_a = a.sight(down, deck), down_b = b.sight(down, deck), up_b = b.sight(up, deck);
  const Sight* const on_a[] = {&down_a};
  const Sight* const on_b[] = {&down_b};
  EXPECT_EQ(up_b.blocked, 0);
  EXPECT_NEAR(down_b.blocked, 1 - 2 * 11.3 / 181, 2.0 / 181);  // within atan(0.4 / 2) of level the walls come first
  EXPECT_NEAR(a.score(on_a).value - b.score(on_b).value, 3 * down_b.blocked, 1e-12);
}

TEST(Sight, ValuesAreMonotoneAndSubmodular) {
  const Chamber c;
  const std::vector<Mount> all{level, up, down, ahead, mount(90, 0, 0), mount(0, -60, 0)};
  for (size_t a = 0; a < all.size(); ++a)
    for (size_t b = 0; b < all.size(); ++b)
      for (size_t x = 0; x < all.size(); ++x) {
        if (a == b || a == x || b == x) continue;
        const double small = c.of({all[a], all[x]}).value - c.of({all[a]}).value,
                     large = c.of({all[a], all[b], all[x]}).value - c.of({all[a], all[b]}).value;
        EXPECT_GE(large, -1e-12);
        EXPECT_GE(small, large - 1e-9) << a << " " << b << " " << x;
      }
}

TEST(Sight, AFanAcrossTheTravelSeesNewRockAtEachStationWhichTellsAsMuchAsItsUnevennessLetsIt) {
  const Mesh mesh = box_mesh({-500, -2, 0}, {500, 2, 2});
  const Caster caster(mesh);
  FastSettings known = every_beam(), unknown = every_beam();
  known.unknown_m = 0, unknown.unknown_m = 0.3;
  const Trajectory path = along_x(0, 3);
  const Course a(caster, path, known), b(caster, path, unknown);
  const double less = 0.01 * 0.01 / (0.01 * 0.01 + 0.3 * 0.3);
  const Mat6 known_up = a.sight(up, {}).information[1], unknown_up = b.sight(up, {}).information[1];
  EXPECT_GT(known_up(2, 2), 0);
  EXPECT_NEAR((unknown_up - less * known_up).norm(), 0, 1e-9 * known_up.norm());
  // Fans along the travel see the same rock again.
  for (const Mount& m : {level, ahead})
    EXPECT_EQ(a.sight(m, {}).information[1], b.sight(m, {}).information[1]) << m.name;
}

TEST(Sight, WhereOneLaserAViewCountsASecondOneOfItAddsNothingAndWithoutOneThatLooksUpThereIsNoVoid) {
  const Mesh mesh = box_mesh({-10, -2, 0}, {10, 2, 2});
  const Caster caster(mesh);
  FastSettings s = every_beam();
  s.one_a_view = true;
  const Course course(caster, along_x(-5, 5), s);
  const auto of = [&](const std::vector<Mount>& mounts) {
    std::vector<Sight> sights;
    for (const Mount& m : mounts) sights.push_back(course.sight(m, {}));
    std::vector<const Sight*> all;
    for (const Sight& one : sights) all.push_back(&one);
    return course.score(all).value;
  };
  EXPECT_EQ(of({level, up, mount(0, -80, 0)}), of({level, up}));
  EXPECT_EQ(of({level, up, mount(0, -45, 0)}), of({level, up}));  // of no view
  EXPECT_GT(of({level, up, down}), of({level, up}) + 0.4);        // the lower half of rock and void
  EXPECT_LT(of({level, down}), of({level, up}) - 0.4);
}

TEST(Sight, APathOfOneStationIsAnError) {
  const Mesh mesh = box_mesh({-10, -2, 0}, {10, 2, 2});
  const Caster caster(mesh);
  EXPECT_THROW(Course(caster, along_x(0, 0.5), every_beam()), Error);
}

std::vector<Candidate> candidates(size_t n) {
  std::vector<Candidate> all(n);
  for (size_t i = 0; i < n; ++i) all[i].mount.position_m = {0, 0, 1.0 + static_cast<double>(i)};
  return all;
}

TEST(Placement, InAChamberTheFansUpAndDownAreTheBestTwoBesideTheLevelOne) {
  const Chamber c(0);  // the section alone counts
  std::vector<Sight> sights;
  for (const Mount& m : {mount(90, 0, 0), down, mount(180, 0, 0), up, mount(0, -45, 0)})
    sights.push_back(c.course.sight(m, {}));
  const Search found = search(c.course, candidates(5), sights, {c.course.sight(level, {})}, 2, {}, 0);
  EXPECT_EQ(found.scored.front().candidate, (std::vector<size_t>{1, 3}));  // all of the section
  EXPECT_TRUE(found.guarantee);
  EXPECT_NEAR(found.scored.front().score.surface, 1, 1e-9);
}

TEST(Placement, SearchIsNoWorseThanTheGreedyBoundOfTheBestOfAllSets) {
  const Chamber c;
  std::vector<Sight> sights;
  for (int i = 0; i < 9; ++i)
    sights.push_back(c.course.sight(mount(40.0 * i, -35.0 * i, 20.0 * i, {0, 0.1 * i - 0.4, 0.8}), {}));
  const Search found = search(c.course, candidates(9), sights, {}, 3, {}, 0);
  double best = 0;
  for (size_t i = 0; i < 9; ++i)
    for (size_t j = i + 1; j < 9; ++j)
      for (size_t k = j + 1; k < 9; ++k) {
        const Sight* const three[] = {&sights[i], &sights[j], &sights[k]};
        best = std::max(best, c.course.score(three).value);
      }
  EXPECT_GE(found.scored.front().score.value, (1 - 1 / std::numbers::e) * best);
  EXPECT_LE(found.scored.front().score.value, best + 1e-12);
}

TEST(Placement, ABudgetIsKeptAndOneThatAllowsNothingIsAnError) {
  const Chamber c;
  const std::vector<Sight> sights{c.course.sight(up, {}), c.course.sight(down, {}), c.course.sight(level, {})};
  std::vector<Candidate> some = candidates(3);
  some[0].price = some[1].price = 10, some[2].price = 1;
  const Search found = search(c.course, some, sights, {}, 2, {.price = 12}, 0);
  for (const Placement& p : found.scored) EXPECT_EQ(p.candidate.back(), 2u);
  EXPECT_FALSE(found.guarantee);
  EXPECT_THROW(search(c.course, some, sights, {}, 2, {.price = 5}, 0), Error);
  EXPECT_THROW(search(c.course, some, sights, {}, 4, {}, 0), Error);
  EXPECT_THROW(search(c.course, some, sights, {}, 2, {}, 5), Error);  // no two are 5 m apart
}

TEST(Placement, PlacesOnAHullLieAClearanceOutsideOfEveryBox) {
  const Hull hull{{"frame", {-0.5, -0.4, 0.2}, {0.5, 0.4, 0.5}}, {"mast", {-0.1, -0.1, 0.5}, {0.1, 0.1, 1.0}}};
  const std::vector<Vec3> points = hull_points(hull, 0.2, 0.1);
  ASSERT_GT(points.size(), 20u);
  for (const Vec3& p : points) {
    EXPECT_GE(clearance_of(hull, p), 0.1 - 1e-9);
    EXPECT_GE(p.z(), 0.2);
  }
  EXPECT_EQ(clearance_of(hull, {0, 0, 0.3}), 0);
  EXPECT_NEAR(clearance_of(hull, {0, 0, 1.5}), 0.5, 1e-12);
}

}  // namespace
}  // namespace adit
