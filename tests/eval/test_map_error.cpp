// SPDX-License-Identifier: BSD-3-Clause
#include "eval/map_error.h"
#include "tests/eval/exact_case.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;

// Points of the map moved along the true normals by `out_m`, + into the rock.
ExactCase swollen(const ExactCase& exact, double out_m) {
  ExactCase c = exact;
  const TrueScans scans(c.truth, c.world.mesh);
  const Pose X_MW = c.truth.drive.path.X_WB.front().inverse();
  size_t point = 0;
  for (size_t l = 0; l < scans.lasers(); ++l)
    for (size_t i = 0; i < scans.scans(l); ++i)
      for (const TrueBeam& b : scans.fan(l, i, 1))
        c.estimate.points.p[point++] += X_MW.linear() * (out_m * c.world.mesh.normal(static_cast<size_t>(b.face)));
  return c;
}

TEST(MapError, PointsOnTheTrueSurfaceScoreNothingButRight) {
  const Score score = score_of(ring_case());
  for (const std::string at : {"se3", "first_pose", "local_5m"}) {
    EXPECT_LT(value(score, "map." + at + ".mae_m"), 1e-9) << at;
    EXPECT_LT(value(score, "map." + at + ".p99_m"), 1e-9) << at;
    EXPECT_EQ(value(score, "map." + at + ".within_2cm"), 1) << at;
    EXPECT_EQ(value(score, "map." + at + ".phantom_share"), 0) << at;
    for (const std::string tau : {"5cm", "10cm", "20cm"}) {
      EXPECT_EQ(value(score, "map." + at + ".precision_" + tau), 1) << at;
      EXPECT_EQ(value(score, "map." + at + ".recall_" + tau), 1)
          << at;  // the same beams made map and observable surface
      EXPECT_EQ(value(score, "map." + at + ".recall3_" + tau), 1) << at;
      EXPECT_EQ(value(score, "map." + at + ".f_" + tau), 1) << at;
    }
  }
  EXPECT_EQ(score.point_error_m.size(), ring_case().estimate.points.size());
}

TEST(MapError, AMapSevenCentimetresTooWideIsOffBySeven) {
  const Score score = score_of(swollen(tunnel_case(), 0.07));
  // Points pushed out beyond an edge of the tunnel are nearest to the edge or to the other wall, never farther than 7
  // cm.
  EXPECT_NEAR(value(score, "map.se3.bias_m"), -0.07, 0.002);
  EXPECT_NEAR(value(score, "map.se3.p50_m"), 0.07, 1e-6);
  EXPECT_NEAR(value(score, "map.se3.by_label.floor.p50_m"), 0.07, 1e-6);
  EXPECT_LE(value(score, "map.se3.p99_m"), 0.07 + 1e-6);
  EXPECT_LT(value(score, "map.se3.precision_5cm"), 0.02);
  EXPECT_EQ(value(score, "map.se3.precision_10cm"), 1);
  EXPECT_LT(value(score, "map.se3.within_5cm"), 0.02);
}

TEST(MapError, TheSignIsPlusIntoTheVoid) {
  EXPECT_NEAR(value(score_of(swollen(tunnel_case(), -0.03)), "map.se3.bias_m"), 0.03, 1e-3);
}

TEST(MapError, AThinWallDoesNotLendItsFarFace) {
  // Two rooms with 0.1 m of rock between them; a point seen from the left, 0.08 m too far, is nearer to the right
  // room's face.
  Mesh mesh = box_mesh({0, 0, 0}, {4, 4, 2});
  const Mesh right = box_mesh({4.1, 0, 0}, {8, 4, 2});
  for (std::array<std::uint32_t, 3> f : right.face) {
    for (std::uint32_t& v : f) v += static_cast<std::uint32_t>(mesh.vertex.size());
    mesh.face.push_back(f);
  }
  mesh.vertex.insert(mesh.vertex.end(), right.vertex.begin(), right.vertex.end());
  mesh.label.insert(mesh.label.end(), right.label.begin(), right.label.end());
  const Surface surface(mesh);
  const Patches patches(mesh, 0.2, Pose::Identity());
  MapPoints points;
  points.p_M = {{4.08, 2, 1}, {4.08, 2, 1}};
  points.seen_M = {{1, 0, 0}, {-1, 0, 0}};
  const LaidPoints laid = lay(
      points,
      [](size_t) -> const Pose& {
        static const Pose I = Pose::Identity();
        return I;
      },
      surface, patches, nullptr);
  EXPECT_NEAR(laid.error_m[0], -0.08, 1e-6);  // beyond the left room's wall
  EXPECT_NEAR(laid.error_m[1], -0.02, 1e-6);  // before the right room's wall, in the rock
}

TEST(MapError, DensityOfPointsDoesNotWeigh) {
  // Half of the map is 7 cm off; its points are there four times.
  ExactCase c = tunnel_case();
  const ExactCase off = swollen(tunnel_case(), 0.07);
  const size_t n = c.estimate.points.size();
  for (size_t i = 0; i < n; ++i)
    if (c.estimate.points.p[i].x() > 6) c.estimate.points.p[i] = off.estimate.points.p[i];
  const double once = value(score_of(c), "map.se3.precision_5cm");
  PointCloud& points = c.estimate.points;
  for (int copy = 0; copy < 3; ++copy)
    for (size_t i = 0; i < n; ++i)
      if (points.p[i].x() > 6) {
        points.p.push_back(points.p[i]);
        points.stamp_s.push_back(points.stamp_s[i]);
        points.laser.push_back(points.laser[i]);
      }
  EXPECT_GT(once, 0.2);
  EXPECT_LT(once, 0.8);
  // Unweighted it would be 1 : 4. Cubes on the border hold both kinds: a handful of some thousand.
  EXPECT_NEAR(value(score_of(c), "map.se3.precision_5cm"), once, 1e-3);
}

