// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/rig.h"

#include <string>
#include <vector>

namespace adit {

/// What stands between a vehicle's true path and its recording. Each effect can be switched on alone.
struct SensorSettings {
  std::string rig = "cart4";
  std::vector<std::string> mounts;  // changes to the rig: "LASER key=value ...", see base/rig_text.h
  std::string mode, raster;         // of every laser; empty: as the rig says
  std::string sensitivity;          // the same
  int baud = 38400;
  bool noise = true;                // of a range: the sheet's sd, growing near the detection threshold
  double noise_scale = 1;           // of a worn device: factor of that sd
  bool footprint = true;            // more of it where the spot is smeared over a slanting surface
  bool bias = true;                 // a constant of each device
  double range_offset_m = 0;        // of every device, besides
  bool detection = true;            // dark, far and slanting targets give no echo
  double detection_spread = 0.1;    // width of the threshold in ln(reflectivity)
  double beam_angle_deg = 0.05;     // sd of a beam's direction in the scan plane
  double drop_out = 0.001;          // share of beams that give nothing readable
  double late = 0.05;               // share of scans before which the link loses one scan more
  double jitter_s = 0.001;          // error of a logged stamp, evenly within plus and minus this
  bool latency = false;             // stamps tell when a scan has arrived, not when it began
  double mount_error_deg = 0;       // sd about each axis of the true mount against the nominal one
  double mount_error_m = 0;         // and along each axis
  int sub_rays = 1;                 // rays in a beam's spot: 1 = its axis alone, 7, 19 or 37
  double pulse_m = 1.5;             // surfaces of one spot within this merge into one echo
  bool range_curve = false;         // error of each device that swings with the range
  bool energy = false;              // error between dark and bright targets
  bool warm_up = false;             // error of a device that is not yet warm
  double on_s = 0;                  // how long the devices have been on when the drive begins
  bool rounding = true;             // to the steps of the telegram; else to micrometres
  double counter_mm = 0;            // step of the device's counter before the telegram's rounding; 0 = none
  double dirty_window = 1;          // factor of the detection threshold; the sheet's dirty window is 1.55
  double dust_loss_per_m = 0;       // light lost on the way, each way
  double dust_echo_per_m = 0;       // chance that a particle is measured instead
  double dazzle_deg = 0;            // beams within this of a portal's daylight are dazzled; 0 = none
  double crosstalk = 0;             // share of beams that hear another laser of the rig
  bool water = true;                // faces labelled water are mirrors
  std::vector<std::string> faults;  // "LASER KIND key=value ...", see faults.h
  double reflectivity = 0.45;       // of a world that states none: rock-dusted
  double hull_reflectivity = 0.3;   // of the vehicle and of the person who pushes
};

Fields fields(SensorSettings& settings);

/// The rig that the settings name, with their changes, at their rate, mode and raster; the errors of base/rig_text.h.
Rig load_rig(const SensorSettings& settings);

}  // namespace adit
