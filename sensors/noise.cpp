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

double counted(double range_m, const SensorSettings& s) {
  const double step_m = s.counter_mm * 1e-3;
  return step_m > 0 ? std::floor(range_m / step_m + 0.5) * step_m : range_m;
}

// Sd of one range: the sheet's, and what the spot adds.
double sigma_m(const Device& device, const Echo& echo, size_t rays, double cosine, const SensorSettings& s) {
  constexpr double of_spread = 0.1;  // merged surfaces are told less surely
  const double merged_m = rays > 1 ? of_spread * echo.spread_m : 0;
  const double smeared_m2 = rays == 1 && s.footprint ? footprint_variance_m2(device.model, echo.range_m, cosine) : 0;
  return std::sqrt(range_variance_m2(device.model, 1 / echo.margin) + merged_m * merged_m + smeared_m2);
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
  double range_m =
      counted(echo.range_m, settings) + device_error_m(device, echo.range_m, echo.effective_reflectivity, on_s);
  if (settings.noise && chance.range != 0)
    range_m += settings.noise_scale * sigma_m(device, echo, returns.size(), cosine, settings) * chance.range;
  return told(device, range_m, echo.surfaces, echo.spread_m > 0.05 ? trouble::mixed : 0);
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
