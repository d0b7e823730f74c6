// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "mapper/certificate.h"
#include "mapper/graph.h"
#include "mapper/graph_start.h"
#include "mapper/lifted.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace adit {
namespace {

/// A walk over a lattice of streets, steps of one metre, with edges between visits of the same crossing.
PoseGraph streets(std::uint64_t seed, int nodes, double sigma_m, double sigma_rad) {
  PoseGraph graph;
  std::vector<Pose2> truth = {{0, 0, 0}};
  std::map<std::pair<int, int>, int> last;
  std::uint64_t draw = 0;
  const auto noise = [&](double sigma) { return sigma * normal(seed, Draw::test, draw++); };
  const auto add = [&](int i, int j) {
    const Pose2 X = truth[i].inverse() * truth[j] * Pose2{noise(sigma_m), noise(sigma_m), noise(sigma_rad)};
    graph.edge.push_back(
        {i, j, X, Eigen::Vector3d(std::pow(sigma_m, -2), std::pow(sigma_m, -2), std::pow(sigma_rad, -2)).asDiagonal()});
  };
  for (int k = 1; k < nodes; ++k) {
    const double turn = std::floor(3 * uniform(seed, Draw::test, 1u << 20, k)) - 1;
    const double yaw = k % 4 == 0 ? turn * std::numbers::pi / 2 : 0;
    Pose2 next = truth.back() * Pose2{1, 0, yaw};
    if (std::abs(next.x_m) > 12 || std::abs(next.y_m) > 12) next = truth.back() * Pose2{0, 0, std::numbers::pi / 2};
    truth.push_back(next);
    add(k - 1, k);
    const auto place = std::pair(static_cast<int>(std::lround(next.x_m)), static_cast<int>(std::lround(next.y_m)));
    if (const auto seen = last.find(place); seen != last.end() && k - seen->second > 4) add(seen->second, k);
    last[place] = k;
  }
  graph.node.assign(nodes, {});
  graph.node = odometric_start(graph);
  return graph;
}

/// A ring of n nodes, noise in its edges, that starts with `turns` whole turns too many along the way.
PoseGraph ring(int n, int turns, double sigma) {
  PoseGraph graph;
  const double step = 2 * std::numbers::pi / n;
  for (int k = 0; k < n; ++k) {
    graph.edge.push_back(
        {k,
         (k + 1) % n,
         {1 + sigma * normal(1, Draw::test, k), 0, wrap_angle(step + sigma * normal(2, Draw::test, k))},
         Eigen::Vector3d(1, 1, 100).asDiagonal()});
    graph.node.push_back({0, 0, wrap_angle(k * step * (1 + turns))});
  }
  return graph;
}

TEST(Certificate, GraphsWithHardlyAnyNoiseAreCertified) {
  PoseGraph graph = streets(1, 200, 1e-4, 1e-4);
  graph.node = solve(graph).node;
  const Certificate c = certify(graph);
  EXPECT_TRUE(c.certified) << verdict(c);
  EXPECT_LT(c.gap_bound, 1);          // beside weights of 1e8
  EXPECT_LT(c.distance_max_m, 1e-2);  // some hundred steps with a noise of 1e-4
}

TEST(Certificate, TheOptimumOfNoisyStreetsIsCertifiedFromTheChordalStart) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    PoseGraph graph = streets(seed, 500, 0.05, 0.03);
    graph.node = chordal_start(graph);
    graph.node = solve(graph).node;
    const Certificate c = certify(graph);
    EXPECT_TRUE(c.certified) << "seed " << seed << ": " << verdict(c);
    EXPECT_LE(c.gap_bound, 1.2e-7 * c.objective);                     // the threshold's 1e-7 and rounding
    EXPECT_NEAR(c.smallest_eigenvalue, 0, 1e-3 * c.objective / 500);  // x itself is in the kernel
    EXPECT_LE(c.objective, c.given_objective * (1 + 1e-12));
  }
}

TEST(Certificate, ALocalOptimumIsNeverCertified) {
  // A ring that was wound once too often is stationary, and wrong.
  const int n = 60;
  PoseGraph wound = ring(n, 1, 0.01), right = ring(n, 0, 0.01);
  const Certificate bad = certify(wound), good = certify(right);
  EXPECT_TRUE(bad.stationary);
  EXPECT_FALSE(bad.certified);
  EXPECT_LT(bad.smallest_eigenvalue, -bad.threshold);
  ASSERT_TRUE(good.certified) << verdict(good);
  EXPECT_GT(bad.objective, 10 * good.objective);
  EXPECT_LE(bad.objective - bad.gap_bound, good.objective);  // what the bound promises
}

