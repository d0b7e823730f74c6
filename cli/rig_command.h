// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"
#include "cli/commands.h"
#include "eval/rig_picture.h"
#include "sensors/sensors.h"
#include "sim/vehicle.h"

#include <string>
#include <vector>

namespace adit {

/// A rig on its vehicle in a plain passage, and what it sees there without noise.
class RigPictures {
 public:
  RigPictures(const Rig& rig, const Vehicle& vehicle, SensorSettings settings);
  Picture from(RigView view) const;

 private:
  World world_;
  Rig rig_;
  Hull hull_;
  Pose X_WB_;
  std::vector<std::vector<Vec3>> ends_W_;
};

/// Pictures of a rig on its vehicle (--set vehicle=NAME) in a plain passage: DIR/corner.png, side.png, front.png,
/// above.png.
int rig_command(const std::string& rig, const Common& common, Console& console);

}  // namespace adit
