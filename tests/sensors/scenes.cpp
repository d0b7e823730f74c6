// SPDX-License-Identifier: BSD-3-Clause
#include "tests/sensors/scenes.h"

#include <cmath>

namespace adit {

Drive drive_of(double duration_s, const std::function<Pose(double)>& X_WB) {
  Drive drive;
  for (int i = 0; i <= std::ceil(duration_s * 120); ++i) {
    drive.path.stamp_s.push_back(i / 120.0);
    drive.path.X_WB.push_back(X_WB(i / 120.0));
  }
  return drive;
}

Rig one_laser(const std::string& model, const Pose& X_BS) {
  return {.name = "one", .mounts = {{.name = "laser", .laser = load_laser(model, 500000), .X_BS = X_BS}}};
}

SensorSettings exact() {
  SensorSettings s;
  s.noise = s.footprint = s.bias = s.detection = false;
  s.beam_angle_deg = s.drop_out = s.late = s.jitter_s = 0;
  return s;
}

}  // namespace adit
