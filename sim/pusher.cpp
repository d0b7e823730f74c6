// SPDX-License-Identifier: BSD-3-Clause
#include "sim/pusher.h"

#include "base/rng.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double knot_s = 8;  // a person's pace changes over some such time
constexpr double accelerate_mps2 = 0.5;
constexpr double brake_mps2 = 0.3;
constexpr double swing_rad_s2 = 1;                      // in turns on the spot
constexpr double slowest_mps = 0.08;                    // on the last centimetres before a halt
constexpr double speed_lag_s = 0.25, turn_lag_s = 0.1;  // of the controller
constexpr double hold_rad_s = 8;                        // how stiffly the handle is held

// Smooth through independent values at equally spaced knots, their spread kept between the knots.
double wander(std::uint64_t seed, Draw draw, std::uint64_t channel, double knots) {
  const double k = std::floor(knots);
  const double s = 0.5 - 0.5 * std::cos(pi * (knots - k));
  const std::uint64_t i = static_cast<std::uint64_t>(k);
  const double a = normal(seed, draw, i, channel), b = normal(seed, draw, i + 1, channel);
  return (a * (1 - s) + b * s) / std::hypot(1 - s, s);
}

// What resists a push: wheels count as balls that roll, 2/5 more than what slides.
double moved_mass_kg(const Vehicle& vehicle) {
  double mass = vehicle.mass_kg;
  for (const Wheel& wheel : vehicle.wheels) mass += 1.4 * wheel.mass_kg;
  return mass;
}

// About the fixed wheels' axle.
double turn_inertia_kg_m2(const Vehicle& vehicle) {
  const double arm = vehicle.centre_of_mass_B.x() - vehicle.axle_x_m();
  double inertia = vehicle.inertia_kg_m2.z() + vehicle.mass_kg * arm * arm;
  for (const Wheel& wheel : vehicle.wheels)
    inertia += 1.4 * wheel.mass_kg * (wheel.position_B - Vec2(vehicle.axle_x_m(), 0)).squaredNorm();
  return inertia;
}

// Brakes the wheels, and hands that keep the handle from swinging where a wheel bears no load.
Effort hold(const Vehicle& vehicle, const Motion& motion, Hands& hands) {
  const double yaw = flatten(motion.X_WB).yaw_rad, inertia = turn_inertia_kg_m2(vehicle);
  if (!hands.holds) hands = {.holds = true, .hold_yaw_rad = yaw};
  const double back = wrap_angle(hands.hold_yaw_rad - yaw) * hold_rad_s - 2 * motion.omega_W.z();  // critically damped
  Effort effort;
  effort.moment_Nm = std::clamp(inertia * hold_rad_s * back, -vehicle.moment_max_Nm, vehicle.moment_max_Nm);
  effort.brake = true;
  return effort;
}

}  // namespace

Pusher::Pusher(const DriveSettings& settings, std::uint64_t seed, double length_m)
    : settings_(settings), seed_(seed), length_m_(length_m), go_at_s_(settings.lead_in_s) {
  gait_rad_ = 2 * pi * uniform(seed, Draw::push_gait, 0);
  sway_rad_ = 2 * pi * uniform(seed, Draw::push_wobble, 0, 9);
  plan_stop(0);
}

void Pusher::plan_stop(double along_m) {
  const double u = uniform(seed_, Draw::push_stop, stops_, 0);
  halt_at_m_ = along_m + settings_.stop_gap_min_m + u * (settings_.stop_gap_max_m - settings_.stop_gap_min_m);
  if (halt_at_m_ > length_m_ - 2) halt_at_m_ = length_m_;
}

double Pusher::cruise_mps(double t_s) const {
  const double v = settings_.speed_mps + settings_.speed_sd_mps * wander(seed_, Draw::push_speed, 0, t_s / knot_s);
  return std::clamp(v, 0.5 * settings_.speed_mps, 1.6 * settings_.speed_mps);
}

