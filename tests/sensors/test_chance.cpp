// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/chance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace adit {
namespace {

Chances drawn(const Draws& draws, std::uint64_t scan, size_t n, Normals normal) {
  Chances chances;
  chances.resize(n);
  draw_chances(draws, scan, n, normal, chances, 0);
  return chances;
}

TEST(Chance, WithoutNormalNumbersTheOthersAreTheSame) {
  const Draws draws(7, Draw::beam_chance);
  const Chances all = drawn(draws, 9, 100, Normals::both), some = drawn(draws, 9, 100, Normals::none);
  EXPECT_EQ(some.detect, all.detect);
  EXPECT_EQ(some.drop, all.drop);
  EXPECT_EQ(some.range, std::vector<double>(100, 0.0));
  const Chances half = drawn(draws, 9, 100, Normals::range);
  EXPECT_EQ(half.range, all.range);
  EXPECT_EQ(half.angle, std::vector<double>(100, 0.0));
}

TEST(Chance, IsBoxAndMullersOfTheWordsAtItsAddress) {
  const Draws draws(7, Draw::beam_chance);
  const Chances chances = drawn(draws, 33, 1000, Normals::both);
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

TEST(Chance, WordsSideBySideAreThoseAtTheirAddresses) {
  const Draws draws(7, Draw::beam_chance);
  for (const std::uint64_t j : {0ULL, 5ULL, 0xFFFFFFFCULL})  // the last one carries into its upper half
    for (const std::uint64_t i : {3ULL, 0x500000001ULL}) {
      std::uint32_t words[4][8];
      draws.eight_at(i, j, words);
      for (std::uint64_t k = 0; k < 8; ++k)
        for (size_t w = 0; w < 4; ++w) EXPECT_EQ(words[w][k], draws.at(i, j + k)[w]) << i << " " << j + k << " " << w;
    }
}

TEST(Chance, OfOneBeamIsThatOfItInItsScanBitForBit) {
  const Draws draws(7, Draw::beam_chance);
  const Chances chances = drawn(draws, 5, 361, Normals::both);
  for (std::uint64_t k = 0; k < chances.size(); ++k) {
    const Chance one = chance_at(draws, 5, k);
    EXPECT_EQ(one.range, chances[k].range);
    EXPECT_EQ(one.angle, chances[k].angle);
    EXPECT_EQ(one.detect, chances[k].detect);
  }
}

TEST(Chance, RangeAndAngleAreNormalAndIndependent) {
  const Draws draws(3, Draw::beam_chance);
  const Chances c = drawn(draws, 1, 100000, Normals::both);
  const double n = static_cast<double>(c.size());
  double sum = 0, squares = 0, fourth = 0, product = 0;
  for (size_t k = 0; k < c.size(); ++k) {
    const Chance x = c[k];
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
