// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "mapper/graph.h"
#include "tests/mapper/open_loop.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

double draw(std::uint64_t seed, std::uint64_t i) {
  return normal(seed, Draw::test, i);
}
Pose2 pose(std::uint64_t seed, std::uint64_t i) {
  return {draw(seed, 3 * i), draw(seed, 3 * i + 1), draw(seed, 3 * i + 2)};
}

Matrix3 some_information(std::uint64_t seed) {
  Matrix3 A;
  for (int k = 0; k < 9; ++k) A(k) = draw(seed, 100 + k);
  return 100 * (A * A.transpose() + 0.1 * Matrix3::Identity());
}

void expect_same(const Pose2& a, const Pose2& b, double tolerance) {
  EXPECT_NEAR(a.x_m, b.x_m, tolerance);
  EXPECT_NEAR(a.y_m, b.y_m, tolerance);
  EXPECT_NEAR(wrap_angle(a.yaw_rad - b.yaw_rad), 0, tolerance);
}

TEST(Graph, TheAdjointCarriesASmallMotionAcross) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Pose2 X = pose(seed, 0);
    const Vector3 e = 1e-5 * Vector3(draw(seed, 50), draw(seed, 51), draw(seed, 52));
    const Pose2 carried = X * Pose2{e.x(), e.y(), e.z()} * X.inverse();
    const Vector3 expected = adjoint(X) * e;
    expect_same(carried, {expected.x(), expected.y(), expected.z()}, 1e-9);  // second order: 1e-10 times a few
  }
}

TEST(Graph, CompositionDoesNotDependOnTheBrackets) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Relative a{0, 1, pose(seed, 0), some_information(seed)}, b{1, 2, pose(seed, 1), some_information(seed + 100)},
        c{2, 3, pose(seed, 2), some_information(seed + 200)};
    const Relative left = compose(compose(a, b), c), right = compose(a, compose(b, c));
    expect_same(left.X_ij, right.X_ij, 1e-12);
    EXPECT_LT((left.information - right.information).norm(), 1e-9 * left.information.norm()) << "seed " << seed;
  }
}

TEST(Graph, CovarianceOfAStraightWayIsThatOfAPendulum) {
  // n steps of length d with white yaw noise s: the end lies across by d s sqrt(sum k^2), k = 0..n-1.
  const double d = 0.15, s = 1e-3, tiny = 1e-9;
  const Matrix3 information = Vector3(1 / (tiny * tiny), 1 / (tiny * tiny), 1 / (s * s)).asDiagonal();
  Relative total{0, 0, {d, 0, 0}, information};
  const int n = 200;
  for (int k = 1; k < n; ++k) total = compose(total, {0, 0, {d, 0, 0}, information});
  const Matrix3 covariance = total.information.inverse();
  const double sum = (n - 1.0) * n * (2 * n - 1) / 6;
  EXPECT_NEAR(std::sqrt(covariance(1, 1)), d * s * std::sqrt(sum), 1e-6);
  EXPECT_NEAR(std::sqrt(covariance(2, 2)), s * std::sqrt(n), 1e-9);
}

/// A ring of n nodes with exact measurements and one chord, from a bent start.
PoseGraph ring(int n, std::uint64_t seed, double noise) {
  PoseGraph graph;
  std::vector<Pose2> X_true{{}};
  for (int k = 1; k < n; ++k)
    X_true.push_back(X_true.back() * Pose2{1, 0.02 * draw(seed, k), 2 * std::numbers::pi / n});
  for (int k = 0; k < n; ++k) {
    const int j = (k + 1) % n;
    const Pose2 e{noise * draw(seed, 1000 + k), noise * draw(seed, 2000 + k), noise * draw(seed, 3000 + k)};
    graph.edge.push_back({k, j, X_true[k].inverse() * X_true[j] * e, some_information(seed + k)});
  }
  graph.node = X_true;
  return graph;
}

TEST(Graph, ConsistentMeasurementsAreReachedFromABentStart) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    PoseGraph graph = ring(60, seed, 0);
    const std::vector<Pose2> X_true = graph.node;
    for (size_t k = 1; k < graph.node.size(); ++k)
      graph.node[k] = graph.node[k] * Pose2{0.3 * draw(seed, k), 0.3 * draw(seed, 70 + k), 0.2 * draw(seed, 140 + k)};
    const GraphSolution solution = solve(graph);
    EXPECT_TRUE(solution.converged) << "seed " << seed;
    EXPECT_LT(solution.chi2, 1e-12);
    for (size_t k = 0; k < X_true.size(); ++k) expect_same(solution.node[k], X_true[k], 1e-8);
  }
}

