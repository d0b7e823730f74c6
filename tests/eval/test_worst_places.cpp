// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "eval/worst_places.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace adit {
namespace {

// Points over a field of 80 m x 60 m, whose error differs from square to square.
LaidPoints field_of_errors(std::uint64_t seed) {
  LaidPoints laid;
  for (std::uint64_t i = 0; i < 60000; ++i) {
    const Vec3 p(80 * uniform(seed, Draw::test, i, 0), 60 * uniform(seed, Draw::test, i, 1), 0);
    const auto square =
        static_cast<std::uint64_t>(std::floor(p.x() / 2)) * 1000 + static_cast<std::uint64_t>(std::floor(p.y() / 2));
    laid.foot_W.push_back(p);
    laid.face.push_back(0);
    laid.error_m.push_back(static_cast<float>(uniform(seed + 1, Draw::test, square) * normal(seed, Draw::test, i, 2)));
  }
  return laid;
}

TEST(WorstPlaces, AreTheTenWorstOfAllThatLieApart) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const LaidPoints laid = field_of_errors(seed);
    const World empty;
    const std::vector<WorstPlace> found = worst_places(laid, PassageMap(empty));
    struct Square {
      Vec3 sum = Vec3::Zero();
      double absolute = 0;
      int n = 0;
    };
    std::map<std::pair<int, int>, Square> squares;
    for (size_t i = 0; i < laid.foot_W.size(); ++i) {
      Square& s = squares[{static_cast<int>(laid.foot_W[i].x() / 2), static_cast<int>(laid.foot_W[i].y() / 2)}];
      s.sum += laid.foot_W[i];
      s.absolute += std::abs(static_cast<double>(laid.error_m[i]));
      ++s.n;
    }
    // Ten times the worst of those that are left.
    std::vector<Vec3> chosen;
    for (int k = 0; k < 10; ++k) {
      double most = -1;
      Vec3 place;
      for (const auto& [at, s] : squares) {
        if (s.n < 20 || s.absolute / s.n <= most) continue;
        const Vec3 p = s.sum / s.n;
        bool near = false;
        for (const Vec3& c : chosen) near = near || (c - p).norm() < 10;
        if (!near) most = s.absolute / s.n, place = p;
      }
      chosen.push_back(place);
      ASSERT_LT(static_cast<size_t>(k), found.size()) << "seed " << seed;
      EXPECT_NEAR((found[k].p_W - place).norm(), 0, 1e-9) << "seed " << seed << ", place " << k;
      EXPECT_NEAR(found[k].mae_m, most, 1e-12) << "seed " << seed << ", place " << k;
    }
    EXPECT_EQ(found.size(), 10u);
  }
}

}  // namespace
}  // namespace adit
