// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/device.h"

#include "base/rng.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

// In [-1, 1).
double even(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j) {
  return 2 * uniform(seed, draw, i, j) - 1;
}

}  // namespace

Device make_device(const LaserModel& model, size_t mount, const SensorSettings& settings, std::uint64_t seed) {
  Device device{.model = model};
  if (settings.bias) device.bias_m = model.bias_m * even(seed, Draw::laser_device, mount, 0);
  device.bias_m += settings.range_offset_m;
  if (settings.energy) device.energy_m = model.energy_m * even(seed, Draw::laser_device, mount, 1);
  if (settings.warm_up) device.warm_up_m = model.warm_up_m * even(seed, Draw::laser_warm_up, mount, 0);
  if (settings.range_curve)
    for (std::uint64_t n = 0; n < device.curve.size(); ++n) {
      const auto draw = [&](std::uint64_t j) { return uniform(seed, Draw::laser_curve, mount, 4 * n + j); };
      const double period_m = 1 + 3 * draw(0);
      device.curve[n] = {model.curve_m / 3 * draw(1), 2 * std::numbers::pi / period_m, 2 * std::numbers::pi * draw(2)};
    }
  device.varies = settings.energy || settings.warm_up || settings.range_curve;
  return device;
}

double varying_error_m(const Device& device, double range_m, double effective_reflectivity, double on_s) {
  double error_m = 0;
  for (const Device::Swing& s : device.curve)
    if (s.amplitude_m > 0) error_m += s.amplitude_m * std::sin(s.per_m * range_m + s.phase_rad);
  if (device.energy_m != 0) {
    // Even in the logarithm, from 5 % to 100 %.
    const double bright = std::log(std::max(effective_reflectivity, 1e-9) / 0.05) / std::log(20.0);
    error_m += device.energy_m * (1 - 2 * std::clamp(bright, 0.0, 1.0));
  }
  if (device.warm_up_m != 0) error_m += device.warm_up_m * std::exp(-on_s / device.model.warm_up_s);
  return error_m;
}

}  // namespace adit
