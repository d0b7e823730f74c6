// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/closures.h"
#include "tests/mapper/open_loop.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

std::vector<Closure> as_closures(const std::vector<Encounter>& found) {
  std::vector<Closure> result;
  for (const Encounter& e : found) result.push_back({e.foot_scan, e.scan, {}, false, true, false});
  return result;
}

std::vector<int> every(const Chain& chain) {
  return chain.scan;
}

TEST(Chain, NodesStandEveryFiveMetresAndKeepTheEnds) {
  const OpenLoop loop = walk_panel(4, 20, 30, rough_ribs, 1);
  const Chain chain = chain_of(loop.odometry, 5);
  EXPECT_EQ(chain.scan.front(), 0);
  EXPECT_EQ(chain.scan.back(), static_cast<int>(loop.X_true.size()) - 1);
  for (size_t k = 0; k + 2 < chain.scan.size(); ++k) {
    const double d = chain.along_m[chain.scan[k + 1]] - chain.along_m[chain.scan[k]];
    EXPECT_GE(d, 5);
    EXPECT_LT(d, 5.4);  // a scan every 0.15 m, of which swaying makes a little more
  }
}

TEST(Chain, StandingStillIsNoWay) {
  OpenLoop loop = walk_panel(4, 20, 2, rough_ribs, 1);
  Odometry& o = loop.odometry;
  const double driven = chain_of(o, 5).along_m.back();
  const Pose2 stand = o.X_MB.back();
  for (int k = 0; k < 5000; ++k) {
    o.X_MB.push_back(stand * Pose2{0.004 * std::sin(k), 0.004 * std::cos(1.7 * k), 0});
    o.X_step.push_back(o.X_MB[o.X_MB.size() - 2].inverse() * o.X_MB.back());
    o.information.push_back(o.information.back());
  }
  EXPECT_NEAR(chain_of(o, 5).along_m.back(), driven, 0.2);
}

TEST(Chain, ComposedStepsLeadFromNodeToNode) {
  const OpenLoop loop = walk_panel(4, 20, 10, smooth_ribs, 2);
  const Chain chain = chain_of(loop.odometry, 5);
  for (const Relative& step : chain.step) {
    const Pose2 X = loop.odometry.X_MB[chain.scan[step.i]] * step.X_ij;
    EXPECT_NEAR((X.position() - loop.odometry.X_MB[chain.scan[step.j]].position()).norm(), 0, 1e-9);
  }
}

TEST(Chain, SpreadingUnmovedNodesGivesTheOpenLoop) {
  const OpenLoop loop = walk_panel(4, 20, 10, smooth_ribs, 3);
  const Chain chain = chain_of(loop.odometry, 5);
  std::vector<Pose2> node;
  for (int i : chain.scan) node.push_back(loop.odometry.X_MB[i]);
  const std::vector<Pose2> X = spread(chain, loop.odometry.X_MB, node);
  for (size_t i = 0; i < X.size(); ++i)
    EXPECT_NEAR((X[i].position() - loop.odometry.X_MB[i].position()).norm(), 0, 1e-9);
}

TEST(Chain, SpreadingNodesOfATurnedPathTurnsEveryScan) {
  const OpenLoop loop = walk_panel(4, 20, 10, smooth_ribs, 4);
  const Chain chain = chain_of(loop.odometry, 5);
  const Pose2 T{3, -2, 0.7};
  std::vector<Pose2> node;
  for (int i : chain.scan) node.push_back(T * loop.odometry.X_MB[i]);
  const std::vector<Pose2> X = spread(chain, loop.odometry.X_MB, node);
  for (size_t i = 0; i < X.size(); ++i)
    EXPECT_NEAR((X[i].position() - (T * loop.odometry.X_MB[i]).position()).norm(), 0, 1e-9);
}

