// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/laser.h"
#include "sensors/settings.h"

#include <array>
#include <cstdint>

namespace adit {

/// One physical laser: what its sheet states, and the errors that chance gave to this one.
struct Device {
  struct Swing {
    double amplitude_m = 0, per_m = 0, phase_rad = 0;
  };

  LaserModel model;
  double bias_m = 0;                // constant
  std::array<Swing, 3> curve = {};  // swings with the range
  double energy_m = 0;              // of dark targets; bright ones err the other way
  bool varies = false;              // with range, target or time
  double warm_up_m = 0;             // when switched on, fading by model.warm_up_s
};

/// The device at a mount: each error evenly within the model's band, 0 when switched off.
Device make_device(const LaserModel& model, size_t mount, const SensorSettings& settings, std::uint64_t seed);

/// What of it is not the bias.
double varying_error_m(const Device& device, double range_m, double effective_reflectivity, double on_s);
/// Its systematic error at a range, for a target's effective reflectivity, `on_s` after it was switched on.
inline double device_error_m(const Device& device, double range_m, double effective_reflectivity, double on_s) {
  return device.varies ? device.bias_m + varying_error_m(device, range_m, effective_reflectivity, on_s) : device.bias_m;
}

}  // namespace adit
