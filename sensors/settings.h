// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"

#include <string>

namespace adit {

/// What stands between a vehicle's true path and its recording. Each effect can be switched on alone.
struct SensorSettings {
  std::string rig = "cart4";
  int baud = 38400;
  bool noise = true;               // of a range: the sheet's sd, growing near the detection threshold
  bool footprint = true;           // more of it where the spot is smeared over a slanting surface
  bool bias = true;                // a constant of each device
  bool detection = true;           // dark, far and slanting targets give no echo
  double detection_spread = 0.1;   // width of the threshold in ln(reflectivity)
  double beam_angle_deg = 0.05;    // sd of a beam's direction in the scan plane
  double drop_out = 0.001;         // share of beams that give nothing readable
  double late = 0.05;              // share of scans before which the link loses one scan more
  double jitter_s = 0.001;         // error of a logged stamp, evenly within plus and minus this
  double mount_error_deg = 0;      // sd about each axis of the true mount against the nominal one
  double mount_error_m = 0;        // and along each axis
  double reflectivity = 0.45;      // of a world that states none: rock-dusted
  double hull_reflectivity = 0.3;  // of the vehicle and of the person who pushes
};

Fields fields(SensorSettings& settings);

}  // namespace adit
