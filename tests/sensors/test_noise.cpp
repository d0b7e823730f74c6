// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/noise.h"
#include "sensors/sick.h"
#include "tests/sensors/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace adit {
namespace {

constexpr int beams = 20000;

struct Sample {
  double mean = 0, sd = 0, echoes = 0, unreadable = 0;  // the last two as shares
};

// A flat target that fills the spot.
struct Target {
  double range_m, reflectivity, incidence_rad = 0;
};

Device device_of(const std::string& model, const LaserChoice& choice = {}) {
  return {.model = load_laser(model, 38400, choice)};
}

Reading read_one(const Device& device, const Target& wall, const SensorSettings& s, std::uint64_t seed,
                 std::uint64_t beam, double on_s = 0) {
  std::vector<Return> returns{{wall.range_m, wall.reflectivity * std::cos(wall.incidence_rad)}};
  return reading(device, returns, std::cos(wall.incidence_rad), s, chance_at(Draws(seed, Draw::beam_chance), 17, beam),
                 {seed, 17, beam}, on_s);
}

Sample sample(const Device& device, const Target& wall, const SensorSettings& s, std::uint64_t seed) {
  std::vector<double> errors;
  double unreadable = 0, sum = 0, squares = 0;
  for (std::uint64_t k = 0; k < beams; ++k) {
    const double r = read_one(device, wall, s, seed, k).range_m;
    unreadable += std::isnan(r);
    if (std::isfinite(r)) errors.push_back(r - wall.range_m);
  }
  const double n = static_cast<double>(errors.size());
  for (double e : errors) sum += e;
  for (double e : errors) squares += (e - sum / n) * (e - sum / n);
  return {sum / n, std::sqrt(squares / n), n / beams, unreadable / beams};
}

double share_of(Code code, const Device& device, const Target& wall, const SensorSettings& s) {
  double n = 0;
  for (std::uint64_t k = 0; k < beams; ++k) n += read_one(device, wall, s, 1, k).code == code;
  return n / beams;
}

TEST(Noise, AWhiteWallAtFiveMetresIsReadWithFiveMillimetresSdAndTheDevicesBias) {
  const Device device = device_of("lms200");
  SensorSettings s = exact();
  s.noise = true;
  const double expected = std::hypot(0.005, 1e-3 / std::sqrt(12.0));  // and the rounding
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Device biased = device;
    biased.bias_m = 0.007;
    const Sample got = sample(biased, {5, 0.8}, s, seed);
    EXPECT_EQ(got.echoes, 1);
    EXPECT_NEAR(got.mean, 0.007, 5 * expected / std::sqrt(beams)) << seed;         // five standard errors
    EXPECT_NEAR(got.sd, expected, 5 * expected / std::sqrt(2.0 * beams)) << seed;  // of an sd
    EXPECT_NEAR(got.sd, 0.005, 0.0002);                                            // the sheet's
  }
}

TEST(Noise, GrowsTowardsTheThresholdAndWithTheSlantingSpot) {
  const Device device = device_of("lms200");
  const LaserModel& model = device.model;
  SensorSettings s = exact();
  s.noise = true;
  const double threshold = model.least_reflectivity(12);
  const double weak = std::hypot(0.005 * std::sqrt(2.0), 1e-3 / std::sqrt(12.0));
  EXPECT_NEAR(sample(device, {12, threshold}, s, 1).sd, weak, 5 * weak / std::sqrt(2.0 * beams));
  s.footprint = true;
  const double slanted = std::hypot(range_sigma_m(model, model.least_reflectivity(8) / (0.45 * std::cos(1.2))),
                                    footprint_sigma_m(model, 8, std::cos(1.2)), 1e-3 / std::sqrt(12.0));
  EXPECT_NEAR(sample(device, {8, 0.45, 1.2}, s, 1).sd, slanted, 5 * slanted / std::sqrt(2.0 * beams));
}

