// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/h5.h"
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
  std::vector<double> stamp_s;        // (n) when the scan's first turn begins; beam k leaves beam_offset_s(k) later
  std::vector<float> range_m;         // (n x beams)
  std::vector<Code> code = {};        // (n x beams) or empty: +inf is no_echo, NaN unreadable
  std::vector<double> tilt_rad = {};  // (n) or empty: by how much the mount was tilted, as its drive says

  size_t size() const { return stamp_s.size(); }
  /// Where the laser is in B at a scan, as its mount says.
  Pose X_BS(const Mount& mount, size_t scan) const { return mount.X_BS_at(tilt_rad.empty() ? 0 : tilt_rad[scan]); }
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
  std::vector<std::int32_t> passage = {};   // or empty: id of the passage in which the face lies; -1 none
  std::vector<std::uint8_t> surfaces = {};  // or empty: how many the beam's spot falls on
  std::vector<std::uint8_t> fault = {};     // or empty: bits of `trouble`
  std::vector<double> tilt_rad = {};        // (n) or empty: how far the mount was truly tilted

  /// Where the laser truly was in B at a scan.
  Pose X_BS(const Mount& mount, size_t scan) const { return mount.X_BS_at(tilt_rad.empty() ? 0 : tilt_rad[scan]); }
};

/// What the evaluator holds an estimate against.
struct Truth {
  std::string world;  // world_hash
  Drive drive;
  Rig rig;  // true mounts
  std::vector<ScanTruth> scans;
};

/// What comes later in a recording, put behind what came before it; rigs stay as they are.
void append(Log& log, const Log& later);
void append(Truth& truth, const Truth& later);

/// Some scans of a laser, by their rising numbers.
Scans chosen(const Scans& scans, const std::vector<size_t>& numbers);

/// The scans of a log whose mounts were not tilted: their lasers stand as the rig says.
Log level_scans(const Log& log);

/// HDF5, as docs/files.md describes; the same bytes for the same recording. A truncated or foreign file is an Error.
void save_log(const std::string& file, const Log& log, Packing packing = Packing::small);
Log load_log(const std::string& file);
void save_truth(const std::string& file, const Truth& truth, Packing packing = Packing::small);
Truth load_truth(const std::string& file);
/// One file of files that follow each other in time, of one rig; one array of one of them is in memory at a time. The
/// bytes are those of the whole saved at once.
/// @pre at least one piece
void join_logs(const std::string& file, const std::vector<std::string>& pieces);
void join_truths(const std::string& file, const std::vector<std::string>& pieces);

}  // namespace adit
