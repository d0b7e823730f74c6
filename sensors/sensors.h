// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/hull.h"
#include "base/recording.h"
#include "base/rig.h"
#include "base/world.h"
#include "sensors/settings.h"

#include <cstdint>
#include <functional>
#include <memory>

namespace adit {

/// What the lasers told, and what was so.
struct Recording {
  Log log;
  Truth truth;
};

/// What comes later, put behind what came before it.
void append(Recording& recording, const Recording& later);

/// Records what the lasers of a rig see along a drive, while it is driven.
/// Scans run from the path's begin to its end, every laser with a phase of its own. Beam k of a scan leaves
/// beam_offset_s(k) after the scan begins, from where the laser truly is at that instant. The same seed gives the same
/// recording on any number of threads, in whatever stretches the drive comes.
class Recorder {
 public:
  using Take = std::function<void(Recording&&)>;

  /// @param world    its mesh is closed, normals into the rock; labels, parts and reflectivities as far as it has them
  /// @param nominal  the rig as the mapper is told; the true mounts differ by the settings' mount errors
  /// @param hull     boxes fixed in B that stand in the rays; a box around a laser's mirror is its housing and is ignored
  /// @param piece_s  of the drive's time between pieces, which follow each other; memory holds one and its path
  /// @param take     is given each piece when the path has passed it: log with ranges in m, +inf no echo, NaN unreadable;
  ///                 truth with its part of the path, the true mounts, what each beam met
  /// World, hull and settings must outlive this. Errors: settings that do not fit the rig.
  Recorder(const World& world, const Rig& nominal, const Hull& hull, const SensorSettings& settings, std::uint64_t seed,
           double piece_s, Take take);
  ~Recorder();

  /// The stretch of the drive that follows; the last is the one that is no longer under way. Errors: a laser that starts
  /// inside the rock; at the end a drive that is shorter than a scan.
  void add(const Drive& stretch);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The whole of a drive at once.
Recording record(const World& world, const Drive& drive, const Rig& nominal, const Hull& hull,
                 const SensorSettings& settings, std::uint64_t seed);

}  // namespace adit
