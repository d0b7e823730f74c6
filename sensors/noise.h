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
#include <vector>

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

/// What the beams of a scan meet whose spots are taken for their axes, by its numbers. (beams)
struct Axes {
  std::vector<double> range_m;  // +inf: nothing
  std::vector<double> power;    // reflectivity * cosine
  std::vector<double> cosine;   // of the incidence

  void resize(size_t n) { range_m.resize(n), power.resize(n), cosine.resize(n); }
  size_t size() const { return range_m.size(); }
};

/// Readings by their numbers. (beams)
struct Readings {
  std::vector<float> range_m;
  std::vector<Code> code;
  std::vector<std::uint8_t> surfaces, fault;

  void resize(size_t n) { range_m.resize(n), code.resize(n), surfaces.resize(n), fault.resize(n); }
  size_t size() const { return range_m.size(); }
  void put(size_t k, const Reading& r) {
    range_m[k] = r.range_m, code[k] = r.code, surfaces[k] = r.surfaces, fault[k] = r.fault;
  }
};

/// The readings of such a scan, each as reading() has it.
/// @param chances  of its beams from place `at` on
/// @param first    of its beam 0
void read_axes(const Device& device, const Axes& axes, const SensorSettings& settings, const Chances& chances,
               size_t at, const BeamAddress& first, double on_s, Readings& readings);

/// The rig as it truly is: mounts moved in their own frames by the settings' errors, each laser with a phase of its
/// own.
Rig true_rig(const Rig& nominal, const SensorSettings& settings, std::uint64_t seed);

}  // namespace adit
