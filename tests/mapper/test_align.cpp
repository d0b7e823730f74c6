// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"
#include "base/rng.h"
#include "mapper/align.h"
#include "tests/mapper/open_loop.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

constexpr int legs = 60;  // of 20 m: 1.2 km

// ---------------------------------------------------------------------------------------------- icra2003

TEST(Published, AGoodPathIsNotMadeWorseAndEveryLoopCloses) {
  double before_m = 0, after_m = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const OpenLoop loop = walk_panel(5, 20, legs, rough_ribs, seed);
    const Aligned a = align_published(loop.odometry, {});
    before_m += ate_m(loop.X_true, loop.odometry.X_MB) / 4;
    after_m += ate_m(loop.X_true, a.X_MB) / 4;
    EXPECT_LT(ate_m(loop.X_true, a.X_MB), ate_m(loop.X_true, loop.odometry.X_MB) + 0.02) << "seed " << seed;
    EXPECT_EQ(wrong_places(a.closures, loop.X_true), 0) << "seed " << seed;
    EXPECT_GT(recall(a.closures, loop.X_true), 0.9) << "seed " << seed;  // a node may fall into a bend
    EXPECT_TRUE(a.converged) << "seed " << seed;
  }
  EXPECT_LT(after_m, before_m);
}

TEST(Published, APerfectPathStaysWhereItIs) {
  const OpenLoop loop = walk_panel(5, 20, legs, {}, 3);
  const Aligned a = align_published(loop.odometry, {});
  EXPECT_LT(ate_m(loop.X_true, a.X_MB), 1e-3);  // passages lie side by side by a quarter of a metre; H holds the path
  EXPECT_TRUE(a.converged);
}

TEST(Published, AMetreOfDriftIsHalvedAtLeast) {
  double before_m = 0, after_m = 0;
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    const OpenLoop loop = walk_panel(5, 20, legs, smooth_ribs, seed);
    before_m += ate_m(loop.X_true, loop.odometry.X_MB) / 4;
    after_m += ate_m(loop.X_true, align_published(loop.odometry, {}).X_MB) / 4;
  }
  EXPECT_GT(before_m, 0.7);
  EXPECT_LT(after_m, 0.5 * before_m);
}

TEST(Published, TheFixedPenaltyClosesLoopsToo) {
  PublishedSettings settings;
  settings.penalty = "fixed";
  const Drift drift{1e-3, 1e-3, 2e-4, 0};
  const OpenLoop loop = walk_panel(5, 20, legs, drift, 5);
  EXPECT_LT(ate_m(loop.X_true, align_published(loop.odometry, settings).X_MB),
            0.7 * ate_m(loop.X_true, loop.odometry.X_MB));
}

TEST(Published, ARingDrivenTwiceClosesOnItself) {
  const OpenLoop loop = walk_ring(60, 2, {2e-3, 1e-3, 2e-4, 0}, 2);
  const Aligned a = align_published(loop.odometry, {});
  EXPECT_LT(ate_m(loop.X_true, a.X_MB), 0.5 * ate_m(loop.X_true, loop.odometry.X_MB));
  ASSERT_FALSE(a.rounds.empty());
  EXPECT_GT(a.rounds.back().correspondences.size(), 40u);  // 240 m driven again, a node every 5 m
}

TEST(Published, AWayThatNeverMeetsItselfIsLeftAlone) {
  const OpenLoop loop = walk_panel(2, 100, 2, smooth_ribs, 1);
  const Aligned a = align_published(loop.odometry, {});
  EXPECT_TRUE(a.converged);
  EXPECT_TRUE(a.closures.empty());
  for (size_t i = 0; i < a.X_MB.size(); ++i)
    EXPECT_NEAR((a.X_MB[i].position() - loop.odometry.X_MB[i].position()).norm(), 0, 1e-6);
}

TEST(Published, OneScanIsAMap) {
  Odometry one;
  one.stamp_s = {0};
  one.X_MB = one.X_step = {Pose2{}};
  one.information = {Eigen::Matrix3d::Identity()};
  EXPECT_TRUE(align_published(one, {}).converged);
}

// ---------------------------------------------------------------------------------------------- robust

struct Matcher {
  double sigma_m = 0.01, sigma_rad = 0.002;
  double alias_share = 0;  // of the matches are off by some metres, stated as good as the others
  double ambiguous_share = 0;
};