TEST(Noise, MergedSurfacesAreToldLessSurelyByATenthOfTheirSpread) {
  const Device device = device_of("lms200");
  SensorSettings s = exact();
  s.noise = true;
  // Half of the spot at 5 m, half at 5.8 m, which gives (5 / 5.8)^2 of the power.
  const double far = 25 / (5.8 * 5.8), mean = 5 + 0.8 * far / (1 + far);
  const double spread = 0.8 * std::sqrt(far) / (1 + far), power = 0.25 * (1 + far);
  const double expected = std::hypot(range_sigma_m(device.model, device.model.least_reflectivity(5) / power),
                                     0.1 * spread, 1e-3 / std::sqrt(12.0));
  double sum = 0, squares = 0;
  for (std::uint64_t k = 0; k < beams; ++k) {
    std::vector<Return> returns{{5, 0.25}, {5.8, 0.25}};
    const double e =
        reading(device, returns, 1, s, chance_at(Draws(2, Draw::beam_chance), 17, k), {2, 17, k}, 0).range_m - mean;
    sum += e, squares += e * e;
  }
  EXPECT_NEAR(sum / beams, 0, 5 * expected / std::sqrt(beams));
  EXPECT_NEAR(std::sqrt(squares / beams), expected, 5 * expected / std::sqrt(2.0 * beams));
}

TEST(Noise, TheSmearOfASlantingSpotErrsWithoutOtherNoiseToo) {
  const Device device = device_of("lms200");
  SensorSettings s = exact();
  s.footprint = true;
  const double alone = std::hypot(footprint_sigma_m(device.model, 8, std::cos(1.2)), 1e-3 / std::sqrt(12.0));
  EXPECT_NEAR(sample(device, {8, 0.45, 1.2}, s, 1).sd, alone, 5 * alone / std::sqrt(2.0 * beams));
  EXPECT_LT(sample(device, {8, 0.45, 0}, s, 1).sd, 1e-6);  // head-on there is none
}

TEST(Noise, ShareOfEchoesIsTheChanceOfDetection) {
  const Device device = device_of("lms200");
  const LaserModel& model = device.model;
  SensorSettings s = exact();
  s.detection = true;
  for (double range_m : {8.0, 9.0, 9.4, 10.0, 11.0}) {
    const double p = detection_chance(model, 0.1, range_m, s.detection_spread);
    EXPECT_NEAR(sample(device, {range_m, 0.1}, s, 1).echoes, p, 5 * std::sqrt(p * (1 - p) / beams)) << range_m;
  }
  EXPECT_EQ(sample(device, {8, 0.04}, exact(), 1).echoes, 1);  // switched off
}

TEST(Noise, DropOutsAreNaNInTheStatedShareAndNothingElseIs) {
  const Device device = device_of("lms200");
  SensorSettings s = exact();
  s.drop_out = 0.01;
  const Sample got = sample(device, {3, 0.5}, s, 1);
  EXPECT_NEAR(got.unreadable, 0.01, 5 * std::sqrt(0.01 * 0.99 / beams));
  EXPECT_EQ(got.echoes + got.unreadable, 1);
  EXPECT_EQ(sample(device, {3, 0.5}, exact(), 1).unreadable, 0);
}

TEST(Noise, AnExactLmsErrsByItsRoundingAlone) {
  const Sample got = sample(device_of("lms200"), {3.0004, 0.5}, exact(), 1);
  EXPECT_NEAR(got.mean, -0.0004, 1e-6);  // a float at 3 m
  EXPECT_LT(got.sd, 1e-7);
}

TEST(Noise, DevicesDifferInBiasWithinTheirBand) {
  const LaserModel model = load_laser("lms200", 0);
  double least = 1, most = -1;
  for (std::uint64_t seed = 0; seed < 50; ++seed)
    for (size_t mount = 0; mount < 4; ++mount) {
      const double b = make_device(model, mount, SensorSettings{}, seed).bias_m;
      least = std::min(least, b);
      most = std::max(most, b);
    }
  // Of 200 even draws none misses the outer tenth at either end but with odds of 0.95^200 = 4e-5.
  EXPECT_GE(least, -0.010);
  EXPECT_LE(least, -0.009);
  EXPECT_LE(most, 0.010);
  EXPECT_GE(most, 0.009);
  EXPECT_EQ(make_device(model, 0, exact(), 1).bias_m, 0);
}

