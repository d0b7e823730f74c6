// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"
#include "base/rig.h"
#include "sensors/chance.h"
#include "sensors/device.h"
#include "sensors/echo.h"
#include "sensors/settings.h"

#include <cstdint>
#include <span>

namespace adit {

/// Where the chance of one beam is drawn.
struct BeamAddress {
  std::uint64_t seed;
  std::uint64_t scan;  // of all scans of all lasers, see scan_address
  std::uint64_t beam;
};
std::uint64_t scan_address(size_t mount, size_t scan);

/// What a device tells of one beam.
struct Reading {
  float range_m;  // +inf: no echo, NaN: unreadable
  Code code = Code::range;
  std::uint8_t surfaces = 0;  // that the spot fell on
  std::uint8_t fault = 0;     // bits of `trouble`
};

/// @param returns        of the beam's spot, one where it is taken for its axis; reordered
/// @param cosine         of the axis' incidence, for the smear of a spot that is taken for its axis
/// @param on_s           since the device was switched on
Reading reading(const Device& device, std::span<Return> returns, double cosine, const SensorSettings& settings,
                const Chance& chance, const BeamAddress& address, double on_s);

/// The rig as it truly is: mounts moved in their own frames by the settings' errors, each laser with a phase of its
/// own.
Rig true_rig(const Rig& nominal, const SensorSettings& settings, std::uint64_t seed);

}  // namespace adit