TEST(MapError, AMissingRoofCostsItsAreaOfRecallAndNoPrecision) {
  ExactCase c = tunnel_case();
  const Score whole = score_of(c);
  PointCloud& points = c.estimate.points;
  size_t kept = 0;
  for (size_t i = 0; i < points.size(); ++i)
    if (whole.point_label[i] != static_cast<std::uint8_t>(Label::roof)) {
      points.p[kept] = points.p[i];
      points.stamp_s[kept] = points.stamp_s[i];
      points.laser[kept] = points.laser[i];
      ++kept;
    }
  points.p.resize(kept), points.stamp_s.resize(kept), points.laser.resize(kept);
  const Score score = score_of(c);
  EXPECT_EQ(value(score, "map.se3.precision_5cm"), 1);
  EXPECT_EQ(value(score, "map.se3.by_label.roof.recall_5cm"), 0);
  EXPECT_EQ(value(score, "map.se3.by_label.floor.recall_5cm"), 1);
  // Along the 12 m that were driven the roof is a third of the perimeter, 4 of 12 m.
  EXPECT_NEAR(value(score, "map.se3.recall_5cm"), 2.0 / 3, 0.08);
}

TEST(MapError, AWallInTheMiddleOfTheWayIsPhantomAndNeverHelps) {
  ExactCase c = tunnel_case();
  const Score before = score_of(c);
  const size_t n = c.estimate.points.size();
  for (int i = 0; i < 200; ++i) {
    // Across the tunnel at x = 10 in W, 6 in M, between floor and roof but away from both.
    c.estimate.points.p.push_back({6, -1.4 + 0.014 * i, 1.0});
    c.estimate.points.stamp_s.push_back(1);
    c.estimate.points.laser.push_back(0);
  }
  const Score after = score_of(c);
  EXPECT_GT(value(after, "map.se3.phantom_share"), 0);
  for (const std::string tau : {"5cm", "10cm", "20cm"}) {
    EXPECT_LT(value(after, "map.se3.precision_" + tau), value(before, "map.se3.precision_" + tau));
    EXPECT_LE(value(after, "map.se3.recall_" + tau), value(before, "map.se3.recall_" + tau));
    EXPECT_LT(value(after, "map.se3.f_" + tau), value(before, "map.se3.f_" + tau));
  }
  EXPECT_GT(value(after, "map.se3.mae_m"), value(before, "map.se3.mae_m"));
  EXPECT_EQ(after.point_error_m.size(), n + 200);
}

TEST(MapError, WindowsTakeDriftOutAndTheFirstPoseLeavesItIn) {
  // The estimated path and its points turn by 0.05 deg per scan about the vertical through the start.
  ExactCase c = ring_case();
  const auto drift = [](double stamp_s) { return pose_of(Vec3::Zero(), 0.05 * deg * stamp_s / 0.2); };
  for (size_t i = 0; i < c.estimate.path.size(); ++i)
    c.estimate.path.X_WB[i] = drift(c.estimate.path.stamp_s[i]) * c.estimate.path.X_WB[i];
  for (size_t i = 0; i < c.estimate.points.size(); ++i)
    c.estimate.points.p[i] = drift(c.estimate.points.stamp_s[i]) * c.estimate.points.p[i];
  const Score score = score_of(c);
  const double local = value(score, "map.local_5m.mae_m"), fitted = value(score, "map.se3.mae_m"),
               first = value(score, "map.first_pose.mae_m");
  // Within 5 m (25 scans, standing turns have more) the turn about the start spans 1.3 deg, of it +-0.6 about its mean.
  EXPECT_LT(local, 0.05);
  EXPECT_GT(fitted, 2 * local);
  EXPECT_GT(first, fitted);
}

TEST(Patches, AreAsLargeAsTheSurfaceWhateverTheFaces) {
  for (const double edge_m : {0.1, 0.5, 1e9}) {
    const Mesh mesh = fine_box_mesh({0, 0, 0}, {4, 3, 2}, edge_m);
    const Patches patches(mesh, 0.2, pose_of({0.03, 0.04, 0.05}, 0));
    double area = 0;
    for (size_t p = 0; p < patches.size(); ++p) area += patches.area_m2(p);
    EXPECT_NEAR(area, 2 * (12 + 8 + 6), 1e-9);
    // 52 m2 in squares of 0.04 m2, cut at the walls' ends.
    EXPECT_NEAR(static_cast<double>(patches.size()), 1300, 250) << edge_m;
  }
}

TEST(Patches, APointOfAFaceFindsThePatchWhoseMiddleIsNear) {
  const Mesh mesh = box_mesh({0, 0, 0}, {4, 3, 2});
  const Patches patches(mesh, 0.2, Pose::Identity());
  for (int i = 0; i < 200; ++i) {
    const double u = std::fmod(0.7548776662 * i, 1.0), v = (1 - u) * std::fmod(0.5698402910 * i, 1.0);
    const std::int32_t f = i % static_cast<int>(mesh.face.size());
    const Vec3 a = mesh.corner(f, 0);
    const Vec3 p = a + u * (mesh.corner(f, 1) - a) + v * (mesh.corner(f, 2) - a);
    // In one cube of 0.2 m with its patch, but for the triangle's own size: both diagonals.
    EXPECT_LT((patches.centre(patches.at(f, p)) - p).norm(), 0.2 * std::sqrt(3.0) + 0.2 * 1.5);
  }
}

}  // namespace
}  // namespace adit
