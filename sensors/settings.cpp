// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/settings.h"

namespace adit {

Fields fields(SensorSettings& s) {
  return {
      {"rig", &s.rig, "lasers and their mounts: a bundled rig or a file"},
      {"baud", &s.baud, "rate of the serial links, Bd: sets how many scans are lost between two", 0, 1e9},
      {"noise", &s.noise, "random error of the ranges"},
      {"footprint", &s.footprint, "more of it on slanting surfaces; needs noise"},
      {"bias", &s.bias, "constant error of each device"},
      {"detection", &s.detection, "no echo from what is too dark, far or slanting"},
      {"detection_spread", &s.detection_spread, "width of the detection threshold, in ln(reflectivity)", 1e-6, 10},
      {"beam_angle_deg", &s.beam_angle_deg, "sd of a beam's direction in the scan plane", 0, 5},
      {"drop_out", &s.drop_out, "share of beams that give nothing readable", 0, 1},
      {"late", &s.late, "share of scans before which the link loses one scan more", 0, 1},
      {"jitter_s", &s.jitter_s, "error of a logged stamp, evenly within plus and minus this", 0, 1},
      {"mount_error_deg", &s.mount_error_deg, "sd of the true mounts about each axis", 0, 45},
      {"mount_error_m", &s.mount_error_m, "sd of the true mounts along each axis", 0, 1},
      {"reflectivity", &s.reflectivity, "of a world that states none, at 905 nm", 0, 100},
      {"hull_reflectivity", &s.hull_reflectivity, "of the vehicle and its pusher", 0, 100},
  };
}

}  // namespace adit
