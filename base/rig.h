// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/laser.h"

#include <string>
#include <vector>

namespace adit {

/// A mount that nods about S's y axis, evenly there and back, and waits for each scan.
struct Tilt {
  double from_rad = 0, to_rad = 0;  // positive looks down
  double period_s = 0;              // there and back; 0: it does not nod
  bool standing_only = true;        // level while the vehicle drives

  bool nods() const { return period_s > 0; }
  /// It begins level, goes to to_rad, to from_rad and is level again after a period.
  double at(double since_s) const;
};

/// One laser on a vehicle.
struct Mount {
  std::string name;  // unique in the rig
  LaserModel laser;
  Pose X_BS = Pose::Identity();
  double phase_s = 0;  // of its first scan after the recording's start: lasers are not synchronised
  Tilt tilt = {};

  /// Where the laser is in B while its mount is tilted.
  Pose X_BS_at(double tilt_rad) const;
};

/// The lasers of a vehicle. In a log: as a mapper is told; in a truth: as they truly are.
struct Rig {
  std::string name;
  std::vector<Mount> mounts;
};

/// What a laser looks at, by its scan plane in B.
enum class View { horizontal, forward_vertical, up, down, other };
View view_of(const Mount& mount);
/// Index of the first mount with that view, or -1.
int find_view(const Rig& rig, View view);

/// A bundled rig by name, or one from a TOML file: tables [[laser]] with name, model, position_m, yaw_deg, pitch_deg,
/// roll_deg, mode, raster, sensitivity, tilt_deg, tilt_s, tilt_when; what `choice` names holds for all lasers instead.
Rig load_rig(const std::string& name_or_file, int baud, const LaserChoice& choice = {});

}  // namespace adit
