// SPDX-License-Identifier: BSD-3-Clause
#include "base/dexels.h"
#include "base/error.h"
#include "base/rng.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

/// The box [low, high] as six tetrahedra around one diagonal.
std::vector<Tetrahedron> box_tetrahedra(const Vec3& low, const Vec3& high) {
  std::vector<Tetrahedron> all;
  std::array<int, 3> order = {0, 1, 2};
  do {
    Tetrahedron t;
    t[0] = low;
    for (int k = 0; k < 3; ++k) {
      t[k + 1] = t[k];
      t[k + 1][order[k]] = high[order[k]];
    }
    all.push_back(t);
  } while (std::next_permutation(order.begin(), order.end()));
  return all;
}

Mesh mesh_of(const std::vector<Tetrahedron>& tetrahedra) {
  Mesh mesh;
  for (const Tetrahedron& t : tetrahedra) {
    const bool right = (t[1] - t[0]).cross(t[2] - t[0]).dot(t[3] - t[0]) > 0;
    const auto n = static_cast<std::uint32_t>(mesh.vertex.size());
    mesh.vertex.insert(mesh.vertex.end(), {t[0], right ? t[1] : t[2], right ? t[2] : t[1], t[3]});
    for (const auto& f : {std::array<std::uint32_t, 3>{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}})
      mesh.face.push_back({n + f[0], n + f[1], n + f[2]});
  }
  return mesh;
}

/// A ball as tetrahedra from its centre to an octahedron's faces, split `splits` times and pushed onto the sphere.
std::vector<Tetrahedron> ball(double radius, int splits) {
  std::vector<std::array<Vec3, 3>> faces;
  for (const int x : {-1, 1})
    for (const int y : {-1, 1})
      for (const int z : {-1, 1}) faces.push_back({Vec3(x, 0, 0), Vec3(0, y, 0), Vec3(0, 0, z)});
  for (int s = 0; s < splits; ++s) {
    std::vector<std::array<Vec3, 3>> finer;
    for (const auto& [a, b, c] : faces) {
      const Vec3 ab = (a + b).normalized(), bc = (b + c).normalized(), ca = (c + a).normalized();
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    faces = finer;
  }
  std::vector<Tetrahedron> all;
  for (const auto& [a, b, c] : faces) all.push_back({Vec3::Zero(), radius * a, radius * b, radius * c});
  return all;
}

Vec3 random_point(std::uint64_t seed, std::uint64_t i, const Vec3& size) {
  return {size.x() * uniform(seed, Draw::test, i, 0), size.y() * uniform(seed, Draw::test, i, 1),
          size.z() * uniform(seed, Draw::test, i, 2)};
}

std::vector<Tetrahedron> random_tetrahedra(std::uint64_t seed, int n, const Vec3& size) {
  std::vector<Tetrahedron> all(n);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) all[i][k] = random_point(seed, 4 * i + k, size);
  return all;
}

bool inside(const Tetrahedron& t, const Vec3& p) {
  const double whole = (t[1] - t[0]).cross(t[2] - t[0]).dot(t[3] - t[0]);
  for (int k = 0; k < 4; ++k) {
    Tetrahedron part = t;
    part[k] = p;
    if ((part[1] - part[0]).cross(part[2] - part[0]).dot(part[3] - part[0]) / whole < 0) return false;
  }
  return true;
}

bool inside(const Dexels& solid, int i, int j, double z) {
  for (const Interval& s : solid.column(i, j))
    if (s.low_m <= z && z <= s.high_m) return true;
  return false;
}

bool same(const Dexels& a, const Dexels& b) {
  return a.offset == b.offset &&
         std::equal(a.interval.begin(), a.interval.end(), b.interval.begin(), b.interval.end(),
                    [](const Interval& s, const Interval& t) { return s.low_m == t.low_m && s.high_m == t.high_m; });
}

