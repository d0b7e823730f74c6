// SPDX-License-Identifier: BSD-3-Clause
#include "base/dexels.h"
#include "tests/eval/exact_case.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

// A box as the mapped void of the tunnel case, whose M begins at (4, 0, 0) in W.
Score with_surface(const Vec3& low_W, const Vec3& high_W) {
  ExactCase c = tunnel_case();
  c.estimate.surface = box_mesh(low_W - Vec3(4, 0, 0), high_W - Vec3(4, 0, 0));
  return score_of(c);
}

TEST(VolumeError, TheTrueSurfaceHasNoError) {
  const Score score = score_of(ring_case());
  EXPECT_NEAR(value(score, "volume.true_m3"), 2 * (400 - 144), 1e-6);
  EXPECT_NEAR(value(score, "volume.error_percent"), 0, 1e-6);
  EXPECT_NEAR(value(score, "volume.iou"), 1, 1e-8);
  EXPECT_NEAR(value(score, "volume.overbreak_m3"), 0, 1e-6);
  EXPECT_NEAR(value(score, "volume.underbreak_m3"), 0, 1e-6);
  // What is not observable is beside the corners, behind the path's ends: a small part.
  EXPECT_GT(value(score, "volume.observable_m3"), 0.85 * 512);
  EXPECT_LE(value(score, "volume.observable_m3"), 512 + 1e-6);
}

TEST(VolumeError, TheSweptVoidOfATunnelIsItsSectionTimesTheWay) {
  const Score score = score_of(tunnel_case());
  // The upward fan goes from x = 4 to 16, the downward one 0.3 m behind: 8 m2 over 12 m and half a section more; the
  // level fan adds a sheet without volume.
  EXPECT_NEAR(value(score, "volume.observable_m3"), 8 * 12.0, 0.04 * 96);
}

TEST(VolumeError, ARoofTooHighIsOverbreakOfItsArea) {
  const Score score = with_surface({0, -2, 0}, {20, 2, 2.2});
  const double seen = value(score, "volume.observable_m3");
  // 0.2 m above the 4 m wide roof, where it was seen: 12 m and, through the fans' ends, half a metre beyond at the
  // ends.
  EXPECT_NEAR(value(score, "volume.overbreak_m3"), 0.2 * 4 * 12, 1.2);
  EXPECT_NEAR(value(score, "volume.underbreak_m3"), 0, 1e-6);
  EXPECT_NEAR(value(score, "volume.error_percent"), 100 * value(score, "volume.overbreak_m3") / seen, 1e-9);
}

TEST(VolumeError, ARoofTooLowIsUnderbreak) {
  const Score score = with_surface({0, -2, 0}, {20, 2, 1.8});
  const double seen = value(score, "volume.observable_m3");
  EXPECT_NEAR(value(score, "volume.underbreak_m3"), 0.2 * 4 * 12, 0.5);
  EXPECT_NEAR(value(score, "volume.error_percent"), -10, 0.3);
  EXPECT_NEAR(value(score, "volume.iou"), 1 - value(score, "volume.underbreak_m3") / seen, 1e-9);
}

TEST(VolumeError, ClaimingNothingOrEverythingScoresBadly) {
  const Score nothing = with_surface({9, -0.2, 1}, {9.4, 0.2, 1.4});
  EXPECT_LT(value(nothing, "volume.error_percent"), -99);
  EXPECT_LT(value(nothing, "volume.iou"), 0.01);
  const Score everything = with_surface({-100, -100, -100}, {100, 100, 100});
  // All rock within 0.5 m of 12 x 12 m2 of surface is claimed: more than half of the void again.
  EXPECT_GT(value(everything, "volume.error_percent"), 50);
  EXPECT_LT(value(everything, "volume.iou"), 0.7);
  EXPECT_GT(value(everything, "volume.extrapolated_m3"), 7e6);
}

TEST(VolumeError, WhatIsTooDarkToEchoIsNotObservable) {
  const Score bright = score_of(tunnel_case());
  ExactCase c = tunnel_case();
  LaserModel& up = c.truth.rig.mounts.at(1).laser;
  ASSERT_EQ(find_view(c.nominal, View::up), 1);
  up.reflectivity_at_4m = 0.2;  // every surface of the tunnel is nearer than 4 m
  up.reflectivity_exponent = 2;
  const auto paint = [&](float reflectivity) {
    c.world.mesh.reflectivity.assign(c.world.mesh.face.size(), reflectivity);
    c.truth.world = world_hash(c.world);
  };
  paint(0.5F);  // seen up to an incidence of 66 deg; the farthest corner of the roof is met at 63
  EXPECT_NEAR(value(score_of(c), "volume.observable_m3"), value(bright, "volume.observable_m3"), 1);
  paint(0.1F);
  // The downward fan alone is left: from its laser down and as far up as it overlapped.
  EXPECT_LT(value(score_of(c), "volume.observable_m3"), 0.7 * value(bright, "volume.observable_m3"));
}

TEST(VolumeError, FinerColumnsGiveTheSameVolume) {
  ScoreSettings fine;
  fine.domain_cell_m = 0.05;
  const Score coarse = score_of(tunnel_case()), finer = score_of(tunnel_case(), fine);
  for (const std::string name : {"volume.observable_m3", "volume.mapped_m3"})
    EXPECT_NEAR(value(coarse, name), value(finer, name), 0.01 * value(finer, name)) << name;
}

TEST(VolumeError, AnOpenSurfaceIsRefusedWithItsEdges) {
  ExactCase c = tunnel_case();
  c.estimate.surface.face.pop_back();
  c.estimate.surface.label.pop_back();
  const Score score = score_of(c);
  const Metric* m = score.find("volume.mapped_m3");
  ASSERT_NE(m, nullptr);
  EXPECT_TRUE(std::isnan(m->value));
  EXPECT_NE(m->why.find("3 open edges"), std::string::npos) << m->why;
}

}  // namespace
}  // namespace adit
