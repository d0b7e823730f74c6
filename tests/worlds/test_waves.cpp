// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/waves.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

Vec2 place(int i) {
  return 400 * Vec2(uniform(1, Draw::test, i, 0), uniform(1, Draw::test, i, 1));
}

TEST(Waves, RmsOverALargePlaceIsTheOneAskedFor) {
  for (std::uint64_t seed : {1, 2, 3}) {
    const Waves f({0.05, 0.5}, seed, Draw::test, 0, true);
    double sum = 0;
    const int n = 20000;
    for (int i = 0; i < n; ++i) sum += std::pow(f(place(i)), 2);
    // The variance of n squares is 2 s^4: five standard errors of the mean square are 5 sqrt(2 / n) = 5 % of it.
    EXPECT_NEAR(sum / n / (0.05 * 0.05), 1, 0.05) << "seed " << seed;
  }
}

// Structure function of a self-affine profile: E (f(x + r) - f(x))^2 ~ r^2H below the correlation length.
TEST(Waves, ProfilesAreSelfAffineBelowTheCorrelationLength) {
  const double hurst = 0.7, correlation = 20;
  double difference[2] = {0, 0};
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const Waves f({1, correlation, hurst, 0, 3000}, seed, Draw::test, 0, false);
    for (int i = 0; i < 500; ++i) {
      const Vec2 p = place(i);
      for (int k = 0; k < 2; ++k) difference[k] += std::pow(f(Vec2(p + Vec2(0.5 * (k + 1), 0))) - f(p), 2);
    }
  }
  // A tenth is left of the bend at the correlation length and of the finite number of waves.
  EXPECT_NEAR(std::log2(difference[1] / difference[0]), 2 * hurst, 0.14);
}

TEST(Waves, LeavingOutShortWavesKeepsTheLongOnes) {
  const Waves all({1, 2, 0.7}, 5, Draw::test, 0, true), coarse({1, 2, 0.7, 0.4}, 5, Draw::test, 0, true);
  double same = 0, off = 0;
  for (int i = 0; i < 2000; ++i) {
    same += std::pow(all(place(i)), 2);
    off += std::pow(all(place(i)) - coarse(place(i)), 2);
  }
  EXPECT_GT(off, 0);
  // Share of the variance above k = 2 pi / 0.4: (1 + (k l)^2)^-H = 0.8 %; a wave of 96 more or less by stratification.
  EXPECT_LT(off / same, 0.03);
}

TEST(Waves, ValuesStayWithinTheBound) {
  const Waves f({0.1, 0.5, 0.7, 0, 96, 2}, 3, Draw::test, 0, false);
  double most = 0;
  for (int i = 0; i < 5000; ++i) most = std::max(most, std::abs(f(place(i))));
  EXPECT_LE(most, 0.2);
  EXPECT_GT(most, 0.19);  // 5 % of normal values lie beyond two sigma
}

TEST(Waves, AFlatFieldDoesNotKnowHeight) {
  const Waves flat({1, 1}, 3, Draw::test, 0, true), solid({1, 1}, 3, Draw::test, 0, false);
  EXPECT_EQ(flat(Vec3(1, 2, 0)), flat(Vec3(1, 2, 7)));
  EXPECT_NE(solid(Vec3(1, 2, 0)), solid(Vec3(1, 2, 7)));
}

}  // namespace
}  // namespace adit
