// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "mapper/mapper.h"
#include "tests/mapper/open_loop.h"
#include "tests/support/plan_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

Log log_of(const PlanLog& plan) {
  Log log;
  log.rig.name = "flat";
  log.rig.mounts = {plan.mount};
  log.scans = {plan.scans};
  return log;
}

std::vector<Pose2> truth_of(const PlanLog& plan) {
  std::vector<Pose2> X;
  for (size_t i = 0; i < plan.X_WB.size(); ++i) X.push_back(plan.X_MB(i));
  return X;
}

/// A tour of three loops of rough ribs; made once.
const PlanLog& tour() {
  static const PlanLog plan = loop_tour({}, {}, 5);
  return plan;
}

TEST(Mapper, ThreeLoopsOfRoughRibsCloseToCentimetres) {
  const Estimate e = make_map(log_of(tour()), {});
  EXPECT_EQ(e.method, "robust");
  EXPECT_TRUE(e.converged);
  EXPECT_LT(ate_m(truth_of(tour()), e.planar), 0.03);  // the bar of the whole job on a mine seven times as long is 0.05
  EXPECT_EQ(wrong_places(e.closures, truth_of(tour())), 0);
  EXPECT_GT(recall(e.closures, truth_of(tour())), 0.9);
  EXPECT_GT(e.grid.width, 0);
}

TEST(Mapper, ThePublishedMethodMakesAGoodPathNoWorse) {
  MapSettings settings;
  settings.method = "icra2003";
  const Estimate e = make_map(log_of(tour()), settings);
  EXPECT_LT(ate_m(truth_of(tour()), e.planar), ate_m(truth_of(tour()), e.open_loop) + 0.02);
  EXPECT_EQ(wrong_places(e.closures, truth_of(tour())), 0);
  ASSERT_FALSE(e.closures.empty());
  for (const Closure& c : e.closures) EXPECT_FALSE(c.measured);
}

TEST(Mapper, WhatTheRigCannotSeeIsLeftOutAndNoted) {
  const Estimate e = make_map(log_of(tour()), {});
  EXPECT_FALSE(e.volume_m3.has_value());
  EXPECT_TRUE(e.surface.face.empty());
  EXPECT_THAT(e.notes, testing::Contains(testing::HasSubstr("upward laser")));
  ASSERT_EQ(e.path.size(), e.planar.size());
  for (size_t i = 0; i < e.path.size(); ++i) EXPECT_EQ(e.path.X_WB[i].translation().z(), 0);
}

TEST(Mapper, ARigWithoutAHorizontalLaserIsAnError) {
  Log log = log_of(tour());
  log.rig.mounts[0].X_BS.linear() = rotation_of(0, 0, std::numbers::pi / 2);
  try {
    make_map(log, {});
    FAIL() << "a map from nothing";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no horizontal laser"));
  }
}

TEST(Mapper, AnEmptyRecordingIsAnError) {
  Log log = log_of(tour());
  log.scans[0] = {};
  EXPECT_THROW(make_map(log, {}), Error);
}

TEST(Mapper, AGapInWhichTheCartStoodIsBridged) {
  Log log = log_of(tour());
  std::vector<double>& stamps = log.scans[0].stamp_s;
  for (size_t n = 400; n < stamps.size(); ++n) stamps[n] += 30;
  const Estimate e = make_map(log, {});
  EXPECT_EQ(e.path.size(), stamps.size());
  EXPECT_LT(ate_m(truth_of(tour()), e.planar), 0.1);
}

TEST(Mapper, OfALogThatAGapCutsTheLongestPieceIsMappedAndItIsSaid) {
  const Scans& all = tour().scans;
  std::vector<size_t> kept;
  for (size_t n = 0; n < all.size(); ++n)
    if (n < 100 || all.stamp_s[n] > all.stamp_s[100] + 30) kept.push_back(n);
  Log log = log_of(tour());
  log.scans[0] = chosen(all, kept);
  const Estimate e = make_map(log, {});
  EXPECT_EQ(e.path.size(), kept.size() - 100);
  EXPECT_EQ(e.path.stamp_s.front(), all.stamp_s[kept[100]]);
  ASSERT_FALSE(e.notes.empty());
  EXPECT_THAT(e.notes[0], HasSubstr("the log falls into 2 pieces that nothing connects"));
  EXPECT_THAT(e.notes[0],
              HasSubstr(std::to_string(kept.size() - 100) + " of " + std::to_string(kept.size()) + " scans"));
}

TEST(Mapper, ScansWhoseStampsDoNotGrowAreLeftOutAndCounted) {
  const Scans& all = tour().scans;
  const Log sound = log_of(tour());
  Log log = sound;
  std::vector<size_t> numbers;
  for (size_t n = 0; n < all.size(); ++n) {
    numbers.push_back(n);
    if (n % 100 == 50) numbers.push_back(n);  // told twice
  }
  log.scans[0] = chosen(all, numbers);
  const size_t twice = numbers.size() - all.size();
  for (size_t n = 200; n < 203; ++n) log.scans[0].stamp_s[n] -= 1e4;
  const Estimate e = make_map(log, {});
  EXPECT_EQ(e.path.size(), all.size() - 3);
  EXPECT_THAT(e.notes, Contains(HasSubstr(std::to_string(twice + 3) + " of " + std::to_string(numbers.size()) +
                                          " scans are left out: their stamps do not grow")));
}

TEST(Mapper, TheSameMapOnAnyNumberOfThreads) {
  Log log = log_of(tour());
  Scans& scans = log.scans[0];
  scans.stamp_s.resize(700);
  scans.range_m.resize(700 * static_cast<size_t>(scans.beams));
  std::vector<Pose2> first;
  std::vector<float> first_grid;
  for (int count : {1, 2, 7}) {
    set_threads(count);
    const Estimate e = make_map(log, {});
    if (first.empty()) first = e.planar, first_grid = e.grid.log_odds;
    for (size_t i = 0; i < first.size(); ++i)
      ASSERT_TRUE(e.planar[i].x_m == first[i].x_m && e.planar[i].y_m == first[i].y_m &&
                  e.planar[i].yaw_rad == first[i].yaw_rad)
          << "scan " << i << ", " << count << " threads";
    EXPECT_EQ(e.grid.log_odds, first_grid);
  }
  set_threads(0);
}

TEST(Mapper, EverySettingHasOneKey) {
  MapSettings settings;
  std::vector<std::string> keys;
  for (const Field& field : fields(settings)) keys.push_back(field.key);
  std::vector<std::string> unique = keys;
  std::sort(unique.begin(), unique.end());
  EXPECT_EQ(std::unique(unique.begin(), unique.end()), unique.end());
  EXPECT_THAT(keys, testing::Contains("icra2003.sigma_across_m"));
}

}  // namespace
}  // namespace adit
