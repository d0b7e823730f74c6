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

TEST(Sick, EachReflectivityEndsWhereTheChartSays) {
  struct Row {
    double reflectivity, range_m, read_m;  // the chart turned round, and how finely it was read
  };
  for (const Row& row : {Row{0.03, 5.1, 0.06},
                         {0.05, 6.6, 0.06},
                         {0.08, 8.4, 0.06},
                         {0.10, 9.4, 0.06},
                         {0.20, 13, 0.6},
                         {0.40, 19, 0.6},
                         {0.60, 23, 0.6},
                         {3.0, 53, 1}}) {
    EXPECT_LT(lms200().least_reflectivity(row.range_m - row.read_m), row.reflectivity);
    EXPECT_GT(lms200().least_reflectivity(row.range_m + row.read_m), row.reflectivity);
  }
}

TEST(Sick, ADarkWallIsLostBetween80And85DegreesOfIncidence) {
  for (const double reflectivity : {0.11, 0.15, 0.20}) {  // 4 m away and nearer
    EXPECT_GT(detection_chance(lms200(), reflectivity * std::cos(78 * M_PI / 180), 4, spread), 0.5) << reflectivity;
    EXPECT_LT(detection_chance(lms200(), reflectivity * std::cos(86 * M_PI / 180), 4, spread), 0.1) << reflectivity;
  }
}

TEST(Sick, RockDustIsSeenToSomeTwentyMetres) {
  EXPECT_GT(detection_chance(lms200(), 0.45, 17, spread), 0.9);
  EXPECT_LT(detection_chance(lms200(), 0.45, 24, spread), 0.1);
}

TEST(Sick, AnIdealLaserSeesEverything) {
  EXPECT_EQ(detection_chance(load_laser("ideal", 0), 1e-9, 900, spread), 1);
}

TEST(Sick, NoiseIsTheSheetsOnBrightTargetsAndRootTwoTimesAtTheThreshold) {
  EXPECT_NEAR(range_sigma_m(lms200(), lms200().least_reflectivity(5) / 0.8), 0.005, 0.005 * 0.001);
  EXPECT_NEAR(range_sigma_m(lms200(), 1), 0.005 * std::sqrt(2), 1e-9);
}

TEST(Sick, FootprintAddsNothingHeadOnAndAnEighthOfTheSpotAtFortyFiveDegrees) {
  EXPECT_EQ(footprint_sigma_m(lms200(), 10, 1), 0);
  EXPECT_NEAR(footprint_sigma_m(lms200(), 10, std::sqrt(0.5)), 0.056 / 8, 1e-9);  // 12 mm + 4.4 mrad * 10 m
}

TEST(Sick, TheTelegramTellsWholeMillimetresUpToTheModesRange) {
  EXPECT_EQ(reported_range_m(lms200(), 5.00049), 5.0f);
  EXPECT_EQ(reported_range_m(lms200(), 5.00051), 5.001f);
  EXPECT_EQ(reported_range_m(load_laser("lms291", 0), 5.004), 5.0f);  // centimetres
  EXPECT_TRUE(std::isfinite(reported_range_m(lms200(), 32.758)));
  EXPECT_EQ(reported_range_m(lms200(), 32.76), INFINITY);
  EXPECT_TRUE(std::isnan(reported_range_m(lms200(), 0.0001)));
}

TEST(Sick, TheOutdoorUnitsThresholdIsItsChartAndBlindForDarkTargetsAtHand) {
  const LaserModel m = load_laser("lms291", 0);
  // Read off the chart of a clean window.
  for (const auto& [range_m, least] : {std::pair{0.5, 0.18}, {1.0, 0.06}, {5.0, 0.016}, {20.0, 0.052}, {80.0, 0.74}})
    EXPECT_NEAR(m.least_reflectivity(range_m), least, 1e-12) << range_m;
  EXPECT_NEAR(m.least_reflectivity(0.6), 0.14, 1e-12);      // straight between the points
  EXPECT_LT(detection_chance(m, 0.06, 0.7, spread), 0.05);  // coal at hand
  EXPECT_GT(detection_chance(m, 0.06, 2, spread), 0.95);
  EXPECT_GT(detection_chance(m, 0.05, 18, spread), 0.5);  // 5 % to some 20 m
  EXPECT_LT(detection_chance(m, 0.05, 23, spread), 0.1);
}

