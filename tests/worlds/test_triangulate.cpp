// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "worlds/triangulate.h"

#include <gtest/gtest.h>

namespace adit {
namespace {

Loop square(double low, double high, bool counter_clockwise) {
  Loop loop{{low, low}, {high, low}, {high, high}, {low, high}};
  if (!counter_clockwise) std::swap(loop[1], loop[3]);
  return loop;
}

double area_of(const PlanMesh& mesh) {
  double area = 0;
  for (const auto& f : mesh.face) {
    const double a = enclosed_area({mesh.vertex[f[0]], mesh.vertex[f[1]], mesh.vertex[f[2]]});
    EXPECT_GT(a, 0);  // counter-clockwise, every one
    area += a;
  }
  return area;
}

TEST(Triangulate, ASquareWithAHoleHasItsAreaAndItsLoopsFirst) {
  const PlanMesh mesh = triangulate({square(0, 10, true), square(4, 6, false)}, {{1, 1}, {9, 5}, {5, 5}, {20, 20}});
  EXPECT_NEAR(area_of(mesh), 96, 1e-12);
  ASSERT_EQ(mesh.vertex.size(), 10u);  // of the four more points one lies in the hole and one outside
  EXPECT_EQ(mesh.vertex[4], Vec2(4, 4));
}

TEST(Triangulate, APlaneRegionHasAsManyTrianglesAsEulerSays) {
  std::vector<Vec2> inner;
  for (int i = 1; i < 10; ++i)
    for (int j = 1; j < 10; ++j) inner.emplace_back(i + 0.01 * j, j - 0.013 * i);
  const PlanMesh mesh = triangulate({square(0, 10, true)}, inner);
  EXPECT_EQ(mesh.face.size(), 2 * 81u + 4 - 2);  // 2 inner + boundary - 2
}

TEST(Triangulate, LoopsThatCrossAreRefused) {
  EXPECT_THROW(triangulate({square(0, 10, true), square(8, 12, false)}, {}), Error);
}

}  // namespace
}  // namespace adit
