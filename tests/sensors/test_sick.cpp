// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sick.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

const LaserModel& lms200() {
  static const LaserModel model = load_laser("lms200", 38400);
  return model;
}
constexpr double spread = 0.1;

TEST(Sick, ThresholdIsTheSheetsChart) {
  // Digitised from the chart: 1.85 % up to 4 m, 11 % at 10 m, 100 % at 30 m; a reading of it is good to 5 %.
  EXPECT_NEAR(lms200().least_reflectivity(1), 0.0185, 0.05 * 0.0185);
  EXPECT_NEAR(lms200().least_reflectivity(4), 0.0185, 0.05 * 0.0185);
  EXPECT_NEAR(lms200().least_reflectivity(10), 0.11, 0.05 * 0.11);
  EXPECT_NEAR(lms200().least_reflectivity(30), 1.0, 0.05);
}

TEST(Sick, ATargetOfTenPercentIsSeenAtNineMetresAndNotAtEleven) {
  EXPECT_GT(detection_chance(lms200(), 0.10, 9, spread), 0.5);
  EXPECT_LT(detection_chance(lms200(), 0.10, 11, spread), 0.1);
}

TEST(Sick, BareCoalIsSeenAtFiveMetresAndNotAtEight) {
  EXPECT_GT(detection_chance(lms200(), 0.04, 5, spread), 0.9);
  EXPECT_LT(detection_chance(lms200(), 0.04, 8, spread), 0.01);
}

TEST(Sick, RockDustIsSeenToSomeTwentyMetres) {
  EXPECT_GT(detection_chance(lms200(), 0.45, 17, spread), 0.9);
  EXPECT_LT(detection_chance(lms200(), 0.45, 24, spread), 0.1);
}

TEST(Sick, AnIdealLaserSeesEverything) {
  EXPECT_EQ(detection_chance(load_laser("ideal", 0), 1e-9, 900, spread), 1);
}

TEST(Sick, NoiseIsTheSheetsOnBrightTargetsAndRootTwoTimesAtTheThreshold) {
  EXPECT_NEAR(range_sigma_m(lms200(), 0.8, 5), 0.005, 0.005 * 0.001);
  EXPECT_NEAR(range_sigma_m(lms200(), lms200().least_reflectivity(12), 12), 0.005 * std::sqrt(2), 1e-9);
}

TEST(Sick, FootprintAddsNothingHeadOnAndAnEighthOfTheSpotAtFortyFiveDegrees) {
  EXPECT_EQ(footprint_sigma_m(lms200(), 10, 0), 0);
  EXPECT_NEAR(footprint_sigma_m(lms200(), 10, std::atan(1.0)), 0.056 / 8, 1e-9);  // 12 mm + 4.4 mrad * 10 m
}

TEST(Sick, TheTelegramTellsWholeMillimetresUpToTheModesRange) {
  EXPECT_EQ(reported_range_m(lms200(), 5.00049), 5.0f);
  EXPECT_EQ(reported_range_m(lms200(), 5.00051), 5.001f);
  EXPECT_EQ(reported_range_m(load_laser("lms291", 0), 5.004), 5.0f);  // centimetres
  EXPECT_TRUE(std::isfinite(reported_range_m(lms200(), 32.758)));
  EXPECT_EQ(reported_range_m(lms200(), 32.76), INFINITY);
  EXPECT_TRUE(std::isnan(reported_range_m(lms200(), 0.0001)));
}

}  // namespace
}  // namespace adit
