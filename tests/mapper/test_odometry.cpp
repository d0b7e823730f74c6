// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "mapper/odometry.h"
#include "tests/support/plan_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string>

namespace adit {
namespace {

PlanLog straight_and_round(double rough_rms_m, std::uint64_t seed, const TourSettings& tour = {}) {
  const double d = 18;
  const Plan plan = plan_along(panel_lines(2, 3, d), {.rough_rms_m = rough_rms_m}, seed);
  return drive_plan(plan, {{2, 0}, {2 * d, 0}, {2 * d, d}, {0, d}, {0, 2}}, tour, seed);
}

double end_error_m(const PlanLog& log, const Odometry& o) {
  return (o.X_MB.back().position() - log.X_MB(o.X_MB.size() - 1).position()).norm();
}

double driven_m(const PlanLog& log) {
  double sum = 0;
  for (size_t i = 1; i < log.X_WB.size(); ++i) sum += (log.X_WB[i].position() - log.X_WB[i - 1].position()).norm();
  return sum;
}

TEST(Odometry, DriftsLessThanATenthOfAPercentOnRoughRibs) {
  for (const std::uint64_t seed : {100, 101}) {
    const PlanLog log = straight_and_round(0.05, seed);
    const Odometry o = estimate_motion(log.scans, log.mount, {});
    EXPECT_EQ(o.lost, 0) << "seed " << seed;
    EXPECT_LT(end_error_m(log, o), 0.001 * driven_m(log)) << "seed " << seed;
  }
}

TEST(Odometry, StepsChainToThePosesAndBeginAtTheOrigin) {
  const PlanLog log = straight_and_round(0.05, 100);
  const Odometry o = estimate_motion(log.scans, log.mount, {});
  ASSERT_EQ(o.X_MB.size(), log.scans.size());
  EXPECT_EQ(o.X_MB[0].position(), Vec2(0, 0));
  Pose2 X;
  for (size_t i = 1; i < o.X_MB.size(); ++i) {
    X = X * o.X_step[i];
    EXPECT_NEAR((X.position() - o.X_MB[i].position()).norm(), 0, 1e-9);
    EXPECT_GT(o.information[i].determinant(), 0);
  }
}

// Ribs that lean by half their height, seen by a laser that pitches by 2 deg every 1.1 s: what a beam meets far ahead is
// nearer or farther by half of what it is higher or lower.
PlanLog leaning(PlanLog log) {
  constexpr double lean = 0.5, pitch_rad = 0.035, period_s = 1.1;
  for (size_t i = 0; i < log.scans.size(); ++i) {
    const double pitch = pitch_rad * std::sin(2 * std::numbers::pi * log.scans.stamp_s[i] / period_s);
    for (int k = 0; k < log.scans.beams; ++k)
      log.scans.range_m[i * log.scans.beams + k] *=
          static_cast<float>(1 + lean * pitch * std::cos(log.mount.laser.beam_angle_rad(k)));
  }
  return log;
}

TEST(Odometry, RibsThatLeanAreFoundUnevenAndAreMatchedAllTheSame) {
  const PlanLog log = leaning(straight_and_round(0.05, 100));
  const Odometry o = estimate_motion(log.scans, log.mount, {});
  EXPECT_TRUE(o.uneven);
  EXPECT_GT(at_ribs({}, o).match.map_sigma_m, MatchSettings{}.map_sigma_m);
  EXPECT_EQ(at_ribs({}, o).points.range_max_m, OdometrySettings{}.uneven_range_m);
  EXPECT_EQ(o.lost, 0);
  // Steps follow the swing of the scans; what adds up is far less.
  EXPECT_LT(end_error_m(log, o), 0.02 * driven_m(log));
}

TEST(Odometry, InSpaceOnlyRibsThatWereEvenAreSteadierThanTheirScans) {
  Odometry even, uneven;
  uneven.uneven = true;
  EXPECT_EQ(in_space({}, {}, even).steadiness, SpaceSettings{}.steadiness);
  EXPECT_EQ(in_space({}, {}, uneven).steadiness, 1);
  EXPECT_EQ(in_space({}, {}, even).points.range_max_m, SpaceSettings{}.range_max_m);
}

TEST(Odometry, RoughRibsAreEven) {
  const PlanLog log = straight_and_round(0.05, 100);
  const Odometry o = estimate_motion(log.scans, log.mount, {});
  EXPECT_FALSE(o.uneven);
  EXPECT_EQ(at_ribs({}, o).match.map_sigma_m, MatchSettings{}.map_sigma_m);
  EXPECT_EQ(at_ribs({}, o).points.range_max_m, ScanPointSettings{}.range_max_m);
}

TEST(Odometry, ACartThatStandsStays) {
  TourSettings tour;
  tour.stop_at_m = 10, tour.stop_s = 20;
  const PlanLog log = straight_and_round(0.05, 102, tour);
  const Odometry o = estimate_motion(log.scans, log.mount, {});
  EXPECT_EQ(o.lost, 0);
  EXPECT_LT(end_error_m(log, o), 0.001 * driven_m(log));
}

TEST(Odometry, SmoothRibsAreReportedAsDegenerateWithASigma) {
  // 60 m of smooth entry with nothing in view but its two ribs.
  const Plan plan = plan_along({{Vec2(0, 0), Vec2(100, 0)}}, {.rough_rms_m = 0}, 1);
  const PlanLog log = drive_plan(plan, {{20, 0}, {60, 0}}, {}, 1);
  const Odometry o = estimate_motion(log.scans, log.mount, {});
  ASSERT_EQ(o.degenerate.size(), 1u);
  const DegenerateStretch& d = o.degenerate[0];
  EXPECT_LT(d.from_s, 5);
  EXPECT_GT(d.to_s, log.scans.stamp_s.back() - 5);
  EXPECT_LT(end_error_m(log, o), 3 * d.sigma_m);  // three standard deviations
  // Across the entry nothing is lost: 0.3 deg over 40 m.
  EXPECT_NEAR((log.X_WB[0] * o.X_MB.back()).y_m, log.X_WB.back().y_m, 0.2);
}

TEST(Odometry, RoughRibsAreNotCalledDegenerate) {
  const PlanLog log = straight_and_round(0.05, 103);
  double flagged_s = 0;
  for (const DegenerateStretch& d : estimate_motion(log.scans, log.mount, {}).degenerate)
    flagged_s += d.to_s - d.from_s;
  EXPECT_LT(flagged_s, 0.02 * log.scans.stamp_s.back());
}

TEST(Odometry, ScansWithoutAnyEchoAreCountedAndBridged) {
  PlanLog log = straight_and_round(0.05, 100);
  for (size_t i = 50; i < 53; ++i)
    for (int k = 0; k < log.scans.beams; ++k)
      log.scans.range_m[i * log.scans.beams + k] = std::numeric_limits<float>::quiet_NaN();
  const Odometry o = estimate_motion(log.scans, log.mount, {});
  EXPECT_EQ(o.lost, 3);
  EXPECT_LT(end_error_m(log, o), 0.1);
}

TEST(Odometry, OneScanIsAPoseAndNoneIsAnError) {
  PlanLog log = straight_and_round(0.05, 100);
  Scans one;
  one.beams = log.scans.beams;
  one.stamp_s = {log.scans.stamp_s[0]};
  one.range_m.assign(log.scans[0].begin(), log.scans[0].end());
  EXPECT_EQ(estimate_motion(one, log.mount, {}).X_MB.size(), 1u);
  one.stamp_s.clear(), one.range_m.clear();
  EXPECT_THROW(estimate_motion(one, log.mount, {}), Error);
}

TEST(Odometry, AStampThatRepeatsIsAnErrorThatNamesLaserAndScan) {
  PlanLog log = straight_and_round(0.05, 100);
  log.scans.stamp_s[7] = log.scans.stamp_s[6];
  try {
    estimate_motion(log.scans, log.mount, {});
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("'front': scan 7"), std::string::npos) << e.what();
  }
}

TEST(Odometry, TheSameBitsOnAnyNumberOfThreads) {
  const PlanLog log = straight_and_round(0.05, 100);
  set_threads(1);
  const Odometry one = estimate_motion(log.scans, log.mount, {});
  set_threads(7);
  const Odometry seven = estimate_motion(log.scans, log.mount, {});
  set_threads(0);
  for (size_t i = 0; i < one.X_MB.size(); ++i)
    ASSERT_EQ(std::memcmp(&one.X_MB[i], &seven.X_MB[i], sizeof(Pose2)), 0) << "scan " << i;
}

}  // namespace
}  // namespace adit
