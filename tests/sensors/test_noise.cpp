// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/noise.h"
#include "sensors/sick.h"
#include "tests/sensors/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace adit {
namespace {

constexpr int beams = 20000;

struct Sample {
  double mean = 0, sd = 0, echoes = 0, unreadable = 0;  // the last two as shares
};

Sample sample(const LaserModel& model, const Meeting& met, double bias_m, const SensorSettings& s, std::uint64_t seed) {
  std::vector<double> errors;
  double unreadable = 0, sum = 0, squares = 0;
  for (std::uint64_t k = 0; k < beams; ++k) {
    const double r = reading(model, met, bias_m, s, {seed, 17, k});
    unreadable += std::isnan(r);
    if (std::isfinite(r)) errors.push_back(r - met.range_m);
  }
  const double n = static_cast<double>(errors.size());
  for (double e : errors) sum += e;
  for (double e : errors) squares += (e - sum / n) * (e - sum / n);
  return {sum / n, std::sqrt(squares / n), n / beams, unreadable / beams};
}

Meeting wall(double range_m, double reflectivity, double incidence_rad = 0) {
  return {.range_m = range_m, .incidence_rad = incidence_rad, .reflectivity = reflectivity, .label = Label::rib};
}

TEST(Noise, AWhiteWallAtFiveMetresIsReadWithFiveMillimetresSdAndTheDevicesBias) {
  const LaserModel model = load_laser("lms200", 38400);
  SensorSettings s = exact();
  s.noise = true;
  const double expected = std::hypot(range_sigma_m(model, 0.8, 5), 1e-3 / std::sqrt(12.0));  // and the rounding
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Sample got = sample(model, wall(5, 0.8), 0.007, s, seed);
    EXPECT_EQ(got.echoes, 1);
    EXPECT_NEAR(got.mean, 0.007, 5 * expected / std::sqrt(beams)) << seed;         // five standard errors
    EXPECT_NEAR(got.sd, expected, 5 * expected / std::sqrt(2.0 * beams)) << seed;  // of an sd
    EXPECT_NEAR(got.sd, 0.005, 0.0002);                                            // the sheet's
  }
}

TEST(Noise, GrowsTowardsTheThresholdAndWithTheSlantingSpot) {
  const LaserModel model = load_laser("lms200", 38400);
  SensorSettings s = exact();
  s.noise = true;
  const double threshold = model.least_reflectivity(12);
  const double weak = std::hypot(0.005 * std::sqrt(2.0), 1e-3 / std::sqrt(12.0));
  EXPECT_NEAR(sample(model, wall(12, threshold), 0, s, 1).sd, weak, 5 * weak / std::sqrt(2.0 * beams));
  s.footprint = true;
  const double slanted = std::hypot(range_sigma_m(model, 0.45 * std::cos(1.2), 8), footprint_sigma_m(model, 8, 1.2),
                                    1e-3 / std::sqrt(12.0));
  EXPECT_NEAR(sample(model, wall(8, 0.45, 1.2), 0, s, 1).sd, slanted, 5 * slanted / std::sqrt(2.0 * beams));
}

TEST(Noise, ShareOfEchoesIsTheChanceOfDetection) {
  const LaserModel model = load_laser("lms200", 38400);
  SensorSettings s = exact();
  s.detection = true;
  for (double range_m : {8.0, 9.0, 9.4, 10.0, 11.0}) {
    const double p = detection_chance(model, 0.1, range_m, s.detection_spread);
    EXPECT_NEAR(sample(model, wall(range_m, 0.1), 0, s, 1).echoes, p, 5 * std::sqrt(p * (1 - p) / beams)) << range_m;
  }
  EXPECT_EQ(sample(model, wall(8, 0.04), 0, exact(), 1).echoes, 1);  // switched off
}

TEST(Noise, DropOutsAreNaNInTheStatedShareAndNothingElseIs) {
  const LaserModel model = load_laser("lms200", 38400);
  SensorSettings s = exact();
  s.drop_out = 0.01;
  const Sample got = sample(model, wall(3, 0.5), 0, s, 1);
  EXPECT_NEAR(got.unreadable, 0.01, 5 * std::sqrt(0.01 * 0.99 / beams));
  EXPECT_EQ(got.echoes + got.unreadable, 1);
  EXPECT_EQ(sample(model, wall(3, 0.5), 0, exact(), 1).unreadable, 0);
}

TEST(Noise, AnExactLmsErrsByItsRoundingAlone) {
  const Sample got = sample(load_laser("lms200", 0), wall(3.0004, 0.5), 0, exact(), 1);
  EXPECT_NEAR(got.mean, -0.0004, 1e-6);  // a float at 3 m
  EXPECT_LT(got.sd, 1e-7);
}

TEST(Noise, DevicesDifferInBiasWithinTheirBand) {
  const LaserModel model = load_laser("lms200", 0);
  double least = 1, most = -1;
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (size_t mount = 0; mount < 4; ++mount) {
      const double b = device_bias_m(model, mount, SensorSettings{}, seed);
      least = std::min(least, b);
      most = std::max(most, b);
    }
  // Of 200 even draws none misses the outer tenth at either end but with odds of 0.95^200 = 4e-5.
  EXPECT_GE(least, -0.010);
  EXPECT_LE(least, -0.009);
  EXPECT_LE(most, 0.010);
  EXPECT_GE(most, 0.009);
  EXPECT_EQ(device_bias_m(model, 0, exact(), 1), 0);
}

TEST(Noise, MountsErrByTheStatedSdAndNotAtAllWhenSwitchedOff) {
  const Rig nominal = load_rig("cart4", 38400);
  SensorSettings s = exact();
  for (size_t i = 0; i < nominal.mounts.size(); ++i)
    EXPECT_EQ(true_rig(nominal, s, 1).mounts[i].X_BS.matrix(), nominal.mounts[i].X_BS.matrix());
  s.mount_error_deg = 0.2;
  s.mount_error_m = 0.005;
  double turn2 = 0, shift2 = 0;
  constexpr int seeds = 500;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const Pose X = nominal.mounts[2].X_BS.inverse() * true_rig(nominal, s, seed).mounts[2].X_BS;
    turn2 += std::pow(Eigen::AngleAxisd(X.linear()).angle(), 2);
    shift2 += X.translation().squaredNorm();
  }
  // A chi-square of 3 * seeds degrees: five sd are 5 * sqrt(2 / n) of it.
  const double part = 5 * std::sqrt(2.0 / (3 * seeds)), sd_rad = 0.2 * M_PI / 180;
  EXPECT_NEAR(turn2 / (3 * seeds * sd_rad * sd_rad), 1, part);
  EXPECT_NEAR(shift2 / (3 * seeds * 0.005 * 0.005), 1, part);
}

}  // namespace
}  // namespace adit
