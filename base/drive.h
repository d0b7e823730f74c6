// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/route.h"
#include "base/trajectory.h"

#include <string>
#include <vector>

namespace adit {

/// How a drive ended: finished; its wheels do not get on; something stands in its way; over on its side or head; no floor under it; or it has not, being a stretch of a drive that goes on, or was killed.
enum class DriveEnd { finished, stuck, tipped, fell, blocked, underway };
std::string drive_end_name(DriveEnd end);

/// What a vehicle truly did.
struct Drive {
  Route route;      // planned; for a drive by commands the line that was driven
  Trajectory path;  // X_WB, dense enough to interpolate for the instant of each beam (120 Hz or more)
  DriveEnd end = DriveEnd::finished;
  std::string cause;    // one sentence, with place and time; empty when finished
  double driven_m = 0;  // of route.length_m
  std::vector<int> ground =
      {};  // (passages) what lies on the floor: 0 nothing, 1 track, 2 rubble; empty: nothing anywhere
};

/// What comes later of a drive, put behind what came before it.
void append(Drive& drive, const Drive& later);

}  // namespace adit
