// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/follower.h"
#include "sim/physics.h"
#include "sim/sim.h"

#include <cstdint>

namespace adit {

/// What a person who pushes wants at an instant.
struct Intent {
  double speed_mps = 0;
  double wobble_rad_s = 0;   // turn rate beside what the route asks
  bool hold = true;          // stands and holds the vehicle
  bool on_the_spot = false;  // turns about its axle: what the route asks does not count

  double turn_rad_s(double curvature) const { return (on_the_spot ? 0 : speed_mps * curvature) + wobble_rad_s; }
};

/// When and how fast a person walks: a speed that varies slowly, its ripple with each step, swaying, stops; where the way on
/// lies behind, stopping and swinging the vehicle round about its axle. All of it is a function of the seed, of time and of
/// where on the route the vehicle is.
class Pusher {
 public:
  Pusher(const DriveSettings& settings, std::uint64_t seed, double length_m);

  /// @param along_m  of the route's length; never runs back by much
  Intent want(double t_s, double step_s, double along_m, const Guide& guide);
  /// Stood for lead_in_s at the route's end.
  bool done(double t_s) const { return arrived_ && t_s >= go_at_s_; }

 private:
  double cruise_mps(double t_s) const;
  void plan_stop(double along_m);

  DriveSettings settings_;
  std::uint64_t seed_;
  double length_m_;
  double go_at_s_;        // stands until then
  double halt_at_m_ = 0;  // the next stop, or the end
  std::uint64_t stops_ = 0;
  bool arrived_ = false;
  SpotTurn turn_;
  double speed_mps_ = 0, swing_rad_s_ = 0;
  double gait_rad_ = 0, sway_rad_ = 0;
};

/// A controller's memory between steps.
struct Hands {
  double force_N = 0, moment_Nm = 0;       // integral terms
  double speed_mps = 0, wobble_rad_s = 0;  // wanted one step ago
  bool holds = false;
  double hold_yaw_rad = 0;  // where it was when the holding began
};

/// Force and moment that bring a vehicle to the speed and turn wanted, within what a person can do. Proportional with
/// integral (the grade, the bearings) and the acceleration wanted fed forward. Who holds brakes the wheels and keeps
/// the heading.
/// @param curvature  1/m, to steer
Effort push(const Vehicle& vehicle, const Intent& intent, double curvature, const Motion& motion, double step_s,
            Hands& hands);

}  // namespace adit