TEST(Sick, CoalAtHandIsFirstSeenByAnOutdoorUnitSomeWhereFrom80To120Centimetres) {
  const LaserModel m = load_laser("lms291", 0);
  for (const double coal : {0.05, 0.08}) {
    double from_m = 0.2;
    while (m.least_reflectivity(from_m) > coal) from_m += 0.01;
    EXPECT_GT(from_m, 0.8) << coal;
    EXPECT_LT(from_m, 1.2) << coal;
  }
}

TEST(Sick, SensitivityMovesTheRangeOfATenPercentTargetAsTheSheetSays) {
  // Low, medium, high: 20, 25, 42 m; the chart itself is of a unit that sees it at some 30 m.
  for (const char* model : {"lms291", "lms221", "lms211", "lms291s14"})
    for (const auto& [setting, range_m] : {std::pair{"low", 20.0}, {"medium", 25.0}, {"high", 42.0}, {"", 28.9}}) {
      const LaserModel m = load_laser(model, 0, {.sensitivity = setting});
      EXPECT_NEAR(m.least_reflectivity(range_m), 0.1, 0.001) << model << " " << setting;
    }
}

TEST(Sick, ModesEndWhereTheirBitsDo) {
  for (const auto& [mode, most] : {std::pair{"8m", 8.183}, {"16m", 16.375}, {"32m", 32.759}, {"80m", 81.83}}) {
    const LaserModel m = load_laser("lms200", 38400, {mode, ""});
    EXPECT_TRUE(std::isfinite(reported_range_m(m, most))) << mode;
    EXPECT_EQ(reported_range_m(m, most + 0.01), INFINITY) << mode;
  }
  EXPECT_EQ(load_laser("lms200", 38400, {"80m", ""}).resolution_m, 0.01);
}

TEST(Sick, RastersHaveTheTelegramsValuesTurnsAndRates) {
  struct Row {
    const char* raster;
    int beams, interlace;
    double hz[4];
  };
  // The telegram listing's table of scans that are skipped, as rates.
  const int bauds[] = {9600, 19200, 38400, 500000};
  for (const Row& row : {Row{"180/1", 181, 1, {2.4, 4.7, 8.3, 75}}, Row{"180/0.5", 361, 2, {1.25, 2.3, 4.2, 37.5}},
                         Row{"100/0.25", 401, 4, {1.1, 2.1, 3.8, 18.8}}})
    for (size_t i = 0; i < 4; ++i) {
      const LaserModel m = load_laser("lms200", bauds[i], {"", row.raster});
      EXPECT_EQ(m.beams, row.beams);
      EXPECT_EQ(m.interlace, row.interlace);
      EXPECT_NEAR(1 / m.interval_s, row.hz[i], 0.06 + 0.001 * row.hz[i]) << row.raster << " at " << bauds[i];
    }
  const LaserModel narrow = load_laser("lms211", 500000);
  EXPECT_EQ(narrow.beams, 201);
  EXPECT_NEAR(narrow.fov_rad, 100 * M_PI / 180, 1e-12);
  const LaserModel fast = load_laser("lms291s14", 500000);  // half a degree in one turn
  EXPECT_EQ(fast.beams, 181);
  EXPECT_NEAR(fast.beam_angle_rad(1) - fast.beam_angle_rad(0), 0.5 * M_PI / 180, 1e-12);
  EXPECT_NEAR(fast.interval_s, 0.01332, 1e-12);
}

}  // namespace
}  // namespace adit