TEST(Noise, AnOffsetMovesEveryDeviceAndAScaleWidensTheNoiseByThatMuch) {
  const LaserModel model = load_laser("lms200", 0);
  SensorSettings offset;
  offset.range_offset_m = 0.005;
  for (size_t mount = 0; mount < 4; ++mount)
    EXPECT_NEAR(make_device(model, mount, offset, 3).bias_m - make_device(model, mount, {}, 3).bias_m, 0.005, 1e-15);
  SensorSettings noisy = exact();
  noisy.noise = true;
  const double sd = sample(device_of("lms200"), {3, 0.5}, noisy, 1).sd;
  noisy.noise_scale = 1.1;
  // The same draws, rounded to millimetres whose own sd of 0.3 mm is not scaled: 0.3^2 / 5^2 / 2 of 10 %.
  EXPECT_NEAR(sample(device_of("lms200"), {3, 0.5}, noisy, 1).sd / sd, 1.1, 0.001);
}

TEST(Noise, TheCurveSwingsWithinItsBandAndDiffersByDevice) {
  const LaserModel model = load_laser("lms200", 0);
  SensorSettings s = exact();
  s.range_curve = true;
  double most = 0, apart = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Device a = make_device(model, 0, s, seed), b = make_device(model, 1, s, seed);
    for (double r = 0.5; r < 20; r += 0.1) {
      most = std::max(most, std::abs(device_error_m(a, r, 0.5, 0)));
      apart = std::max(apart, std::abs(device_error_m(a, r, 0.5, 0) - device_error_m(b, r, 0.5, 0)));
    }
  }
  EXPECT_LE(most, 0.005);
  EXPECT_GT(most, 0.003);  // of 300 amplitudes some are near the band
  EXPECT_GT(apart, 0.003);
}

TEST(Noise, BiasCurveAndBrightnessStayWithinTheSheetsFifteenMillimetresButForFive) {
  SensorSettings s = exact();
  s.bias = s.range_curve = true;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const Device d = make_device(load_laser("lms200", 0), 0, s, seed);
    for (double r = 1; r < 8; r += 0.25) EXPECT_LE(std::abs(device_error_m(d, r, 0.5, 0)), 0.015) << seed;
  }
}

TEST(Noise, TheBandsOfADevicesErrorsFillTheSheetsInEveryModeButForBrightnessInMillimetres) {
  struct Row {
    const char *model, *mode;
    double sheet_m, energy;
  };
  for (const Row& row : {Row{"lms200", "8m", 0.015, 0},
                         {"lms200", "80m", 0.040, 1},
                         {"lms220", "8m", 0.015, 0},
                         {"lms291", "80m", 0.050, 1},
                         {"lms221", "80m", 0.050, 1},
                         {"lms211", "80m", 0.050, 1}}) {
    const LaserModel m = load_laser(row.model, 0, {.mode = row.mode});
    EXPECT_NEAR(m.bias_m + m.curve_m + row.energy * m.energy_m, row.sheet_m, 1e-12) << row.model << " " << row.mode;
  }
  const LaserModel fine = load_laser("lms291", 0, {.mode = "8m"});
  EXPECT_LE(fine.bias_m + fine.curve_m, 0.035);
}

TEST(Noise, BrightAndDarkTargetsErrToOppositeSides) {
  SensorSettings s = exact();
  s.energy = true;
  const Device d = make_device(load_laser("lms200", 0), 0, s, 3);
  EXPECT_NE(d.energy_m, 0);
  EXPECT_LE(std::abs(d.energy_m), 0.005);
  EXPECT_NEAR(device_error_m(d, 5, 0.05, 0), d.energy_m, 1e-15);
  EXPECT_NEAR(device_error_m(d, 5, 1, 0), -d.energy_m, 1e-15);
  EXPECT_NEAR(device_error_m(d, 5, std::sqrt(0.05), 0), 0, 1e-15);
}

TEST(Noise, AColdDeviceErrsLessByAThirdEachHour) {
  SensorSettings s = exact();
  s.warm_up = true;
  const Device d = make_device(load_laser("lms200", 0), 0, s, 3);
  EXPECT_NE(d.warm_up_m, 0);
  EXPECT_LE(std::abs(d.warm_up_m), 0.010);
  EXPECT_EQ(device_error_m(d, 5, 0.5, 0), d.warm_up_m);
  EXPECT_NEAR(device_error_m(d, 5, 0.5, 3600), d.warm_up_m / M_E, 1e-15);
  EXPECT_LT(std::abs(device_error_m(d, 5, 0.5, 3 * 3600)), 0.05 * 0.010 + 1e-12);  // settled after three hours
}

