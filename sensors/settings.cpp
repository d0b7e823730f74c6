// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/settings.h"

#include "base/rig_text.h"

namespace adit {

Fields fields(SensorSettings& s) {
  return {
      {"rig", &s.rig, "lasers and their mounts: a bundled rig or a file"},
      {"mounts", &s.mounts, "changes to the rig: \"LASER key=value ...\" sets or adds, \"LASER off\" takes out"},
      {"mode", &s.mode, "range mode of every laser (8m, 16m, 32m, 80m); empty: as the rig says"},
      {"raster", &s.raster, "sector/step of every laser (180/1, 180/0.5, 100/0.25, ...); empty: as the rig says"},
      {"sensitivity", &s.sensitivity, "of every laser (low, medium, high of an outdoor LMS); empty: as the rig says"},
      {"baud", &s.baud, "rate of the serial links, Bd: sets how many scans are lost between two", 0, 1e9},
      {"noise", &s.noise, "random error of the ranges"},
      {"noise_scale", &s.noise_scale, "factor of that error: above 1 for worn devices", 0, 100},
      {"footprint", &s.footprint,
       "random error by the spot's smear over a slanting surface, where it is taken for its axis"},
      {"bias", &s.bias, "constant error of each device"},
      {"range_offset_m", &s.range_offset_m, "added to every range of every device, besides its own constant", -1, 1},
      {"detection", &s.detection, "no echo from what is too dark, far or slanting"},
      {"detection_spread", &s.detection_spread, "width of the detection threshold, in ln(reflectivity)", 1e-6, 10},
      {"beam_angle_deg", &s.beam_angle_deg, "sd of a beam's direction in the scan plane", 0, 5},
      {"drop_out", &s.drop_out, "share of beams that give nothing readable", 0, 1},
      {"late", &s.late, "share of scans before which the link loses one scan more", 0, 1},
      {"jitter_s", &s.jitter_s, "error of a logged stamp, evenly within plus and minus this", 0, 1},
      {"latency", &s.latency, "stamps tell when a scan has arrived over the link, not when it began"},
      {"mount_error_deg", &s.mount_error_deg, "sd of the true mounts about each axis", 0, 45},
      {"mount_error_m", &s.mount_error_m, "sd of the true mounts along each axis", 0, 1},
      {"sub_rays", &s.sub_rays, "rays in a beam's spot: 1 (its axis), 7, 19 or 37; above 1 edges give mixed pixels", 1,
       37},
      {"pulse_m", &s.pulse_m, "surfaces of one spot within this merge into one echo", 0, 100},
      {"range_curve", &s.range_curve, "error of each device that swings with the range"},
      {"energy", &s.energy, "error between dark and bright targets"},
      {"warm_up", &s.warm_up, "error of a device that is not yet warm"},
      {"on_s", &s.on_s, "how long the devices have been on when the drive begins", 0, 1e6},
      {"rounding", &s.rounding, "ranges in the telegram's steps; else in micrometres"},
      {"counter_mm", &s.counter_mm, "step of the device's counter, 10 on an LMS; 0 = none", 0, 1000},
      {"dirty_window", &s.dirty_window, "factor of the detection threshold; the sheet's dirty window is 1.55", 1, 100},
      {"dust_loss_per_m", &s.dust_loss_per_m, "light lost each way, 0.02 to 0.1 in stirred rock dust", 0, 10},
      {"dust_echo_per_m", &s.dust_echo_per_m, "chance that a particle is measured before the rock", 0, 10},
      {"dazzle_deg", &s.dazzle_deg, "beams within this of a portal are dazzled by daylight; 0 = none", 0, 180},
      {"crosstalk", &s.crosstalk, "share of beams that hear another laser at hand, 1e-4 to 1e-3; none at 6 m", 0, 1},
      {"water", &s.water, "faces labelled water are mirrors"},
      {"faults", &s.faults, "\"LASER dies|freezes|slips|loses|drifts|lags from_s=... [to_s=...] ...\""},
      {"reflectivity", &s.reflectivity, "of a world that states none, at 905 nm", 0, 100},
      {"hull_reflectivity", &s.hull_reflectivity, "of the vehicle and its pusher", 0, 100},
  };
}

Rig load_rig(const SensorSettings& s) {
  RigText rig = read_rig(s.rig);
  change_rig(rig, s.mounts);
  Rig got = rig_of(rig, s.baud, {s.mode, s.raster, s.sensitivity});
  constexpr double micrometre = 1e-6;  // the finest that a log holds
  if (!s.rounding)
    for (Mount& mount : got.mounts) mount.laser.resolution_m = micrometre;
  return got;
}

}  // namespace adit
