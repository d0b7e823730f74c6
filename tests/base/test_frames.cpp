// SPDX-License-Identifier: BSD-3-Clause
#include "base/frames.h"
#include "base/rng.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

Pose2 any_pose2(int i) {
  return {10 * normal(3, Draw::test, i, 0), 10 * normal(3, Draw::test, i, 1), 6 * (uniform(3, Draw::test, i, 2) - 0.5)};
}

TEST(Frames, APoseInThePlaneTimesItsInverseIsIdentity) {
  for (int i = 0; i < 100; ++i) {
    const Pose2 X = any_pose2(i), I = X * X.inverse();
    EXPECT_NEAR(I.x_m, 0, 1e-12) << "i = " << i;
    EXPECT_NEAR(I.y_m, 0, 1e-12);
    EXPECT_NEAR(I.yaw_rad, 0, 1e-12);
  }
}

TEST(Frames, PlanarPosesComposeAsTheirLiftedOnes) {
  for (int i = 0; i < 100; ++i) {
    const Pose2 A = any_pose2(2 * i), B = any_pose2(2 * i + 1);
    const Pose both = lift(A) * lift(B);
    EXPECT_TRUE(both.isApprox(lift(A * B), 1e-12)) << "i = " << i;
    EXPECT_NEAR((flatten(both).position() - (A * B).position()).norm(), 0, 1e-12);
  }
}

TEST(Frames, WrappedAnglesLieInTheHalfOpenTurn) {
  constexpr double pi = std::numbers::pi;
  EXPECT_DOUBLE_EQ(wrap_angle(3 * pi), pi);
  EXPECT_DOUBLE_EQ(wrap_angle(-pi), pi);
  EXPECT_NEAR(wrap_angle(-7), -7 + 2 * pi, 1e-12);
}

TEST(Frames, PositivePitchLooksDownAndPositiveRollLiftsTheLeftSide) {
  EXPECT_LT((rotation_of(0, 0.1, 0) * Vec3::UnitX()).z(), 0);
  EXPECT_GT((rotation_of(0, 0, 0.1) * Vec3::UnitY()).z(), 0);
}

TEST(Frames, YawPitchRollComeBack) {
  for (int i = 0; i < 100; ++i) {
    const double y = 6 * (uniform(4, Draw::test, i, 0) - 0.5), p = 3 * (uniform(4, Draw::test, i, 1) - 0.5),
                 r = 6 * (uniform(4, Draw::test, i, 2) - 0.5);
    const YawPitchRoll a = yaw_pitch_roll(rotation_of(y, p, r));
    EXPECT_NEAR(a.yaw_rad, y, 1e-10);
    EXPECT_NEAR(a.pitch_rad, p, 1e-10);
    EXPECT_NEAR(a.roll_rad, r, 1e-10);
  }
}

TEST(Frames, HalfWayBetweenTwoPosesTurnsHalfTheAngle) {
  const Pose A = pose_of({0, 0, 0}, 0.2), B = pose_of({2, 4, 6}, 0.8), H = interpolate(A, B, 0.5);
  EXPECT_TRUE(H.isApprox(pose_of({1, 2, 3}, 0.5), 1e-12));
}

}  // namespace
}  // namespace adit
