// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/chance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace adit {
namespace {

TEST(Chance, IsBoxAndMullersOfTheWordsAtItsAddress) {
  const Draws draws(7, Draw::beam_chance);
  std::vector<Chance> chances(1000);
  draw_chances(draws, 33, chances);
  for (std::uint64_t k = 0; k < chances.size(); ++k) {
    const auto w = draws.at(33, k);
    const double u = (w[0] + 0.5) / 4294967296.0, v = (w[1] + 0.5) / 4294967296.0;
    const double r = std::sqrt(-2 * std::log(u));
    // Near u = 1 the logarithm is a difference of numbers of size one, which keeps 1e-14 of it; its root keeps 1e-9.
    EXPECT_NEAR(chances[k].range, r * std::cos(2 * M_PI * v), 1e-9) << k;
    EXPECT_NEAR(chances[k].angle, r * std::sin(2 * M_PI * v), 1e-9) << k;
    EXPECT_EQ(chances[k].detect, (w[2] + 0.5) / 4294967296.0);
    EXPECT_EQ(chances[k].drop, (w[3] + 0.5) / 4294967296.0);
  }
}

TEST(Chance, OfOneBeamIsThatOfItInItsScanBitForBit) {
  const Draws draws(7, Draw::beam_chance);
  std::vector<Chance> chances(361);
  draw_chances(draws, 5, chances);
  for (std::uint64_t k = 0; k < chances.size(); ++k) {
    const Chance one = chance_at(draws, 5, k);
    EXPECT_EQ(one.range, chances[k].range);
    EXPECT_EQ(one.angle, chances[k].angle);
    EXPECT_EQ(one.detect, chances[k].detect);
  }
}

TEST(Chance, RangeAndAngleAreNormalAndIndependent) {
  const Draws draws(3, Draw::beam_chance);
  std::vector<Chance> c(100000);
  draw_chances(draws, 1, c);
  const double n = static_cast<double>(c.size());
  double sum = 0, squares = 0, fourth = 0, product = 0;
  for (const Chance& x : c) {
    sum += x.range;
    squares += x.range * x.range;
    fourth += std::pow(x.range, 4);
    product += x.range * x.angle;
  }
  EXPECT_NEAR(sum / n, 0, 5 / std::sqrt(n));          // five standard errors
  EXPECT_NEAR(squares / n, 1, 5 * std::sqrt(2 / n));  // of a variance
  EXPECT_NEAR(fourth / n, 3, 5 * std::sqrt(96 / n));  // of a fourth moment
  EXPECT_NEAR(product / n, 0, 5 / std::sqrt(n));
}

}  // namespace
}  // namespace adit