TEST(Noise, CodesTellWhyThereIsNoRange) {
  const Device device = device_of("lms200");
  SensorSettings s = exact();
  EXPECT_EQ(share_of(Code::beyond, device_of("lms200", {"8m", ""}), {9, 0.9}, s), 1);
  EXPECT_EQ(share_of(Code::no_echo, device_of("generic"), {31, 0.9}, s), 1);  // it has no codes
  s.detection = true;
  EXPECT_EQ(share_of(Code::no_echo, device, {20, 0.03}, s), 1);
  // At 95 % of the threshold what is not noticed is heard, but too weak.
  const Target weak{10, 0.95 * device.model.least_reflectivity(10)};
  const double p = 1 - detection_chance(device.model, weak.reflectivity, 10, s.detection_spread);
  EXPECT_NEAR(share_of(Code::weak, device, weak, s), p, 5 * std::sqrt(p * (1 - p) / beams));
  EXPECT_EQ(share_of(Code::no_echo, device, weak, s), 0);
  const Target weaker{10, 0.84 * device.model.least_reflectivity(10)};  // below 85 % it is not even heard
  EXPECT_EQ(share_of(Code::weak, device, weaker, s), 0);
  s.drop_out = 1;
  EXPECT_NEAR(share_of(Code::overflow, device, weak, s), 0.5, 5 * 0.5 / std::sqrt(beams));
  EXPECT_NEAR(share_of(Code::channel, device, weak, s), 0.5, 5 * 0.5 / std::sqrt(beams));
}

TEST(Noise, ADirtyWindowSeesTheSameAsACleanOneOfABrighterTarget) {
  const Device device = device_of("lms200");
  SensorSettings clean = exact(), dirty = exact();
  clean.detection = dirty.detection = true;
  dirty.dirty_window = 1.55;
  const double least = device.model.least_reflectivity(9);
  EXPECT_EQ(sample(device, {9, 1.1 * least}, clean, 1).echoes,
            sample(device, {9, 1.55 * 1.1 * least}, dirty, 1).echoes);
}

TEST(Noise, DustLosesLightBothWaysByBeerAndLambert) {
  const Device device = device_of("lms200");
  SensorSettings clear = exact(), dusty = exact();
  clear.detection = dusty.detection = true;
  dusty.dust_loss_per_m = 0.05;
  const double least = device.model.least_reflectivity(9);
  EXPECT_EQ(sample(device, {9, 1.05 * least}, clear, 1).echoes,
            sample(device, {9, 1.05 * least * std::exp(2 * 0.05 * 9)}, dusty, 1).echoes);
}

TEST(Noise, FogOfAStatedVisibilityEndsSightWhereTheSheetsFogChartDoes) {
  // Of a visibility V, at which a contrast of 5 % is left, the loss is ln(20) / V = 3 / V a metre. The outdoor type's
  // chart: 20 % is lost at some 14 m where one sees 50 m, at some 20 m where one sees 100 m; read to a metre or so.
  const Device device = device_of("lms291");
  SensorSettings s = exact();
  s.detection = true;
  s.detection_spread = 1e-6;
  for (const auto& [visibility_m, lost_m] : {std::pair{50.0, 14.0}, {100.0, 20.0}}) {
    s.dust_loss_per_m = 3 / visibility_m;
    double seen_m = 2;
    while (std::isfinite(read_one(device, {seen_m, 0.2}, s, 1, 1).range_m)) seen_m += 0.1;
    EXPECT_NEAR(seen_m, lost_m, 1.2) << visibility_m;
  }
}

TEST(Noise, DustEchoesComeByTheLawOfRareEvents) {
  SensorSettings s = exact();
  s.dust_echo_per_m = 0.03;
  const Device ideal = device_of("ideal");
  double early = 0;
  for (std::uint64_t k = 0; k < beams; ++k) {
    const Reading r = read_one(ideal, {8, 0.5}, s, 1, k);
    EXPECT_EQ(r.fault == trouble::dust, r.range_m < 8);
    early += r.fault == trouble::dust;
  }
  const double p = 1 - std::exp(-0.03 * 8);
  EXPECT_NEAR(early / beams, p, 5 * std::sqrt(p * (1 - p) / beams));
}

