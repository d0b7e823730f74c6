// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/laser.h"
#include "base/rig.h"
#include "sensors/beam.h"
#include "sensors/settings.h"

#include <cstdint>

namespace adit {

/// Where the chance of one beam is drawn.
struct BeamAddress {
  std::uint64_t seed;
  std::uint64_t scan;  // of all scans of all lasers, see scan_address
  std::uint64_t beam;
};
std::uint64_t scan_address(size_t mount, size_t scan);

/// The range that a device tells of what its beam met. +inf = no echo, NaN = unreadable.
float reading(const LaserModel& model, const Meeting& meeting, double bias_m, const SensorSettings& settings,
              const BeamAddress& address);

/// Constant error of the device at a mount, metres, evenly within the model's band; 0 when switched off.
double device_bias_m(const LaserModel& model, size_t mount, const SensorSettings& settings, std::uint64_t seed);

/// How far a beam's direction errs within the scan plane.
double beam_angle_error_rad(const SensorSettings& settings, const BeamAddress& address);

/// The rig as it truly is: mounts moved in their own frames by the settings' errors, each laser with a phase of its
/// own.
Rig true_rig(const Rig& nominal, const SensorSettings& settings, std::uint64_t seed);

}  // namespace adit