TEST(Certificate, NoStartOfManyBeatsACertifiedValue) {
  PoseGraph graph = streets(9, 150, 0.1, 0.1);
  graph.node = chordal_start(graph);
  const Certificate c = certify(graph);
  ASSERT_TRUE(c.certified) << verdict(c);
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    PoseGraph other = graph;
    for (size_t k = 1; k < other.node.size(); ++k)
      other.node[k] = {10 * normal(seed, Draw::test, k, 1), 10 * normal(seed, Draw::test, k, 2),
                       normal(seed, Draw::test, k, 3)};
    const Certificate found = certify(other);
    EXPECT_GE(found.objective, c.objective - c.gap_bound) << "seed " << seed;
    EXPECT_TRUE(!found.certified || found.objective <= c.objective * 1.001) << "seed " << seed;
  }
}

TEST(Certificate, ValueIsThatOfTheFormulaByHand) {
  // Two nodes a metre apart, the edge measured as 1.5 m and turned by 0.3: tau = 4, kappa = 9.
  PoseGraph graph;
  graph.node = {{0, 0, 0}, {1, 0, 0}};
  graph.edge = {{0, 1, {1.5, 0, 0.3}, Eigen::Vector3d(4, 4, 9).asDiagonal()}};
  const Certificate c = certify(graph);
  EXPECT_NEAR(c.given_objective, 4 * 0.25 + 9 * 8 * std::pow(std::sin(0.15), 2), 1e-12);
  EXPECT_NEAR(c.objective, 0, 1e-12);
  EXPECT_NEAR(c.distance_max_m, 0.5, 1e-9);
  EXPECT_NEAR(c.distance_max_rad, 0.3, 1e-9);
}

TEST(Certificate, LiftingLeavesALocalOptimum) {
  PoseGraph wound = ring(60, 1, 0.01);
  const Certificate before = certify(wound);
  wound.node = lifted_start(wound).node;
  const Certificate after = certify(wound);
  EXPECT_TRUE(after.certified) << verdict(after);
  EXPECT_LT(after.objective, 0.1 * before.objective);
}

TEST(Certificate, MultipliersOfTheLiftBoundWhatTheOwnCannot) {
  // Noise so large that the chordal start ends in a local optimum.
  PoseGraph graph = streets(5, 400, 0.1, 0.35);
  graph.node = chordal_start(graph);
  const Lift lift = lifted_start(graph);
  const Certificate alone = certify(graph), bounded = certify(graph, lift.multiplier);
  PoseGraph lifted = graph;
  lifted.node = lift.node;
  const Certificate best = certify(lifted, lift.multiplier);
  EXPECT_LE(best.objective, alone.objective * (1 + 1e-9));
  EXPECT_LE(bounded.gap_bound, alone.gap_bound);
  EXPECT_GE(best.objective, bounded.objective - bounded.gap_bound);  // what the bound promises
  EXPECT_LT(best.gap_bound, 0.01 * best.objective);
}

TEST(GraphStart, BothStartsAreTheTruthWhereThereIsNoNoise) {
  const PoseGraph graph = streets(3, 300, 1e-9, 1e-9);
  const std::vector<Pose2> chordal = chordal_start(graph), odometric = odometric_start(graph);
  for (size_t k = 0; k < graph.node.size(); ++k)
    EXPECT_LT((chordal[k].position() - odometric[k].position()).norm(), 1e-5) << k;
}

TEST(GraphStart, AnEdgeThatPointsBackwardsIsFollowedToo) {
  PoseGraph graph;
  graph.node = {{1, 2, 0.5}, {}, {}};
  graph.edge = {{1, 0, Pose2{1, 0, 0.1}.inverse(), Eigen::Matrix3d::Identity()},
                {2, 1, Pose2{2, 0, 0.2}.inverse(), Eigen::Matrix3d::Identity()}};
  const Pose2 expected = graph.node[0] * Pose2{1, 0, 0.1} * Pose2{2, 0, 0.2};
  for (const auto& start : {odometric_start(graph), chordal_start(graph)}) {
    EXPECT_NEAR(start[2].x_m, expected.x_m, 1e-12);
    EXPECT_NEAR(start[2].y_m, expected.y_m, 1e-12);
    EXPECT_NEAR(start[2].yaw_rad, expected.yaw_rad, 1e-12);
  }
}

TEST(GraphCovariances, AreThoseOfOneSolutionForEachNode) {
  PoseGraph graph = streets(4, 120, 0.05, 0.03);
  graph.node = solve(graph).node;
  std::vector<std::pair<int, int>> pairs;
  for (int k = 0; k < 120; ++k) pairs.emplace_back(0, k);
  const auto expected = relative_covariances(graph, std::span(pairs).subspan(1)), got = covariances(graph);
  EXPECT_EQ(got[0].norm(), 0);
  for (int k = 1; k < 120; ++k) EXPECT_LT((got[k] - expected[k - 1]).norm(), 1e-9 * expected[k - 1].norm()) << k;
}

}  // namespace
}  // namespace adit
