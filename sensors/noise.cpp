// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/noise.h"

#include "sensors/sick.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double degree = std::numbers::pi / 180;

}  // namespace

std::uint64_t scan_address(size_t mount, size_t scan) {
  return (std::uint64_t{mount} << 40) | scan;
}

namespace {

// Draws that few scenarios need; each has a column of its own.
double stray(const BeamAddress& at, std::uint64_t column) {
  return uniform(at.seed, Draw::beam_stray, at.scan, 8 * at.beam + column);
}

Reading nothing(Code code, std::uint8_t fault = 0) {
  const bool silent = code == Code::no_echo || code == Code::weak || code == Code::beyond;
  return {silent ? std::numeric_limits<float>::infinity() : std::numeric_limits<float>::quiet_NaN(), code, 0, fault};
}

// A device that has codes for it says what went wrong.
Code failure(const Device& device, const BeamAddress& at) {
  if (!device.model.codes) return Code::unreadable;
  return stray(at, 0) < 0.5 ? Code::overflow : Code::channel;
}

// The false range of another laser's pulse lies anywhere in the mode.
Reading told(const Device& device, double range_m, int surfaces, std::uint8_t fault) {
  const float said = reported_range_m(device.model, range_m);
  const Code code = std::isinf(said)   ? (device.model.codes ? Code::beyond : Code::no_echo)
                    : std::isnan(said) ? (device.model.codes ? Code::overflow : Code::unreadable)
                                       : Code::range;
  return {said, code, static_cast<std::uint8_t>(std::min(surfaces, 255)), fault};
}

// A particle before what the beam would meet, by the law of rare events along the way. Negative: none.
double dust_range_m(const SensorSettings& s, double rock_m, const BeamAddress& at) {
  if (s.dust_echo_per_m <= 0) return -1;
  const double range_m = -std::log(1 - stray(at, 1)) / s.dust_echo_per_m;
  return range_m < rock_m ? range_m : -1;
}

// Sd of one range: the sheet's, and what the spot adds by merged surfaces or by its smear.
double sigma_m(const Device& device, const Echo& echo, size_t rays, double cosine, const SensorSettings& s) {
  constexpr double of_spread = 0.1;  // merged surfaces are told less surely
  const double own_m2 = s.noise ? range_variance_m2(device.model, 1 / echo.margin) : 0;
  const double merged_m = s.noise && rays > 1 ? of_spread * echo.spread_m : 0;
  const double smeared_m2 = rays == 1 && s.footprint ? footprint_variance_m2(device.model, echo.range_m, cosine) : 0;
  return std::sqrt(own_m2 + merged_m * merged_m + smeared_m2);
}

}  // namespace

Reading reading(const Device& device, std::span<Return> returns, double cosine, const SensorSettings& settings,
                const Chance& chance, const BeamAddress& at, double on_s) {
  if (chance.drop < settings.drop_out) return nothing(failure(device, at), trouble::dropped);
  if (settings.crosstalk > 0 && stray(at, 2) < settings.crosstalk)
    return told(device, stray(at, 3) * device.model.range_max_m, 0, trouble::stray);
  double nearest_m = std::numeric_limits<double>::infinity();
  for (Return& r : returns) {
    nearest_m = std::min(nearest_m, r.range_m);
    if (settings.dust_loss_per_m > 0) r.power *= std::exp(-2 * settings.dust_loss_per_m * r.range_m);
  }
  const double dust_m = dust_range_m(settings, nearest_m, at);
  if (dust_m > 0) return told(device, dust_m + device.bias_m, 0, trouble::dust);
  const Threshold threshold{&device.model, !settings.detection, settings.detection_spread, settings.dirty_window,
                            chance.detect};
  const Echo echo =
      returns.size() == 1 ? echo_of_one(returns[0], threshold) : first_echo(returns, threshold, settings.pulse_m);
  // Between the threshold of the stop and that of the peak an echo is heard but not measured.
  if (!echo.noticed) return nothing(device.model.codes && echo.margin > 0.85 ? Code::weak : Code::no_echo);
  double range_m = stepped_m(echo.range_m, settings.counter_mm * 1e-3) +
                   device_error_m(device, echo.range_m, echo.effective_reflectivity, on_s);
  if (chance.range != 0)
    range_m += settings.noise_scale * sigma_m(device, echo, returns.size(), cosine, settings) * chance.range;
  return told(device, range_m, echo.surfaces, echo.spread_m > 0.05 ? trouble::mixed : 0);
}