TEST(Graph, TheSolutionIsAMinimum) {
  const PoseGraph graph = ring(30, 7, 0.02);
  const GraphSolution solution = solve(graph);
  ASSERT_TRUE(solution.converged);
  GraphSettings nothing;
  nothing.max_iterations = 0;
  for (int trial = 0; trial < 100; ++trial) {
    PoseGraph moved = graph;
    moved.node = solution.node;
    const int k = 1 + trial % 29;
    moved.node[k] = moved.node[k] * Pose2{1e-4 * draw(trial, 1), 1e-4 * draw(trial, 2), 1e-4 * draw(trial, 3)};
    EXPECT_GT(solve(moved, nothing).chi2, solution.chi2) << "trial " << trial;
  }
}

TEST(Graph, AForwardAndABackwardEdgeAreTheSameMeasurement) {
  PoseGraph graph = ring(20, 3, 0.05), turned = graph;
  for (Relative& edge : turned.edge) {
    // e' of the inverse measurement is -Ad(X_ij) e: the information is carried over.
    const Matrix3 A = adjoint(edge.X_ij.inverse());
    edge = {edge.j, edge.i, edge.X_ij.inverse(), A.transpose() * edge.information * A};
  }
  const GraphSolution a = solve(graph), b = solve(turned);
  // Equal to first order in the residuals (0.05): the second order is some 1e-3 of the corrections.
  for (size_t k = 0; k < a.node.size(); ++k) expect_same(a.node[k], b.node[k], 2e-2);
}

TEST(Graph, AWrongEdgeUnderACauchyKernelLosesItsSay) {
  PoseGraph graph = ring(60, 5, 0.001);
  const std::vector<Pose2> X_true = graph.node;
  graph.edge.push_back({5, 40, {0, 0, 0}, 100 * Matrix3::Identity()});  // "the same place", across the ring
  graph.kernel.assign(graph.edge.size(), 0);
  graph.kernel.back() = 2;
  const GraphSolution robust = solve(graph);
  graph.kernel.clear();
  const GraphSolution quadratic = solve(graph);
  EXPECT_TRUE(robust.converged);
  EXPECT_LT(robust.edge_weight.back(), 0.01);
  EXPECT_LT(ate_m(X_true, robust.node), 0.1 * ate_m(X_true, quadratic.node));
}

TEST(Graph, CovariancesAgreeWithTheDenseInverseOnAChain) {
  PoseGraph graph = ring(12, 9, 0);
  graph.edge.pop_back();  // an open chain: covariances compose
  Relative total = graph.edge[2];
  for (int k = 3; k < 8; ++k) total = compose(total, graph.edge[k]);
  const std::vector<std::pair<int, int>> pairs{{2, 8}, {0, 2}};
  const std::vector<Matrix3> covariance = relative_covariances(graph, pairs);
  const Matrix3 expected = total.information.inverse();
  EXPECT_LT((covariance[0] - expected).norm(), 1e-9 * expected.norm());
  const Matrix3 first = compose(graph.edge[0], graph.edge[1]).information.inverse();
  EXPECT_LT((covariance[1] - first).norm(), 1e-9 * first.norm());
}

TEST(Graph, ALoopMakesTheFarSideMoreCertain) {
  PoseGraph graph = ring(40, 11, 0);
  const std::vector<std::pair<int, int>> pairs{{0, 20}};
  const Matrix3 closed = relative_covariances(graph, pairs)[0];
  graph.edge.pop_back();
  const Matrix3 open = relative_covariances(graph, pairs)[0];
  EXPECT_LT(closed(0, 0) + closed(1, 1), open(0, 0) + open(1, 1));
}

TEST(Graph, AnEdgeToNowhereAndALooseNodeAreErrors) {
  PoseGraph graph = ring(5, 1, 0);
  graph.edge[0].j = 17;
  EXPECT_THROW(solve(graph), Error);
  PoseGraph loose = ring(5, 1, 0);
  loose.node.push_back({});
  EXPECT_THROW(solve(loose), Error);
}

}  // namespace
}  // namespace adit
