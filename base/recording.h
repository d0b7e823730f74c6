// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/rig.h"

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace adit {

/// All scans of one laser, in the order of time. Ranges in metres: +inf = no echo, NaN = nothing readable (drop-out,
/// dazzle).
struct Scans {
  int beams = 0;
  std::vector<double> stamp_s;  // (n) when the scan's first turn begins; beam k leaves beam_offset_s(k) later
  std::vector<float> range_m;   // (n x beams)

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
