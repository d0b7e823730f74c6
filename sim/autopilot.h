// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/follower.h"
#include "sim/pusher.h"
#include "sim/sim.h"

namespace adit {

/// How a robot drives a route by itself: at one speed, slower in bends, turning on the spot where the route runs back on
/// itself; where it is asked to, it stops at even distances for a scan.
class Autopilot {
 public:
  Autopilot(const DriveSettings& settings, const Motors& motors, double length_m);

  /// @param along_m  of the route's length
  Intent want(double t_s, double step_s, double along_m, const Guide& guide);
  /// Stood for lead_in_s at the route's end.
  bool done(double t_s) const { return arrived_ && t_s >= go_at_s_; }

 private:
  void plan_stop(double along_m);

  DriveSettings settings_;
  Motors motors_;
  double length_m_;
  double go_at_s_;        // stands until then
  double halt_at_m_ = 0;  // the next stop, or the end
  bool arrived_ = false;
  SpotTurn turn_;
  double speed_mps_ = 0, turn_rad_s_ = 0;
};

/// Speeds of the wheels of each side that make a skid-steer go and turn as wanted, within what its motors can do; where
/// the speeds asked for are too great, both are cut so that the bend stays the same.
/// @param curvature  1/m, to steer
Effort steer(const Vehicle& vehicle, const Intent& intent, double curvature);

}  // namespace adit