namespace {

// What a few axes meet and their chance, side by side: plain loops over them that the compiler turns into vectors.
struct Some {
  static constexpr size_t most = 64;
  size_t n;
  const double *range_m, *power, *cosine, *normal, *drop;  // (n)
};

// As Threshold::margin.
void margins(const Some& some, const LaserModel& model, double dirty_window, double* margin) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  if (model.chart_range_m.empty() && model.reflectivity_at_4m == 0) {
    std::fill_n(margin, some.n, infinity);
    return;
  }
  double least[Some::most];
  for (size_t k = 0; k < some.n; ++k) least[k] = dirty_window * model.least_reflectivity(some.range_m[k]);
  for (size_t k = 0; k < some.n; ++k) {
    const double over = some.power[k] / least[k];
    margin[k] = least[k] > 0 ? over : infinity;
  }
}

// What is told of those that are noticed whatever the chance, in the mode's range; NaN of others.
void tell_ordinary(const Some& some, const Device& device, const SensorSettings& s, const double* margin,
                   double* told_m) {
  const LaserModel& m = device.model;
  const double scale = s.noise_scale, own = s.noise ? 1 : 0, smear = s.footprint ? 1 : 0, bias_m = device.bias_m;
  const double range_max_m = m.range_max_m, drop_out = s.drop_out;
  const double sure = s.detection ? std::exp(25 * s.detection_spread) : 0;  // Threshold::passes has it from 24 on
  double told[Some::most];  // of its own, so that nothing else can change meanwhile
  for (size_t k = 0; k < some.n; ++k) {
    const double variance_m2 =
        own * range_variance_m2(m, 1 / margin[k]) + smear * footprint_variance_m2(m, some.range_m[k], some.cosine[k]);
    const double range_m = some.range_m[k] + bias_m + scale * std::sqrt(variance_m2) * some.normal[k];
    const double stepped = stepped_m(range_m, m.resolution_m);
    const bool ordinary = (some.drop[k] >= drop_out) & (some.power[k] > 0) & (margin[k] > sure) &
                          (range_m <= range_max_m) & (stepped > 0);
    told[k] = ordinary ? stepped : std::numeric_limits<double>::quiet_NaN();
  }
  std::copy_n(told, some.n, told_m);
}

}  // namespace

void read_axes(const Device& device, const Axes& axes, const SensorSettings& s, const Chances& chances, size_t at,
               const BeamAddress& first, double on_s, Readings& readings) {
  readings.resize(axes.size());
  const bool plain = s.crosstalk <= 0 && s.dust_loss_per_m <= 0 && s.dust_echo_per_m <= 0 && s.counter_mm <= 0 &&
                     !device.varies && std::isfinite(device.model.range_max_m);
  double margin[Some::most], told_m[Some::most];
  std::fill_n(told_m, Some::most, std::numeric_limits<double>::quiet_NaN());
  for (size_t begin = 0; begin < axes.size(); begin += Some::most) {
    const Some some{std::min(Some::most, axes.size() - begin),
                    &axes.range_m[begin],
                    &axes.power[begin],
                    &axes.cosine[begin],
                    &chances.range[at + begin],
                    &chances.drop[at + begin]};
    if (plain) {
      margins(some, device.model, s.dirty_window, margin);
      tell_ordinary(some, device, s, margin, told_m);
    }
    for (size_t k = 0; k < some.n; ++k) readings.range_m[begin + k] = static_cast<float>(told_m[k]);
    std::fill_n(&readings.code[begin], some.n, Code::range);
    std::fill_n(&readings.surfaces[begin], some.n, std::uint8_t{1});
    std::fill_n(&readings.fault[begin], some.n, std::uint8_t{0});
    for (size_t k = 0; k < some.n; ++k) {
      if (told_m[k] > 0) continue;
      const size_t beam = begin + k;
      Return met{axes.range_m[beam], axes.power[beam]};
      readings.put(beam, reading(device, {&met, 1}, axes.cosine[beam], s, chances[at + beam],
                                 {first.seed, first.scan, first.beam + beam}, on_s));
    }
  }
}

Rig true_rig(const Rig& nominal, const SensorSettings& settings, std::uint64_t seed) {
  Rig rig = nominal;
  for (size_t i = 0; i < rig.mounts.size(); ++i) {
    const auto draw = [&](std::uint64_t axis) { return normal(seed, Draw::mount_error, i, axis); };
    const double sd_rad = settings.mount_error_deg * degree, sd_m = settings.mount_error_m;
    if (sd_rad > 0 || sd_m > 0)
      rig.mounts[i].X_BS = rig.mounts[i].X_BS * pose_of(sd_m * Vec3(draw(0), draw(1), draw(2)), sd_rad * draw(3),
                                                        sd_rad * draw(4), sd_rad * draw(5));
    rig.mounts[i].phase_s = uniform(seed, Draw::laser_phase, i) * rig.mounts[i].laser.interval_s;
  }
  return rig;
}

}  // namespace adit
