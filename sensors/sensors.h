// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/hull.h"
#include "base/progress.h"
#include "base/recording.h"
#include "base/rig.h"
#include "base/world.h"
#include "sensors/settings.h"

#include <cstdint>
#include <functional>

namespace adit {

/// What the lasers told, and what was so.
struct Recording {
  Log log;
  Truth truth;
};

/// Records what the lasers of a rig see along a drive.
/// @param world    its mesh is closed, normals into the rock; labels, parts and reflectivities as far as it has them
/// @param drive    path X_WB that covers the recording; at least one scan long, else Error
/// @param nominal  the rig as the mapper is told; the true mounts differ by the settings' mount errors
/// @param hull     boxes fixed in B that stand in the rays; a box around a laser's mirror is its housing and is ignored
/// @return         log: ranges in m, +inf no echo, NaN unreadable; truth: path, true mounts, what each beam met
/// Scans run from the path's begin to its end, every laser with a phase of its own. Beam k of a scan leaves
/// beam_offset_s(k) after the scan begins, from where the laser truly is at that instant. The same seed gives the same
/// recording on any number of threads. A laser that starts inside the rock is an Error.
Recording record(const World& world, const Drive& drive, const Rig& nominal, const Hull& hull,
                 const SensorSettings& settings, std::uint64_t seed, const Progress& progress = {});

/// The same in pieces of piece_s that follow each other: `take` is given each as soon as it is measured, a recording of
/// its own of which only path and scans are cut. Memory holds the drive's path, the scans' stamps and one piece.
void record(const World& world, const Drive& drive, const Rig& nominal, const Hull& hull,
            const SensorSettings& settings, std::uint64_t seed, double piece_s,
            const std::function<void(Recording&&)>& take, const Progress& progress = {});

}  // namespace adit
