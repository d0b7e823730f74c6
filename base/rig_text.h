// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/rig.h"

#include <string>
#include <vector>

namespace adit {

/// One [[laser]] of a rig as people write it: where it sits in degrees, what it is by its model's name.
struct MountText {
  std::string name, model = "lms200", mode, raster, sensitivity;
  std::vector<double> position_m{0, 0, 0};
  double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
  std::vector<double> tilt_deg;
  double tilt_s = 10;
  std::string tilt_when = "standing";
};
Fields fields(MountText& mount);

/// A rig's file.
struct RigText {
  std::string name;
  std::vector<MountText> lasers;
};

/// A bundled rig by name, or a TOML file; errors name file, line and key.
RigText read_rig(const std::string& name_or_file);

/// Changes a rig, one after the other: "LASER key=value ..." sets keys of a laser (x_m, y_m, z_m beside those of the
/// file) and adds it at the end where there is none of that name; "LASER off" takes it out. Errors name the change.
void change_rig(RigText& rig, const std::vector<std::string>& changes);

/// The rig that it describes. Error where it has no laser.
Rig rig_of(const RigText& text, int baud, const LaserChoice& choice = {});

/// The file's text; read_rig gives the same rig again.
std::string to_toml(const RigText& rig);

}  // namespace adit