TEST(Noise, CrosstalkComesInItsShareAnywhereInTheMode) {
  SensorSettings s = exact();
  s.crosstalk = 0.05;
  const Device device = device_of("lms200");
  double n = 0, sum = 0;
  for (std::uint64_t k = 0; k < beams; ++k) {
    const Reading r = read_one(device, {3, 0.5}, s, 1, k);
    if (r.fault != trouble::stray) continue;
    ++n;
    sum += r.range_m;
  }
  EXPECT_NEAR(n / beams, 0.05, 5 * std::sqrt(0.05 * 0.95 / beams));
  EXPECT_NEAR(sum / n, 32.759 / 2, 5 * 32.759 / std::sqrt(12 * n));
}

TEST(Noise, TheCounterStepsBeforeTheTelegramRounds) {
  SensorSettings s = exact();
  s.counter_mm = 10;
  EXPECT_EQ(read_one(device_of("lms200"), {3.004, 0.5}, s, 1, 1).range_m, 3.0F);
  EXPECT_EQ(read_one(device_of("lms200"), {3.006, 0.5}, s, 1, 1).range_m, 3.01F);
}

TEST(Noise, EveryEffectIsOffInAnExactLaser) {
  for (std::uint64_t k = 0; k < 1000; ++k) {
    const Reading r = read_one(make_device(load_laser("ideal", 0), 0, exact(), 5), {7.25, 0.01}, exact(), 1, k);
    EXPECT_NEAR(r.range_m, 7.25, 1e-6);  // a float, told in micrometres
    EXPECT_EQ(r.fault, 0);
    EXPECT_EQ(r.code, Code::range);
  }
}

// What a scan meets that has something of everything: near and far, bright and dark, slanting, nothing at all.
Axes any_axes(size_t n) {
  Axes axes;
  axes.resize(n);
  for (size_t k = 0; k < n; ++k) {
    const double u = uniform(1, Draw::test, k, 0), v = uniform(1, Draw::test, k, 1), w = uniform(1, Draw::test, k, 2);
    const bool nothing = k % 17 == 0;
    axes.range_m[k] = nothing ? std::numeric_limits<double>::infinity() : k % 13 == 0 ? 0.001 * u : 14 * u;
    axes.cosine[k] = v;
    axes.power[k] = nothing ? 0 : w * w * w * v;
  }
  return axes;
}

TEST(Noise, AScanOfAxesIsReadAsItsBeamsOneByOneBitForBit) {
  const Axes axes = any_axes(1111);
  const Draws draws(3, Draw::beam_chance);
  Chances chances;
  chances.resize(axes.size() + 5);
  draw_chances(draws, 17, axes.size(), Normals::both, chances, 5);
  SensorSettings plain, still = exact(), dusty;
  plain.drop_out = 0.05;
  dusty.dust_loss_per_m = 0.05, dusty.crosstalk = 0.05;
  for (const char* name : {"lms200", "lms291", "ideal"})
    for (const SensorSettings& s : {plain, still, dusty}) {
      Device device = device_of(name, name[0] == 'i' ? LaserChoice{} : LaserChoice{"8m", ""});
      device.bias_m = 0.004;
      Readings readings;
      read_axes(device, axes, s, chances, 5, {3, 17, 0}, 0, readings);
      ASSERT_EQ(readings.size(), axes.size());
      for (size_t k = 0; k < axes.size(); ++k) {
        Return one{axes.range_m[k], axes.power[k]};
        const Reading r = reading(device, {&one, 1}, axes.cosine[k], s, chances[5 + k], {3, 17, k}, 0);
        EXPECT_EQ(std::bit_cast<std::uint32_t>(readings.range_m[k]), std::bit_cast<std::uint32_t>(r.range_m)) << k;
        EXPECT_EQ(readings.code[k], r.code) << name << " " << k;
        EXPECT_EQ(readings.surfaces[k], r.surfaces) << name << " " << k;
        EXPECT_EQ(readings.fault[k], r.fault) << name << " " << k;
      }
    }
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
