// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "eval/score.h"
#include "tests/eval/exact_case.h"
#include "tests/support/scratch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

namespace adit {
namespace {

std::string file_of(const std::string& name) {
  return scratch("score_") + name + ".json";
}

TEST(Score, EveryMetricHasAUnitAndOneNameAndAValueOrAReason) {
  ExactCase empty = tunnel_case();
  empty.estimate = {};
  for (const Score& score : {score_of(ring_case()), score_of(empty)}) {
    std::set<std::string> names;
    for (const Metric& m : score.metrics) {
      EXPECT_TRUE(names.insert(m.name).second) << m.name << " twice";
      EXPECT_FALSE(m.unit.empty()) << m.name;
      EXPECT_EQ(std::isfinite(m.value), m.why.empty()) << m.name;
    }
  }
}

TEST(Score, AnEmptyEstimateHasTheSameRowsAndSaysWhyTheyAreEmpty) {
  ExactCase empty = ring_case();
  empty.estimate = {};
  const Score score = score_of(empty), full = score_of(ring_case());
  ASSERT_EQ(score.metrics.size(), full.metrics.size());
  for (size_t i = 0; i < score.metrics.size(); ++i) EXPECT_EQ(score.metrics[i].name, full.metrics[i].name);
  EXPECT_EQ(score.find("trajectory.se3.ate_rmse_m")->why, "the estimate has no path");
  EXPECT_FALSE(score.notes.empty());
  // What the truth alone says is there.
  EXPECT_GT(value(score, "volume.observable_m3"), 0);
}

TEST(Score, MovingMapAndTruthTogetherChangesNothing) {
  const Score here = score_of(ring_case());
  // By whole columns of the domain; a turn by a quarter keeps the columns too.
  const Score there = score_of(moved(ring_case(), pose_of({30, -70, 5}, 3.14159265358979323846 / 2)));
  ASSERT_EQ(here.metrics.size(), there.metrics.size());
  for (size_t i = 0; i < here.metrics.size(); ++i) {
    const Metric &a = here.metrics[i], &b = there.metrics[i];
    // Rounding of coordinates may move a cell or a patch from one side of a border to the other.
    if (std::isfinite(a.value)) {
      EXPECT_NEAR(a.value, b.value, 1e-6 + 2e-3 * std::abs(a.value)) << a.name;
    }
  }
}

TEST(Score, TheSameBytesOnOneTwoAndSevenThreads) {
  ExactCase c = ring_case();
  for (size_t i = 0; i < c.estimate.points.size(); ++i)
    c.estimate.points.p[i].z() += 0.05 * std::sin(static_cast<double>(i));
  std::string first;
  for (const int n : {1, 2, 7}) {
    set_threads(n);
    const Score score = score_of(c);
    write_score(file_of("threads"), score);
    const std::string text = read_text(file_of("threads"));
    if (first.empty()) first = text;
    EXPECT_EQ(text, first) << n << " threads";
  }
  set_threads(0);
}

TEST(Score, ComesBackFromItsFile) {
  ExactCase c = tunnel_case();
  c.estimate.grid = {};
  const Score score = score_of(c);
  write_score(file_of("round"), score);
  const Score back = read_score(file_of("round"));
  EXPECT_EQ(back.meta, score.meta);
  EXPECT_EQ(back.notes, score.notes);
  ASSERT_EQ(back.metrics.size(), score.metrics.size());
  for (const Metric& m : score.metrics) {
    const Metric* b = back.find(m.name);
    ASSERT_NE(b, nullptr) << m.name;
    if (std::isfinite(m.value)) {
      EXPECT_EQ(b->value, m.value) << m.name;
    }
    EXPECT_EQ(std::isfinite(b->value), std::isfinite(m.value)) << m.name;
    EXPECT_EQ(b->unit, m.unit);
    EXPECT_EQ(b->better, m.better);
    EXPECT_EQ(b->n, m.n);
    EXPECT_EQ(b->why, m.why);
  }
  EXPECT_EQ(back.passages.size(), score.passages.size());
  ASSERT_EQ(back.worst.size(), score.worst.size());
  EXPECT_EQ(back.find("grid.iou_free")->why, "the map has no grid");
  const std::string text = read_text(file_of("round"));
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("inf"), std::string::npos);
}

TEST(Score, ATruthOfAnotherWorldIsNotComparable) {
  ExactCase c = tunnel_case();
  c.truth.world = "somewhere else";
  try {
    score_of(c);
    FAIL() << "scored";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault(), Fault::not_comparable);
  }
}

TEST(Score, StampsOfAnotherClockAreNotComparable) {
  ExactCase c = tunnel_case();
  for (double& t : c.estimate.path.stamp_s) t += 1e9;
  try {
    score_of(c);
    FAIL() << "scored";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault(), Fault::not_comparable);
    EXPECT_NE(std::string(e.what()).find("stamps"), std::string::npos);
  }
}

TEST(Score, AFileThatIsNoScoreIsRefusedByName) {
  write_text(file_of("bad"), "{\"schema\": 99}");
  EXPECT_THROW(read_score(file_of("bad")), Error);
  write_text(file_of("bad"), "{");
  try {
    read_score(file_of("bad"));
    FAIL() << "read";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find(file_of("bad")), std::string::npos);
  }
}

TEST(Score, TheWorstPlaceIsWhereTheMapIsWorst) {
  ExactCase c = ring_case();
  // Points about (8, 0) in W, 16, 8 in M, are 0.3 m too high.
  for (Vec3& p : c.estimate.points.p)
    if ((p.head<2>() - Vec2(16, 8)).norm() < 2) p.z() += 0.3;
  const Score score = score_of(c);
  ASSERT_FALSE(score.worst.empty());
  EXPECT_LT((score.worst[0].p_W.head<2>() - Vec2(8, 0)).norm(), 2.5);
  EXPECT_EQ(score.worst[0].passage, 1);
  for (size_t k = 1; k < score.worst.size(); ++k) EXPECT_LE(score.worst[k].mae_m, score.worst[k - 1].mae_m);
  size_t worst = 0;
  for (size_t k = 0; k < score.passages.size(); ++k)
    if (score.passages[k].mae_m > score.passages[worst].mae_m) worst = k;
  EXPECT_EQ(score.passages[worst].passage, 1);
}

TEST(Score, AMountsUnknownErrorIsNotThePathsFault) {
  ExactCase c = tunnel_case();
  // The true laser is turned by 1 degree and 2 cm off; the mapper finds its own path from the nominal mount exactly.
  const Pose X = pose_of({0.02, 0, 0}, 0.0174533);
  for (Mount& m : c.truth.rig.mounts) m.X_BS = X * m.X_BS;
  for (Pose& X_MB : c.estimate.path.X_WB) X_MB = X.inverse() * X_MB * X;
  const Score score = score_of(c);
  EXPECT_LT(value(score, "trajectory.first_pose.ate_max_m"), 1e-9);
}

}  // namespace
}  // namespace adit