Intent Pusher::want(double t_s, double step_s, double along_m, const Guide& guide) {
  Intent intent;
  if (t_s < go_at_s_ || arrived_) {
    speed_mps_ = 0;
    return intent;
  }
  const double left_m = halt_at_m_ - along_m;
  if (left_m <= 0.005) {
    arrived_ = halt_at_m_ >= length_m_;
    const double u = uniform(seed_, Draw::push_stop, stops_++, 1);
    const double stay_s = settings_.stop_min_s + u * (settings_.stop_max_s - settings_.stop_min_s);
    go_at_s_ = t_s + (arrived_ ? settings_.lead_in_s : stay_s);
    if (!arrived_) plan_stop(along_m);
    return intent;
  }
  double limit = cruise_mps(t_s);
  limit = std::min(limit, settings_.turn_max_deg_s * pi / 180 / std::max(guide.curvature_ahead, 1e-3));
  const double to_halt_m = std::min(left_m, std::max(0.0, guide.shift_in_m));
  limit = std::min(limit, std::max(slowest_mps, std::sqrt(2 * brake_mps2 * to_halt_m)));
  if (turn_.look(guide)) limit = 0;
  speed_mps_ = std::clamp(limit, speed_mps_ - 2 * brake_mps2 * step_s, speed_mps_ + accelerate_mps2 * step_s);
  const double swing = turn_.on() && speed_mps_ == 0 ? turn_.side() * settings_.turn_max_deg_s * pi / 180 : 0;
  swing_rad_s_ =
      turn_.on() ? std::clamp(swing, swing_rad_s_ - swing_rad_s2 * step_s, swing_rad_s_ + swing_rad_s2 * step_s) : 0;
  // People take quicker steps to walk faster, about with the root of the speed.
  const double pace = std::sqrt(speed_mps_ / settings_.speed_mps);
  gait_rad_ += 2 * pi * settings_.gait_hz * pace * step_s;
  const double sway_u = 0.5 + 0.5 * std::tanh(wander(seed_, Draw::push_wobble, 0, t_s / knot_s));
  const double sway_hz = settings_.wobble_min_hz + sway_u * (settings_.wobble_max_hz - settings_.wobble_min_hz);
  sway_rad_ += 2 * pi * sway_hz * step_s;
  const double sway_size =
      settings_.wobble_deg * pi / 180 * std::min(1.25, std::abs(wander(seed_, Draw::push_wobble, 1, t_s / knot_s)));
  intent.hold = false;
  intent.speed_mps = speed_mps_ * (1 + settings_.gait_ripple * std::sin(gait_rad_));
  intent.wobble_rad_s =
      sway_size * 2 * pi * sway_hz * std::cos(sway_rad_) * std::min(1.0, speed_mps_ / settings_.speed_mps) +
      swing_rad_s_;
  intent.on_the_spot = turn_.on() && speed_mps_ == 0;
  if (intent.on_the_spot) intent.speed_mps = turn_.creep_mps(guide);
  return intent;
}

Effort push(const Vehicle& vehicle, const Intent& intent, double curvature, const Motion& motion, double step_s,
            Hands& hands) {
  if (intent.hold) return hold(vehicle, motion, hands);
  if (hands.holds) hands = {};
  const Eigen::Matrix3d R = motion.X_WB.linear();
  const double speed = R.col(0).dot(motion.v_W), turn = R.col(2).dot(motion.omega_W);
  const double turn_wanted = intent.turn_rad_s(curvature);
  const double mass = moved_mass_kg(vehicle), inertia = turn_inertia_kg_m2(vehicle);
  const double hurry = (intent.speed_mps - hands.speed_mps) / step_s,
               swing = (intent.wobble_rad_s - hands.wobble_rad_s) / step_s;
  hands.speed_mps = intent.speed_mps;
  hands.wobble_rad_s = intent.wobble_rad_s;

  const auto within = [](double value, double limit) { return std::clamp(value, -limit, limit); };
  const double pull = mass * (intent.speed_mps - speed) / speed_lag_s,
               twist = inertia * (turn_wanted - turn) / turn_lag_s;
  hands.force_N = within(hands.force_N + pull * step_s / (4 * speed_lag_s), vehicle.force_max_N);
  hands.moment_Nm = within(hands.moment_Nm + twist * step_s / (4 * turn_lag_s), vehicle.moment_max_Nm);
  Effort effort;
  effort.force_N = within(mass * hurry + pull + hands.force_N, vehicle.force_max_N);
  effort.moment_Nm = within(inertia * swing + twist + hands.moment_Nm, vehicle.moment_max_Nm);
  return effort;
}

}  // namespace adit