TEST(Dexels, GridCoversItsBoxAndStartsAtAMultipleOfTheCell) {
  const Dexels grid = empty_dexels({-1.23, 0.41}, {2.0, 3.33}, 0.1);
  EXPECT_NEAR(grid.origin.x(), -1.3, 1e-12);
  EXPECT_NEAR(grid.origin.y(), 0.4, 1e-12);
  EXPECT_GE(grid.origin.x() + grid.width * 0.1, 2.0 - 1e-9);
  EXPECT_GE(grid.origin.y() + grid.height * 0.1, 3.33 - 1e-9);
  EXPECT_EQ(grid.volume_m3(), 0);
  EXPECT_THROW(empty_dexels({0, 0}, {1, 1}, 0), Error);
}

TEST(Dexels, ABoxWhoseSidesLieBetweenAxesHasItsExactVolumeAsMeshAndAsTetrahedra) {
  const Dexels grid = empty_dexels({-1, -1}, {5, 5}, 0.1);
  const auto parts = box_tetrahedra({0.4, 0.7, -0.25}, {3.1, 2.2, 1.5});
  const double volume = 2.7 * 1.5 * 1.75;
  EXPECT_NEAR(dexels_of(parts, grid).volume_m3(), volume, 1e-9);
  EXPECT_NEAR(dexels_of(mesh_of(parts), grid).volume_m3(), volume, 1e-9);
}

TEST(Dexels, ABoxWhoseSidesPassThroughAxesNeitherLosesNorDoublesThem) {
  // Two boxes that share a side right on the axes: by the tie rule each axis belongs to one of them.
  const Dexels grid = empty_dexels({0, 0}, {4, 4}, 0.1);
  const Dexels left = dexels_of(box_tetrahedra({0.55, 0.55, 0}, {1.55, 2.05, 1}), grid);
  const Dexels right = dexels_of(box_tetrahedra({1.55, 0.55, 0}, {2.55, 2.05, 1}), grid);
  EXPECT_NEAR(left.volume_m3(), 1.5, 1e-9);
  EXPECT_NEAR(right.volume_m3(), 1.5, 1e-9);
  EXPECT_NEAR(intersect(left, right).volume_m3(), 0, 1e-9);
  for (const Dexels& s : {left, right, unite(left, right)})
    for (size_t c = 0; c < s.columns(); ++c) EXPECT_LE(s.column(c).size(), 1u);  // no slits between the tetrahedra
}

TEST(Dexels, ABallConvergesToItsVolumeAsTheCellShrinks) {
  const auto parts = ball(1.3, 4);
  double exact = 0;
  for (const Tetrahedron& t : parts) exact += enclosed_volume(t);
  EXPECT_NEAR(exact, 4.0 / 3.0 * std::numbers::pi * 1.3 * 1.3 * 1.3, 0.06);  // chords of 6 deg
  const Mesh mesh = mesh_of(parts);
  for (const double cell : {0.2, 0.1, 0.05}) {
    const Dexels grid = empty_dexels({-1.5, -1.5}, {1.5, 1.5}, cell);
    // Errors at the rim: column heights sqrt(2 R cell) within one cell of it, of either sign.
    const double rim = 2 * std::numbers::pi * 1.3 * cell * std::sqrt(2 * 1.3 * cell);
    EXPECT_NEAR(dexels_of(parts, grid).volume_m3(), exact, 0.2 * rim) << cell;
    EXPECT_NEAR(dexels_of(mesh, grid).volume_m3(), dexels_of(parts, grid).volume_m3(), 1e-4) << cell;  // snapping, 8 um
  }
}

TEST(Dexels, UnionOfRandomTetrahedraHoldsExactlyThePointsInsideOne) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const auto parts = random_tetrahedra(seed, 25, {6, 5, 3});
    const Dexels grid = empty_dexels({0, 0}, {6, 5}, 0.1), solid = dexels_of(parts, grid);
    int wrong = 0;
    for (int n = 0; n < 1000; ++n) {
      const int i = static_cast<int>(uniform(seed, Draw::test, 1000 + n, 0) * grid.width);
      const int j = static_cast<int>(uniform(seed, Draw::test, 1000 + n, 1) * grid.height);
      const double z = 3 * uniform(seed, Draw::test, 1000 + n, 2);
      const Vec2 axis = grid.axis(i, j);
      bool expected = false;
      for (const Tetrahedron& t : parts) expected |= inside(t, {axis.x(), axis.y(), z});
      wrong += expected != inside(solid, i, j, z);
    }
    EXPECT_LE(wrong, 1) << "seed " << seed;  // corners move by up to 8 um: 1000 points within 1e-4 m of a face are rare
    for (size_t c = 0; c < solid.columns(); ++c)
      for (size_t k = 0; k < solid.column(c).size(); ++k) {
        EXPECT_LT(solid.column(c)[k].low_m, solid.column(c)[k].high_m);
        if (k > 0) {
          EXPECT_GT(solid.column(c)[k].low_m, solid.column(c)[k - 1].high_m);
        }
      }
  }
}