TEST(Encounters, OnTheTruePathAllRevisitsAreFoundAndNoneIsWrong) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const OpenLoop loop = walk_panel(5, 12, 80, {}, seed);
    const Chain chain = chain_of(loop.odometry, 5);
    const std::vector<Encounter> found = find_encounters(chain, loop.X_true, every(chain), {});
    EXPECT_GT(found.size(), 50u);
    EXPECT_EQ(wrong_places(as_closures(found), loop.X_true), 0) << "seed " << seed;
    EXPECT_GT(recall(as_closures(found), loop.X_true), 0.9) << "seed " << seed;  // a node may fall into a bend
  }
}

TEST(Encounters, TheFootOfThePerpendicularLiesBetweenTheScans) {
  const OpenLoop loop = walk_ring(40, 2, {}, 3);
  const Chain chain = chain_of(loop.odometry, 5);
  const std::vector<double> direction = directions(chain, loop.X_true);
  const std::vector<Encounter> found = find_encounters(chain, loop.X_true, every(chain), {});
  ASSERT_GT(found.size(), 25u);
  for (const Encounter& e : found) {
    const int i = static_cast<int>(e.foot);
    const double s = e.foot - i;
    const Vec2 p = s > 0 ? blend(loop.X_true[i], loop.X_true[i + 1], s).position() : loop.X_true[i].position();
    const Vec2 d = p - loop.X_true[e.scan].position(), t(std::cos(direction[e.scan]), std::sin(direction[e.scan]));
    const double tolerance_m = e.foot > 1 ? 1e-9 : 0.5;  // the path's very beginning has no foot before it
    EXPECT_NEAR(t.dot(d), 0, tolerance_m) << "scan " << e.scan;
    EXPECT_NEAR(e.offset_m, Vec2(-t.y(), t.x()).dot(d), 1e-12);
    EXPECT_FALSE(e.opposite);
  }
}

TEST(Encounters, AWayBackIsOpposite) {
  // Out along a straight way, round a block and back the same way.
  OpenLoop loop;
  std::vector<Pose2>& X = loop.X_true;
  for (int k = 0; k < 300; ++k) X.push_back({0.15 * k, 0, 0});
  for (int k = 1; k < 100; ++k) X.push_back({45 + 5 * std::sin(0.0314 * k), 5 - 5 * std::cos(0.0314 * k), 0.0314 * k});
  for (int k = 0; k < 60; ++k) X.push_back({45 - 0.15 * k, 10 - 10 * (k / 60.0), wrap_angle(3.14 + 0.8)});
  for (int k = 0; k < 200; ++k) X.push_back({36 - 0.15 * k, 0.5, 3.14159});
  for (size_t i = 0; i < X.size(); ++i) {
    loop.odometry.X_MB.push_back(X[i]);
    loop.odometry.X_step.push_back(i > 0 ? X[i - 1].inverse() * X[i] : Pose2{});
    loop.odometry.information.push_back(Eigen::Matrix3d::Identity());
  }
  const Chain chain = chain_of(loop.odometry, 1);
  int opposite = 0;
  for (const Encounter& e : find_encounters(chain, X, {470, 520, 570, 620}, {})) {
    EXPECT_TRUE(e.opposite);
    EXPECT_NEAR(e.offset_m, 0.5, 1e-9);  // driving west, the first way lies 0.5 m to the left
    ++opposite;
  }
  EXPECT_EQ(opposite, 4);
}

TEST(Encounters, CrossingWaysAreNoEncounter) {
  OpenLoop loop;
  for (int k = 0; k < 200; ++k) loop.odometry.X_MB.push_back({0.15 * k - 15, 0, 0});
  for (int k = 0; k < 200; ++k) loop.odometry.X_MB.push_back({0, 15 - 0.15 * k, -1.5708});
  for (size_t i = 0; i < loop.odometry.X_MB.size(); ++i) {
    loop.odometry.X_step.push_back(i > 0 ? loop.odometry.X_MB[i - 1].inverse() * loop.odometry.X_MB[i] : Pose2{});
    loop.odometry.information.push_back(Eigen::Matrix3d::Identity());
  }
  const Chain chain = chain_of(loop.odometry, 0.5);
  EXPECT_TRUE(find_encounters(chain, loop.odometry.X_MB, chain.scan, {}).empty());
}

}  // namespace
}  // namespace adit