/// Matches as scans would give them: from the truth, with noise, some of them aliases.
MatchPlaces simulated(const OpenLoop& loop, const Matcher& m, std::uint64_t seed) {
  return [&loop, m, seed](const std::vector<PlacePair>& pairs) {
    std::vector<PlaceMatch> result;
    for (const PlacePair& pair : pairs) {
      const auto draw = [&](int k) { return normal(seed, Draw::test, 1000 + k, pair.i * 100000ULL + pair.j); };
      const auto chance = [&](int k) { return uniform(seed, Draw::test, 2000 + k, pair.i * 100000ULL + pair.j); };
      PlaceMatch match;
      const Pose2 X_true = loop.X_true[pair.i].inverse() * loop.X_true[pair.j];
      Pose2 e{m.sigma_m * draw(0), m.sigma_m * draw(1), m.sigma_rad * draw(2)};
      if (chance(0) < m.alias_share) e = {4 * (chance(1) - 0.5), 4 * (chance(2) - 0.5), 0.1 * draw(3)};
      match.X_ij = X_true * e;
      match.found =
          X_true.position().norm() < 6 && (pair.X_ij.inverse() * match.X_ij).position().norm() < pair.reach_m + 0.3;
      match.ambiguous = chance(4) < m.ambiguous_share;
      const Eigen::Vector3d w(1 / (m.sigma_m * m.sigma_m), 1 / (m.sigma_m * m.sigma_m),
                              1 / (m.sigma_rad * m.sigma_rad));
      match.information = w.asDiagonal();
      result.push_back(match);
    }
    return result;
  };
}

int wrong_poses(const std::vector<Closure>& closures, const std::vector<Pose2>& X_true) {
  int wrong = 0;
  for (const Closure& c : closures) {
    const Pose2 e = (X_true[c.i].inverse() * X_true[c.j]).inverse() * c.X_ij;
    wrong += c.accepted && (e.position().norm() > 0.5 || std::abs(e.yaw_rad) > 0.05);
  }
  return wrong;
}

TEST(Robust, DriftOfMetresIsClosed) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const OpenLoop loop = walk_panel(5, 20, legs, smooth_ribs, seed);
    const Aligned a = align_robust(loop.odometry, simulated(loop, {}, seed), {});
    EXPECT_LT(ate_m(loop.X_true, a.X_MB), 0.3)
        << "seed " << seed;  // a leg that is driven once drifts by 0.03 m sqrt(133) = 0.35 m between closures
    EXPECT_EQ(wrong_poses(a.closures, loop.X_true), 0) << "seed " << seed;
    EXPECT_GT(recall(a.closures, loop.X_true), 0.9) << "seed " << seed;  // a node may fall into a bend
    EXPECT_TRUE(a.converged) << "seed " << seed;
  }
}

TEST(Robust, AGoodPathIsMadeBetter) {
  const OpenLoop loop = walk_panel(5, 20, legs, rough_ribs, 7);
  const Aligned a = align_robust(loop.odometry, simulated(loop, {}, 7), {});
  EXPECT_LT(ate_m(loop.X_true, a.X_MB), 0.5 * ate_m(loop.X_true, loop.odometry.X_MB));
}

TEST(Robust, AFifthOfAliasesBendsNothing) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const OpenLoop loop = walk_panel(5, 20, legs, smooth_ribs, seed);
    Matcher matcher;
    matcher.alias_share = 0.2;
    const Aligned a = align_robust(loop.odometry, simulated(loop, matcher, seed), {});
    EXPECT_EQ(wrong_poses(a.closures, loop.X_true), 0) << "seed " << seed;
    EXPECT_LT(ate_m(loop.X_true, a.X_MB), 0.3) << "seed " << seed;
  }
}

TEST(Robust, AmbiguousMatchesAreReportedAndBendNothing) {
  const OpenLoop loop = walk_panel(5, 20, legs, smooth_ribs, 4);
  Matcher matcher;
  matcher.ambiguous_share = 1;
  const Aligned a = align_robust(loop.odometry, simulated(loop, matcher, 4), {});
  ASSERT_FALSE(a.closures.empty());
  for (const Closure& c : a.closures) EXPECT_TRUE(c.ambiguous && !c.accepted);
  EXPECT_NEAR(ate_m(loop.odometry.X_MB, a.X_MB), 0, 1e-6);
}

TEST(Robust, TheSameOnAnyNumberOfThreads) {
  const OpenLoop loop = walk_panel(5, 20, 30, smooth_ribs, 6);
  std::vector<Pose2> first;
  for (int count : {1, 2, 7}) {
    set_threads(count);
    const std::vector<Pose2> X = align_robust(loop.odometry, simulated(loop, {}, 6), {}).X_MB;
    if (first.empty()) first = X;
    for (size_t i = 0; i < X.size(); ++i)
      ASSERT_TRUE(X[i].x_m == first[i].x_m && X[i].y_m == first[i].y_m && X[i].yaw_rad == first[i].yaw_rad)
          << count << " threads";
  }
  set_threads(0);
}

}  // namespace
}  // namespace adit
