// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "rays/caster.h"
#include "rays/face_grid.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace adit {
namespace {

Vec3 any_direction(int i) {
  return Vec3(normal(5, Draw::test, i, 0), normal(5, Draw::test, i, 1), normal(5, Draw::test, i, 2)).normalized();
}

TEST(Caster, RangesInABoxAreThoseOfArithmetic) {
  const Mesh box = box_mesh({-2, -3, 0}, {4, 5, 2});
  const Caster caster(box);
  const Vec3 o(1, 1, 1), half(3, 4, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 d = any_direction(i);
    const double expected = (half.array() / d.array().abs()).minCoeff();
    EXPECT_NEAR(caster.nearest({o, d}).range_m, expected, 1e-12 * (1 + expected)) << "i = " << i;  // planes in doubles
  }
}

TEST(Caster, PacketsAnswerAsSingleRays) {
  const Mesh mesh = fine_box_mesh({0, 0, 0}, {30, 5, 2}, 0.3);
  const Caster caster(mesh);
  std::vector<Ray> rays;
  for (int i = 0; i < 1003; ++i) rays.push_back({Vec3(10, 2, 1), any_direction(i)});
  std::vector<Hit> hits(rays.size());
  caster.nearest(rays, hits);
  for (size_t i = 0; i < rays.size(); ++i) {
    const Hit one = caster.nearest(rays[i]);
    EXPECT_EQ(hits[i].range_m, one.range_m);
    EXPECT_EQ(hits[i].face, one.face);
  }
}

// A fan that walks down a box: beam by beam of scans that stand abreast.
std::vector<Ray> walking_fan(int scans, int beams) {
  std::vector<Ray> rays;
  for (int c = 0; c < beams; ++c)
    for (int r = 0; r < scans; ++r) {
      const double a = -1.5 + 3.0 * c / (beams - 1);
      rays.push_back({Vec3(5 + 0.1 * r, 2 + 0.01 * r, 1), Vec3(std::cos(a), std::sin(a), 0.02).normalized()});
    }
  return rays;
}

template <class T>
RayColumns<T> columns_of(const std::vector<Ray>& rays, const Vec3& about) {
  RayColumns<T> c;
  for (const Ray& ray : rays) {
    const Vec3 o = ray.origin - about;
    c.x.push_back(static_cast<T>(o.x())), c.y.push_back(static_cast<T>(o.y())), c.z.push_back(static_cast<T>(o.z()));
    c.dx.push_back(static_cast<T>(ray.direction.x())), c.dy.push_back(static_cast<T>(ray.direction.y()));
    c.dz.push_back(static_cast<T>(ray.direction.z()));
  }
  return c;
}

TEST(Caster, ColumnsOfRaysAreAnsweredAsSingleRaysHoweverTheyFillPackets) {
  const Mesh mesh = fine_box_mesh({0, 0, 0}, {30, 5, 2}, 0.3);
  const Caster caster(mesh);
  for (const int scans : {1, 2, 4, 8, 11, 16}) {
    std::vector<Ray> rays = walking_fan(scans, 37);     // fills no whole number of packets
    rays.push_back({Vec3(10, 2, -5), -Vec3::UnitZ()});  // from below, away: nothing
    HitColumns<double> hits;
    hits.resize(rays.size());
    const RayColumns<double> columns = columns_of<double>(rays, Vec3::Zero());
    caster.nearest(columns, 0, rays.size() / 2, 16, hits);
    caster.nearest(columns, rays.size() / 2, rays.size(), 6, hits);
    for (size_t i = 0; i + 1 < rays.size(); ++i) {
      const Hit one = caster.nearest(rays[i]);
      EXPECT_EQ(hits.face[i], one.face) << scans << " " << i;
      EXPECT_NEAR(hits.range_m[i], one.range_m, 1e-13 * (1 + one.range_m)) << scans << " " << i;
      EXPECT_NEAR(hits.cosine[i], one.cosine, 1e-13) << scans << " " << i;
    }
    EXPECT_EQ(hits.face.back(), -1);
    EXPECT_EQ(hits.range_m.back(), INFINITY);
  }
}

TEST(Caster, AGlanceIsTheHitToFloats) {
  const Mesh mesh = fine_box_mesh({0, 0, 0}, {30, 5, 2}, 0.3);
  const Caster caster(mesh);
  std::vector<Ray> rays;
  for (int i = 0; i < 1003; ++i) rays.push_back({Vec3(10, 2, 1), any_direction(i)});
  rays.push_back({Vec3(10, 2, -5), -Vec3::UnitZ()});  // from below, away: nothing
  HitColumns<float> glances;
  caster.glance(columns_of<float>(rays, caster.middle()), glances);
  for (size_t i = 0; i + 1 < rays.size(); ++i) {
    const Hit hit = caster.nearest(rays[i]);
    EXPECT_EQ(glances.face[i], hit.face);
    EXPECT_NEAR(glances.range_m[i], hit.range_m, 5e-5);
    EXPECT_NEAR(glances.cosine[i], hit.cosine, 1e-5);
    EXPECT_NEAR(hit.cosine, mesh.normal(static_cast<size_t>(hit.face)).dot(rays[i].direction), 1e-12);
    EXPECT_GT(hit.cosine, 0);  // met from within
  }
  EXPECT_EQ(glances.face.back(), -1);
  EXPECT_EQ(glances.range_m.back(), INFINITY);
}

TEST(Caster, NothingWithinReachIsInfinity) {
  const Mesh box = box_mesh({0, 0, 0}, {10, 10, 10});
  const Caster caster(box);
  EXPECT_TRUE(std::isinf(caster.nearest({Vec3(5, 5, 5), Vec3::UnitX(), 4.9}).range_m));
  EXPECT_FALSE(caster.closest(Vec3(5, 5, 5), 4.9).has_value());
}

TEST(Caster, TheClosestPointOfASphereLiesOnTheRadius) {
  const Mesh sphere = sphere_mesh({100, 50, 2}, 2, 5);
  const Caster caster(sphere);
  for (int i = 0; i < 200; ++i) {
    const Vec3 d = any_direction(i);
    const auto c = caster.closest(Vec3(100, 50, 2) + 1.5 * d, 5);
    ASSERT_TRUE(c.has_value());
    // 20 * 4^5 faces with edges up to 0.082 m: their middles lie (0.082 / sqrt 3)^2 / (2 * 2) = 0.56 mm inside.
    EXPECT_NEAR(c->distance_m, 0.5, 5.7e-4);
  }
}

TEST(Caster, ClosestEqualsTheBestOfAllFaces) {
  const Mesh mesh = fine_box_mesh({0, 0, 0}, {6, 5, 2}, 0.5);
  const Caster caster(mesh);
  for (int i = 0; i < 300; ++i) {
    const Vec3 p(6 * uniform(6, Draw::test, i, 0), 5 * uniform(6, Draw::test, i, 1), 2 * uniform(6, Draw::test, i, 2));
    const double expected = std::min({p.x(), 6 - p.x(), p.y(), 5 - p.y(), p.z(), 2 - p.z()});
    EXPECT_NEAR(caster.closest(p, 10)->distance_m, expected, 1e-12);
  }
}

TEST(Caster, AThinWallDoesNotLendItsFarFace) {
  // Two rooms with 0.1 m of rock between; a point measured from the left room and 6 cm too far lies nearer to the right
  // one.
  Mesh mesh = box_mesh({0, 0, 0}, {5, 4, 2});
  const Mesh right = box_mesh({5.1, 0, 0}, {9, 4, 2});
  for (auto f : right.face) mesh.face.push_back({f[0] + 8, f[1] + 8, f[2] + 8});
  mesh.vertex.insert(mesh.vertex.end(), right.vertex.begin(), right.vertex.end());
  const Caster caster(mesh);
  const Vec3 p(5.06, 2, 1);
  EXPECT_NEAR(caster.closest(p, 1)->distance_m, 0.04, 1e-9);
  EXPECT_NEAR(caster.closest(p, 1, Vec3::UnitX())->distance_m, 0.06, 1e-9);
}

// Faces of all sizes, leaning every way, one of them without area.
Mesh lump() {
  Mesh mesh = sphere_mesh({40, -30, 5}, 2, 3);
  for (size_t i = 0; i < mesh.vertex.size(); ++i)
    for (int k = 0; k < 3; ++k) mesh.vertex[i][k] += 0.1 * normal(3, Draw::test, i, static_cast<std::uint64_t>(k));
  const Mesh room = box_mesh({36, -34, 1}, {44, -26, 9});
  const auto first = static_cast<std::uint32_t>(mesh.vertex.size());
  for (auto f : room.face) mesh.face.push_back({f[0] + first, f[1] + first, f[2] + first});
  mesh.vertex.insert(mesh.vertex.end(), room.vertex.begin(), room.vertex.end());
  mesh.face.push_back({0, 1, 1});
  return mesh;
}

TEST(FaceGrid, FindsCloseToTheSurfaceTheFaceThatTheTreeFinds) {
  const Mesh mesh = lump();
  const Caster caster(mesh);
  const FaceGrid grid(mesh);
  size_t close = 0;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) p[k] = 9 * uniform(4, Draw::test, i, static_cast<std::uint64_t>(k)) - 4.5;
    p += Vec3(40, -30, 5);
    std::optional<Vec3> seen_along;
    if (i % 2) seen_along = any_direction(static_cast<int>(i));
    const auto ours = grid.closest(p, seen_along), tree = caster.closest(p, grid.reach_m(), seen_along);
    ASSERT_EQ(ours.has_value(), tree.has_value()) << i;
    if (!ours) continue;
    ++close;
    EXPECT_EQ(ours->face, tree->face) << i;
    EXPECT_EQ(ours->distance_m, tree->distance_m) << i;
    EXPECT_EQ(ours->point, tree->point) << i;
  }
  EXPECT_GT(close, 1000u);
}

TEST(FaceGrid, HasNothingFarFromTheMeshNorWhereNoNumberIs) {
  const Mesh box = box_mesh({0, 0, 0}, {1, 1, 1});
  const FaceGrid grid(box);
  for (const double x : {-1e3, 1e3, 1e12, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(grid.closest({x, 0.5, 0.5})) << x;
  EXPECT_THROW(FaceGrid(Mesh{}), Error);
}

TEST(FaceGrid, ACornerASideAndTheInsideOfAFaceAreAsFarAsTheyAre) {
  const Mesh box = fine_box_mesh({0, 0, 0}, {6, 5, 2}, 0.5);
  const FaceGrid grid(box);
  EXPECT_NEAR(grid.closest({-0.1, -0.1, -0.1})->distance_m, std::sqrt(0.03), 1e-12);
  EXPECT_NEAR(grid.closest({3.01, -0.1, -0.2})->distance_m, std::sqrt(0.05), 1e-12);
  EXPECT_NEAR(grid.closest({3.01, 2.02, 1.75})->distance_m, 0.25, 1e-12);
}

}  // namespace
}  // namespace adit
