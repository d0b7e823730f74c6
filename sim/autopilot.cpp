// SPDX-License-Identifier: BSD-3-Clause
#include "sim/autopilot.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double slowest_mps = 0.03;  // on the last centimetres before a halt
constexpr double turn_up_s = 1;       // until it turns as fast as it can

}  // namespace

Autopilot::Autopilot(const DriveSettings& settings, const Motors& motors, double length_m)
    : settings_(settings), motors_(motors), length_m_(length_m), go_at_s_(settings.lead_in_s) {
  plan_stop(0);
}

void Autopilot::plan_stop(double along_m) {
  halt_at_m_ = settings_.scan_every_m > 0 ? along_m + settings_.scan_every_m : length_m_;
  if (halt_at_m_ > length_m_ - 0.5) halt_at_m_ = length_m_;
}

Intent Autopilot::want(double t_s, double step_s, double along_m, const Guide& guide) {
  Intent intent;
  if (t_s < go_at_s_ || arrived_) return intent;
  const double left_m = halt_at_m_ - along_m;
  if (left_m <= 0.005 && !turn_.on()) {
    speed_mps_ = 0;
    arrived_ = halt_at_m_ >= length_m_;
    go_at_s_ = t_s + (arrived_ ? settings_.lead_in_s : settings_.scan_stop_s);
    if (!arrived_) plan_stop(halt_at_m_);
    return intent;
  }
  const bool turning = turn_.look(guide);
  const double brake = motors_.acceleration_mps2;
  double limit = std::min(settings_.robot_speed_mps, motors_.speed_max_mps);
  limit = std::min(limit, motors_.turn_max_rad_s / std::max(guide.curvature_ahead, 1e-3));
  const double to_halt_m = std::max(0.0, std::min(left_m, guide.shift_in_m));
  limit = std::min(limit, std::max(slowest_mps, std::sqrt(2 * brake * to_halt_m)));
  if (turning) limit = 0;
  speed_mps_ = std::clamp(limit, speed_mps_ - 2 * brake * step_s, speed_mps_ + brake * step_s);
  const double turn = turning && speed_mps_ == 0 ? turn_.side() * motors_.turn_max_rad_s : 0;
  const double more = motors_.turn_max_rad_s / turn_up_s * step_s;
  turn_rad_s_ = turning ? std::clamp(turn, turn_rad_s_ - more, turn_rad_s_ + more) : 0;
  intent.hold = false;
  intent.speed_mps = speed_mps_;
  intent.wobble_rad_s = turn_rad_s_;
  // As it creeps it steers for the way on too, so that the turn waits while it backs: it slips the less.
  if (turning && speed_mps_ == 0) intent.speed_mps = turn_.creep_mps(guide);
  return intent;
}

Effort steer(const Vehicle& vehicle, const Intent& intent, double curvature) {
  Effort effort;
  effort.brake = intent.hold;
  if (intent.hold) return effort;
  const Motors& motors = vehicle.motors;
  const double turn = std::clamp(intent.turn_rad_s(curvature), -motors.turn_max_rad_s, motors.turn_max_rad_s);
  const double apart = 0.5 * turn * motors.turn_gain * vehicle.track_m();
  const double fastest = std::abs(intent.speed_mps) + std::abs(apart);
  const double cut = fastest > motors.speed_max_mps ? motors.speed_max_mps / fastest : 1;
  effort.left_mps = cut * (intent.speed_mps - apart);
  effort.right_mps = cut * (intent.speed_mps + apart);
  return effort;
}

}  // namespace adit
