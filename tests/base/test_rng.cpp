// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

TEST(Rng, AnAddressAlwaysGivesTheSameNumberAndAnotherGivesAnother) {
  EXPECT_EQ(random_bits(7, Draw::test, 1, 2), random_bits(7, Draw::test, 1, 2));
  EXPECT_NE(random_bits(7, Draw::test, 1, 2), random_bits(8, Draw::test, 1, 2));
  EXPECT_NE(random_bits(7, Draw::test, 1, 2), random_bits(7, Draw::route, 1, 2));
  EXPECT_NE(random_bits(7, Draw::test, 1, 2), random_bits(7, Draw::test, 2, 1));
}

TEST(Rng, UniformHasTheMomentsOfAUniform) {
  const int n = 100000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double u = uniform(1, Draw::test, i);
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));  // five standard errors
  EXPECT_NEAR(squares / n, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n));
}

TEST(Rng, NormalHasTheMomentsOfANormalAndNeighboursAreIndependent) {
  const int n = 100000;
  double sum = 0, squares = 0, fourth = 0, product = 0, last = 0;
  for (int i = 0; i < n; ++i) {
    const double x = normal(2, Draw::test, i);
    sum += x;
    squares += x * x;
    fourth += x * x * x * x;
    product += x * last;
    last = x;
  }
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / n, 3, 5 * std::sqrt(96.0 / n));
  EXPECT_NEAR(product / n, 0, 5 / std::sqrt(n));
}

}  // namespace
}  // namespace adit
