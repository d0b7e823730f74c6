// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "sensors/echo.h"
#include "tests/sensors/scenes.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

const LaserModel& lms200() {
  static const LaserModel model = load_laser("lms200", 38400);
  return model;
}

Echo echo_of(std::vector<Return> returns, double pulse_m = 1.5, bool always = false) {
  return first_echo(returns, {.model = &lms200(), .always = always, .spread = 1e-3}, pulse_m);
}

TEST(Bundle, RaysFillTheDiscEvenlyAndTheirSharesSumToOne) {
  for (int rays : {1, 7, 19, 37}) {
    const Bundle b = make_bundle(rays);
    ASSERT_EQ(b.place.size(), static_cast<size_t>(rays));
    EXPECT_EQ(b.place[0], Vec2(0, 0));
    double sum = 0;
    Vec2 middle = Vec2::Zero();
    for (size_t i = 0; i < b.place.size(); ++i) {
      EXPECT_LT(b.place[i].norm(), 1);
      sum += b.weight[i];
      middle += b.weight[i] * b.place[i];
    }
    EXPECT_NEAR(sum, 1, 1e-12);
    EXPECT_LT(middle.norm(), 1e-12);
  }
  EXPECT_THROW(make_bundle(12), Error);
}

TEST(Echo, OneSurfaceIsMeasuredWhereItIs) {
  const Echo e = echo_of({{5, 0.3}});
  EXPECT_TRUE(e.noticed);
  EXPECT_DOUBLE_EQ(e.range_m, 5);
  EXPECT_DOUBLE_EQ(e.effective_reflectivity, 0.3);
  EXPECT_DOUBLE_EQ(e.spread_m, 0);
  EXPECT_EQ(e.surfaces, 1);
}

TEST(Echo, SurfacesWithinOnePulseMergeAtTheMeanOfTheirPower) {
  // Half of the spot at 5 m, half at 6 m and as bright: the farther half gives (5 / 6)^2 of the power.
  const Echo e = echo_of({{6, 0.2}, {5, 0.2}});
  const double far = 25.0 / 36;
  EXPECT_NEAR(e.range_m, (5 + 6 * far) / (1 + far), 1e-12);
  EXPECT_NEAR(e.effective_reflectivity, 0.2 * (1 + far), 1e-12);
  EXPECT_GT(e.spread_m, 0.4);
  EXPECT_EQ(e.surfaces, 2);
}

TEST(Echo, WhatLiesBeyondOnePulseBehindTheFirstIsIgnored) {
  const Echo e = echo_of({{7, 0.9}, {5, 0.1}});
  EXPECT_DOUBLE_EQ(e.range_m, 5);
  EXPECT_EQ(e.surfaces, 2);
  EXPECT_DOUBLE_EQ(echo_of({{7, 0.9}, {5, 0.1}}, 2.5).range_m > 5, true);  // a longer pulse reaches it
}

TEST(Echo, ASurfaceTooWeakToTriggerLetsTheNextOneBeMeasured) {
  const double least = lms200().least_reflectivity(5);
  EXPECT_DOUBLE_EQ(echo_of({{5, 0.9 * least}, {9, 0.5}}).range_m, 9);
  EXPECT_DOUBLE_EQ(echo_of({{5, 1.1 * least}, {9, 0.5}}).range_m, 5);
}

TEST(Echo, ATenthOfTheSpotOnABrightTargetTriggersAtTenMetres) {
  // The telegram listing's example: at 10 m a target of 100 % needs a tenth of the spot.
  EXPECT_TRUE(echo_of({{10, 0.12 * 1.0}}).noticed);
  EXPECT_FALSE(echo_of({{10, 0.08 * 1.0}}).noticed);
}

TEST(Echo, NothingComesBackFromNothing) {
  EXPECT_FALSE(echo_of({{INFINITY, 0}}, 1.5, true).noticed);
  EXPECT_FALSE(echo_of({}, 1.5, true).noticed);
}

// A tunnel with a post's edge before its far wall: a step in depth across the fan.
Recording past_an_edge(int rays, double front_m, double back_m) {
  const World tunnel = tunnel_world(2 * back_m, 40, 2);
  const Drive stand = drive_of(0.2, [&](double) { return pose_of({back_m, 0, 0}, 0); });
  const Hull board{{"board", {front_m, -20, -1}, {front_m + 0.05, 0.0, 3}, Label::vehicle}};
  SensorSettings s = exact();
  s.sub_rays = rays;
  s.hull_reflectivity = s.reflectivity = 0.45;
  return record(tunnel, stand, one_laser("lms200", pose_of({0, 0, 1}, 0.001)), board, s, 1);
}

// Beams within 2.5 deg of the edge whose range lies between: slant alone adds a thousandth there.
int between(const Recording& r, double low_m, double high_m) {
  const auto near = r.log.scans[0][0].subspan(175, 11);
  return static_cast<int>(std::count_if(near.begin(), near.end(), [&](float x) { return x > low_m && x < high_m; }));
}

TEST(Echo, AnEdgeWithinOnePulseGivesOneOrTwoMixedPixelsAndWithoutABundleNone) {
  // LMS 200 at 0.5 deg: spots leave gaps, so that an edge cuts none or one; domain rule: one or two each edge.
  const Recording with = past_an_edge(19, 5, 6), without = past_an_edge(1, 5, 6);
  EXPECT_EQ(between(without, 5.05, 5.9), 0);
  EXPECT_GE(between(with, 5.05, 5.9), 1);
  EXPECT_LE(between(with, 5.05, 5.9), 2);
  const ScanTruth& truth = with.truth.scans[0];
  for (size_t k = 175; k < 186; ++k)
    if (with.log.scans[0][0][k] > 5.05F && with.log.scans[0][0][k] < 5.9F) {
      EXPECT_EQ(truth.fault[k], trouble::mixed);
      EXPECT_EQ(truth.surfaces[k], 2);
    }
}

TEST(Echo, AnEdgeFarBeforeTheWallGivesNoMixedPixel) {
  EXPECT_EQ(between(past_an_edge(19, 5, 9), 5.05, 8.8), 0);
}

TEST(Echo, TheBundleOnAFlatWallMeasuresTheWall) {
  const World tunnel = tunnel_world(20, 4, 2);
  const Drive stand = drive_of(0.2, [](double) { return pose_of({10, 0, 0}, 0); });
  SensorSettings s = exact();
  s.sub_rays = 19;
  const Recording r = record(tunnel, stand, one_laser("lms200", pose_of({0, 0, 1}, 0)), {}, s, 1);
  for (int k = 0; k < 361; ++k) {
    const double a = r.log.rig.mounts[0].laser.beam_angle_rad(k), range = r.truth.scans[0].range_m[k];
    if (std::abs(std::sin(a)) < 0.35 && std::abs(std::cos(a)) < 0.99) continue;  // corners
    // The spot's far side weighs less by the square of the range: a few millimetres at 35 mm of spot; and the rounding.
    EXPECT_NEAR(r.log.scans[0][0][k], range, 0.002) << k;
    EXPECT_EQ(r.truth.scans[0].surfaces[k], 1) << k;
  }
}

}  // namespace
}  // namespace adit
