// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "sim/sim.h"
#include "sim/watch.h"

namespace adit {

void check(const DriveSettings& settings) {
  if (settings.step_hz % settings.sample_hz != 0)
    throw Error(say("drive.sample_hz = %d must divide drive.step_hz = %d", settings.sample_hz, settings.step_hz));
  if (settings.stop_gap_min_m > settings.stop_gap_max_m)
    throw Error("drive.stop_gap_min_m must not exceed stop_gap_max_m");
  if (settings.stop_min_s > settings.stop_max_s) throw Error("drive.stop_min_s must not exceed stop_max_s");
  if (settings.track_share + settings.rubble_share > 1)
    throw Error(say("drive.track_share = %g and drive.rubble_share = %g: their sum must not be above 1",
                    settings.track_share, settings.rubble_share));
  if (settings.wobble_min_hz > settings.wobble_max_hz) throw Error("drive.wobble_min_hz must not exceed wobble_max_hz");
}

Fields fields(DriveSettings& s) {
  return {{"speed_mps", &s.speed_mps, "mean walking speed", 0.05, 3},
          {"speed_sd_mps", &s.speed_sd_mps, "spread of the walking speed over the way", 0, 1},
          {"stop_gap_min_m", &s.stop_gap_min_m, "least way between two stops", 1, 1e6},
          {"stop_gap_max_m", &s.stop_gap_max_m, "greatest way between two stops", 1, 1e6},
          {"stop_min_s", &s.stop_min_s, "shortest stop", 0, 3600},
          {"stop_max_s", &s.stop_max_s, "longest stop", 0, 3600},
          {"lead_in_s", &s.lead_in_s, "stands before the drive and after it", 0, 600},
          {"gait_ripple", &s.gait_ripple, "ripple of the speed with each step, as a share of it", 0, 0.5},
          {"gait_hz", &s.gait_hz, "steps a second at mean speed", 0, 4},
          {"wobble_deg", &s.wobble_deg, "sway of the heading", 0, 10},
          {"wobble_min_hz", &s.wobble_min_hz, "slowest sway", 0, 3},
          {"wobble_max_hz", &s.wobble_max_hz, "quickest sway", 0, 3},
          {"turn_max_deg_s", &s.turn_max_deg_s, "turn rate that bends are walked with at most", 1, 180},
          {"robot_speed_mps", &s.robot_speed_mps, "of a vehicle that is not pushed", 0.02, 3},
          {"scan_every_m", &s.scan_every_m, "way between a robot's stops for a scan, 0: it never stops", 0, 1e6},
          {"scan_stop_s", &s.scan_stop_s, "how long it stands there", 0, 3600},
          {"ground",
           &s.ground,
           "what the wheels meet on the floor: smooth is the mesh alone",
           {"smooth", "track", "rubble", "mixed"}},
          {"track_share", &s.track_share, "of the passages' length that has track, where the ground is mixed", 0, 1},
          {"rubble_share", &s.rubble_share, "and that has rubble", 0, 1},
          {"commands", &s.commands, "CSV file time_s,speed_mps,turn_rate_rad_s to drive by, in place of the route"},
          {"step_hz", &s.step_hz, "steps of the physics a second", 120, 2000},
          {"sample_hz", &s.sample_hz, "poses of the path a second; divides step_hz", 120, 2000}};
}

}  // namespace adit
