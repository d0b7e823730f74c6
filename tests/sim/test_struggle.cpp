// SPDX-License-Identifier: BSD-3-Clause
#include "sim/sim.h"
#include "sim/struggle.h"
#include "tests/sim/terrain.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

using testing::HasSubstr;

constexpr double bump_x_m = 4;

// Level, with a ridge across as a buried sleeper with stones before it makes one: 0.1 m wide, flanks of 0.17 m.
World ridge_world(double height_m) {
  return terrain_world({2, -0.8}, {7.5, 0.8}, 0.06, [=](const Vec2& p) {
    const double flank = std::clamp((std::abs(p.x() - bump_x_m) - 0.05) / 0.17, 0.0, 1.0);
    return height_m * (0.5 + 0.5 * std::cos(std::numbers::pi * flank));
  });
}

// From where the front wheels, 0.4 m ahead, are at the ridge's foot.
Drive over_ridge(double height_m) {
  DriveSettings settings;
  settings.lead_in_s = 0.5;
  return drive(ridge_world(height_m), route_through({{3.3, 0}, {6.5, 0}}, 0), load_vehicle("cart"), settings, 1);
}

double farthest_back_m(const Drive& d) {
  double back = 0, ahead = -1e9;
  for (const Pose& X : d.path.X_WB) {
    ahead = std::max(ahead, X.translation().x());
    back = std::max(back, ahead - X.translation().x());
  }
  return back;
}

TEST(Struggle, ACartTakesARunAtARidgeThatItDoesNotGetOverFromRest) {
  const Drive low = over_ridge(0.05);
  EXPECT_EQ(low.end, DriveEnd::finished) << low.cause;
  EXPECT_LT(farthest_back_m(low), 0.05);  // no need
  const Drive high = over_ridge(0.08);
  EXPECT_EQ(high.end, DriveEnd::finished) << high.cause;
  EXPECT_NEAR(farthest_back_m(high), 0.4, 0.15);  // the first try, and the way to stop
}

TEST(Struggle, WhatNoRunGetsOverEndsTheDriveAndTheCauseTellsTheTries) {
  const Drive d = over_ridge(0.14);
  EXPECT_EQ(d.end, DriveEnd::stuck);
  EXPECT_THAT(d.cause, HasSubstr("its wheels do not get on; 3 more tries did not help"));
  EXPECT_NEAR(farthest_back_m(d), 0.9, 0.2);  // each try from 0.25 m farther off
}

TEST(Struggle, OnlyThreeTimesAtAPlaceAndAnewElsewhere) {
  Struggle struggle;
  for (const double along_m : {3.0, 7.0}) {
    for (const bool expected : {true, true, true, false})
      EXPECT_EQ(struggle.again(0, along_m + 0.1, {}, false, 0.7, 1.2), expected);
  }
}

TEST(Struggle, BackIsAgainstTheWayOfDrivingAndTurnsOnThatWay) {
  for (const bool backward : {false, true}) {
    Struggle struggle;
    Guide guide;
    guide.backward = backward;
    ASSERT_TRUE(struggle.again(0, 5, {}, true, 0.7, 1.2));
    double speed = 0;
    for (int k = 1; k < 120; ++k) speed = struggle.want(k / 240.0, 1 / 240.0, 5, guide, {})->speed_mps;
    EXPECT_EQ(speed > 0, backward);
    const double asked = backward ? -0.5 : 0.5;  // of the nose: in both cases it turns to the left
    EXPECT_GT(speed * struggle.curvature(asked), 0);
    struggle.give_up();
    EXPECT_FALSE(struggle.want(1, 1 / 240.0, 5, guide, {}));
    EXPECT_EQ(struggle.curvature(asked), asked);
  }
}

}  // namespace
}  // namespace adit