TEST(Dexels, TheOrderOfTetrahedraDoesNotMatter) {
  auto parts = random_tetrahedra(7, 60, {9, 9, 2});
  const Dexels grid = empty_dexels({0, 0}, {9, 9}, 0.1), solid = dexels_of(parts, grid);
  std::reverse(parts.begin(), parts.end());
  for (Tetrahedron& t : parts) std::rotate(t.begin(), t.begin() + 1, t.end());
  DexelUnion one_by_one(grid);
  for (const Tetrahedron& t : parts) one_by_one.add({&t, 1});
  const Dexels other = one_by_one.solid();
  EXPECT_EQ(other.offset, solid.offset);
  EXPECT_NEAR(other.volume_m3(), solid.volume_m3(), 1e-9);
}

TEST(Dexels, AMeshWithOverlappingSolidsIsTheirUnion) {
  const auto parts = random_tetrahedra(11, 60, {6, 5, 3});
  const Dexels grid = empty_dexels({0, 0}, {6, 5}, 0.1);
  EXPECT_NEAR(dexels_of(mesh_of(parts), grid).volume_m3(), dexels_of(parts, grid).volume_m3(), 1e-6);
}

TEST(Dexels, WhatLiesOutsideOfTheGridIsCutOff) {
  const Dexels grid = empty_dexels({0, 0}, {1, 1}, 0.1);
  EXPECT_NEAR(dexels_of(box_tetrahedra({-5.03, -5.03, 0}, {0.5, 7.03, 2}), grid).volume_m3(), 1.0, 1e-9);
  EXPECT_NEAR(dexels_of(mesh_of(box_tetrahedra({-5.03, -5.03, 0}, {0.5, 7.03, 2})), grid).volume_m3(), 1.0, 1e-9);
  EXPECT_EQ(dexels_of(box_tetrahedra({3, 3, 0}, {4, 4, 2}), grid).volume_m3(), 0);
  EXPECT_THROW(dexels_of(box_tetrahedra({0, 0, 0}, {9e3, 1, 1}), grid), Error);
  EXPECT_THROW(dexels_of(box_tetrahedra({0, 0, 0}, {std::nan(""), 1, 1}), grid), Error);
}

TEST(Dexels, BooleanOperationsKeepTheLawsOfSets) {
  const Dexels grid = empty_dexels({0, 0}, {6, 5}, 0.1);
  const Dexels a = dexels_of(random_tetrahedra(21, 30, {6, 5, 3}), grid),
               b = dexels_of(random_tetrahedra(22, 30, {6, 5, 3}), grid);
  const double both = intersect(a, b).volume_m3();
  EXPECT_GT(both, 0.1);
  EXPECT_NEAR(unite(a, b).volume_m3() + both, a.volume_m3() + b.volume_m3(), 1e-9);
  EXPECT_NEAR(subtract(a, b).volume_m3() + both, a.volume_m3(), 1e-9);
  EXPECT_TRUE(same(unite(a, b), unite(b, a)));
  EXPECT_TRUE(same(intersect(a, a), a));
  EXPECT_TRUE(same(unite(a, grid), a));
  EXPECT_TRUE(same(subtract(a, a), grid));
  EXPECT_NEAR(unite(subtract(a, b), unite(subtract(b, a), intersect(a, b))).volume_m3(), unite(a, b).volume_m3(), 1e-9);
}

}  // namespace
}  // namespace adit
