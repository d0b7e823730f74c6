// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/rig.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace adit {

/// What a device tells of one beam. Files hold all but `range` as its negative.
enum class Code : std::uint8_t {
  range = 0,
  no_echo = 1,     // no stop pulse
  unreadable = 2,  // for no stated reason
  weak = 3,        // an echo just below what can be measured
  beyond = 4,      // a range beyond the mode's
  dazzled = 5,
  overflow = 6,  // pulse too short
  channel = 7,   // read error of the device
};

/// What went wrong with one beam, as bits that may stand together.
namespace trouble {
constexpr std::uint8_t frozen = 1;   // the scan before the fault, told again
constexpr std::uint8_t slipped = 2;  // the mount is no longer where the truth's rig says
constexpr std::uint8_t clock = 4;    // the stamp drifts or lags
constexpr std::uint8_t stray = 8;    // another laser's pulse
constexpr std::uint8_t dust = 16;    // a particle before the rock
constexpr std::uint8_t ghost = 32;   // seen in a mirror of water
constexpr std::uint8_t mixed = 64;   // the range lies between two surfaces
constexpr std::uint8_t dropped = 128;
}  // namespace trouble

/// All scans of one laser, in the order of time. Ranges in metres: +inf = no echo, NaN = nothing readable (drop-out,
/// dazzle).
struct Scans {
  int beams = 0;
  std::vector<double> stamp_s;  // (n) when the scan's first turn begins; beam k leaves beam_offset_s(k) later
  std::vector<float> range_m;   // (n x beams)
  std::vector<Code> code = {};  // (n x beams) or empty: +inf is no_echo, NaN unreadable

  size_t size() const { return stamp_s.size(); }
  std::span<const float> operator[](size_t i) const { return {range_m.data() + i * beams, static_cast<size_t>(beams)}; }
};

/// What a mapper is given: nothing here knows the truth.
struct Log {
  Rig rig;                   // nominal mounts
  std::vector<Scans> scans;  // (rig.mounts)
};

/// What each beam of one laser truly met. Arrays are (n x beams), as in Scans.
struct ScanTruth {
  std::vector<double> stamp_s;       // (n) when the scan's first turn truly began; beam k leaves beam_offset_s(k) later
  std::vector<float> range_m;        // exact, along the true beam; +inf where nothing is met
  std::vector<std::uint8_t> label;   // Label
  std::vector<std::int32_t> part;    // of the face met
  std::vector<float> incidence_rad;  // between beam and surface normal, 0..pi/2
  std::vector<std::int32_t> face;    // index in the world's mesh, -1: the vehicle or nothing
  std::vector<std::uint8_t> surfaces = {};  // or empty: how many the beam's spot falls on
  std::vector<std::uint8_t> fault = {};     // or empty: bits of `trouble`
};

/// What the evaluator holds an estimate against.
struct Truth {
  std::string world;  // world_hash
  Drive drive;
  Rig rig;  // true mounts
  std::vector<ScanTruth> scans;
};

/// HDF5, as docs/files.md describes; the same bytes for the same recording. A truncated or foreign file is an Error.
void save_log(const std::string& file, const Log& log);
Log load_log(const std::string& file);
void save_truth(const std::string& file, const Truth& truth);
Truth load_truth(const std::string& file);

}  // namespace adit
