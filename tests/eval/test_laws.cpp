// SPDX-License-Identifier: BSD-3-Clause
// What must hold of any score, whatever the map.
#include "base/rng.h"
#include "tests/eval/exact_case.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

constexpr std::uint64_t seeds = 3;

double u(std::uint64_t seed, std::uint64_t k) {
  return 2 * uniform(seed, Draw::test, 100, k) - 1;
}

// The exact map with noise along each point's own direction and a path that shakes.
ExactCase noisy(const ExactCase& exact, std::uint64_t seed, double sigma_m) {
  ExactCase c = exact;
  for (size_t i = 0; i < c.estimate.points.size(); ++i)
    for (int k = 0; k < 3; ++k)
      c.estimate.points.p[i][k] += sigma_m * normal(seed, Draw::test, i, static_cast<std::uint64_t>(k));
  for (size_t i = 0; i < c.estimate.path.size(); ++i)
    for (int k = 0; k < 2; ++k)
      c.estimate.path.X_WB[i].translation()[k] +=
          sigma_m * normal(seed, Draw::test, i, static_cast<std::uint64_t>(10 + k));
  return c;
}

TEST(Laws, MovingMapAndTruthTogetherChangesNeitherPathNorPoints) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const ExactCase c = noisy(tunnel_case(), seed, 0.03);
    const Score here = score_of(c);
    const Score there = score_of(moved(c, pose_of({50 * u(seed, 0), 50 * u(seed, 1), 5 * u(seed, 2)}, 3 * u(seed, 3))));
    for (size_t i = 0; i < here.metrics.size(); ++i) {
      const Metric &a = here.metrics[i], &b = there.metrics[i];
      const bool lattice = a.name.starts_with("volume.");  // columns lie along W's axes: their sampling turns
      if (!std::isfinite(a.value) || lattice) continue;
      EXPECT_NEAR(a.value, b.value, 1e-6 + 2e-3 * std::abs(a.value)) << "seed " << seed << " " << a.name;
    }
    EXPECT_NEAR(value(here, "volume.error_percent"), value(there, "volume.error_percent"), 0.5) << "seed " << seed;
  }
}

TEST(Laws, AWrongWallNeverImprovesAScore) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    ExactCase c = noisy(tunnel_case(), seed, 0.02);
    const Score before = score_of(c);
    // Across the tunnel somewhere between x = 2 and 10 in M, off all surfaces by 0.5 m; drawn into the grid too.
    const double x = 6 + 4 * u(seed, 0), height = 1 + 0.4 * u(seed, 1);
    for (int i = 0; i < 150; ++i) {
      c.estimate.points.p.push_back({x, -1.5 + 0.02 * i, height});
      c.estimate.points.stamp_s.push_back(1);
      c.estimate.points.laser.push_back(0);
    }
    Grid& g = c.estimate.grid;
    for (int j = 0; j < g.height; ++j)
      for (int i = 0; i < g.width; ++i)
        if (std::abs(g.centre(i, j).x() - x) < g.cell_m && std::abs(g.centre(i, j).y()) < 1.8)
          g.log_odds[g.index(i, j)] = 3;
    const Score after = score_of(c);
    for (const Metric& m : before.metrics) {
      if (!std::isfinite(m.value) || m.name.find("bias") != std::string::npos) continue;
      const bool judged = m.name.starts_with("map.se3.") || m.name.starts_with("grid.");
      const bool told_by_truth = m.name.ends_with("_true") || m.name.find("unobserved") != std::string::npos;
      const bool neutral =
          m.name.find("extraction") != std::string::npos || m.name.find("by_label") != std::string::npos;
      if (!judged || told_by_truth || neutral) continue;
      const double now = value(after, m.name);
      if (m.better == Better::higher) {
        EXPECT_LE(now, m.value + 1e-12) << "seed " << seed << " " << m.name;
      } else {
        EXPECT_GE(now, m.value - 1e-12) << "seed " << seed << " " << m.name;
      }
    }
    EXPECT_LT(value(after, "map.se3.f_5cm"), value(before, "map.se3.f_5cm"));
    EXPECT_LT(value(after, "grid.iou_free"), value(before, "grid.iou_free"));
  }
}

TEST(Laws, HalvingTheNoiseNeverWorsensAScore) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Score loud = score_of(noisy(tunnel_case(), seed, 0.06)), quiet = score_of(noisy(tunnel_case(), seed, 0.03));
    for (const char* name : {"trajectory.se3.ate_rmse_m", "trajectory.se3.ate_max_m", "trajectory.rpe_5m_m",
                             "map.se3.mae_m", "map.se3.rmse_m", "map.se3.p50_m", "map.se3.p95_m", "map.local_5m.mae_m"})
      EXPECT_LT(value(quiet, name), value(loud, name)) << "seed " << seed << " " << name;
    for (const char* name : {"map.se3.within_2cm", "map.se3.within_5cm", "map.se3.precision_5cm", "map.se3.f_5cm"})
      EXPECT_GT(value(quiet, name), value(loud, name)) << "seed " << seed << " " << name;
  }
}

TEST(Laws, ASecondObservationOfTheSamePlaceChangesNeitherRecallNorPrecision) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    ExactCase c = noisy(tunnel_case(), seed, 0.03);
    const Score once = score_of(c);
    PointCloud& p = c.estimate.points;
    const size_t n = p.size(), from = static_cast<size_t>((u(seed, 0) + 1) / 4 * static_cast<double>(n));
    // Whole cubes are doubled where a stretch is: a cube keeps its share only if all of its points come again.
    for (size_t i = from; i < n; ++i) {
      p.p.push_back(p.p[i]);
      p.stamp_s.push_back(p.stamp_s[i]);
      p.laser.push_back(p.laser[i]);
    }
    const Score twice = score_of(c);
    for (const char* tau : {"5cm", "10cm", "20cm"}) {
      EXPECT_EQ(value(twice, std::string("map.se3.recall_") + tau), value(once, std::string("map.se3.recall_") + tau))
          << seed;
      EXPECT_NEAR(value(twice, std::string("map.se3.precision_") + tau),
                  value(once, std::string("map.se3.precision_") + tau), 0.02)
          << "seed " << seed;
    }
  }
}

TEST(Laws, ARigidTurnOfTheMapsFrameChangesNothing) {
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    ExactCase c = noisy(ring_case(), seed, 0.02);
    c.estimate.grid = {};  // a grid lies in its own plane
    const Score before = score_of(c);
    const Pose X =
        pose_of({30 * u(seed, 0), 30 * u(seed, 1), 3 * u(seed, 2)}, 3 * u(seed, 3), 0.3 * u(seed, 4), 0.3 * u(seed, 5));
    for (Pose& X_MB : c.estimate.path.X_WB) X_MB = X * X_MB;
    for (Vec3& p : c.estimate.points.p) p = X * p;
    for (Vec3& p : c.estimate.surface.vertex) p = X * p;
    const Score after = score_of(c);
    for (const Metric& m : before.metrics) {
      bool lattice = false;  // cubes that weigh the points lie along M's axes; open loop and its bound are in M's plane
      for (const char* part : {"bound.", "open_loop", "precision", "f_", "share"})
        lattice = lattice || m.name.find(part) != std::string::npos;
      if (!std::isfinite(m.value) || lattice) continue;
      EXPECT_NEAR(value(after, m.name), m.value, 1e-6 + 1e-3 * std::abs(m.value)) << "seed " << seed << " " << m.name;
    }
  }
}

}  // namespace
}  // namespace adit
