// SPDX-License-Identifier: BSD-3-Clause
#include "sim/watch.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace adit {
namespace {

constexpr double patience_s = 5;  // without moving on in it, a vehicle is held up
constexpr double leaning_s = 20;  // nor does a person take longer to push with all force
constexpr double turning_s = 30;  // nor does it take longer to turn on the spot
constexpr double headway_m = 0.1;
constexpr double turned_rad = 0.35;  // counts as having moved
constexpr double stray_m = 1.5;      // off its route, a vehicle is lost
constexpr double upright = 0.5;      // cosine of the tilt at which it has tipped over
constexpr double fall_mps = 1.2;     // no bump that is rolled over lets it down so fast

}  // namespace

std::string say(const char* format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

// It moves on along the route, or at least about the place: a turn on the spot has no headway.
void Watch::watch_headway(const Headway& headway, const Motion& motion) {
  const double t_s = headway.t_s, yaw = flatten(motion.X_WB).yaw_rad;
  if (!headway.by_route)
    ahead_s_ = t_s;
  else if (headway.along_m > best_m_ + headway_m)
    best_m_ = headway.along_m, ahead_s_ = t_s;
  const Vec3& p = motion.X_WB.translation();
  const bool on = headway.by_route && ahead_s_ == t_s;
  if (!on && (p - moved_to_).norm() <= 2 * headway_m && std::abs(wrap_angle(yaw - turned_to_rad_)) <= turned_rad)
    return;
  moved_to_ = p;
  turned_to_rad_ = yaw;
  moved_s_ = t_s;
}

std::optional<Trouble> Watch::look(const Headway& headway, const Motion& motion, const Effort& effort,
                                   const Physics& physics) {
  watch_headway(headway, motion);
  const std::string& name = vehicle_.name;
  const auto here = [&] { return place(headway, motion); };
  if (motion.X_WB.linear()(2, 2) < upright || motion.v_W.z() < -fall_mps) {
    if (over_floor(motion)) return Trouble{DriveEnd::tipped, name + " tipped over " + here()};
    return Trouble{DriveEnd::fell, name + " fell " + here() + ": there is no floor under it"};
  }
  if (headway.by_route && std::abs(headway.guide.cross_m) > stray_m)
    return Trouble{DriveEnd::stuck,
                   name + say(" strayed %.1f m off its route ", std::abs(headway.guide.cross_m)) + here()};
  // Who creeps up to a halt leans on the handle little by little: held up is who can do no more.
  const double stood_s = headway.t_s - moved_s_;
  const bool leans = vehicle_.drivetrain == Drivetrain::pushed && std::abs(effort.force_N) < vehicle_.force_max_N &&
                     stood_s < leaning_s;
  if ((stood_s > patience_s && !leans) || headway.t_s - ahead_s_ > turning_s)
    return held_up(headway, motion, effort, physics);
  return std::nullopt;
}

Trouble Watch::held_up(const Headway& headway, const Motion& motion, const Effort& effort,
                       const Physics& physics) const {
  const double stood_s = headway.t_s - std::min(moved_s_, ahead_s_);
  const std::string tried = vehicle_.drivetrain == Drivetrain::pushed
                                ? say(": pushed for %.0f s, at last with %.0f N, ", stood_s, effort.force_N)
                                : say(": its motors strove for %.0f s, at last for %.2f and %.2f m/s, ", stood_s,
                                      effort.left_mps, effort.right_mps);
  const std::optional<size_t> at_frame = physics.touched_face(), at_wheel = physics.face_at_wheel();
  const std::string where = place(headway, motion) + tried;
  if (at_frame)
    return {DriveEnd::blocked, vehicle_.name + " is blocked " + where + "its frame against the " + face_name(*at_frame),
            true};
  if (at_wheel)
    return {DriveEnd::blocked, vehicle_.name + " is blocked " + where + "a wheel against the " + face_name(*at_wheel),
            true};
  return {DriveEnd::stuck, vehicle_.name + " got stuck " + where + "its wheels do not get on", true};
}

bool Watch::over_floor(const Motion& motion) const {
  const Vec3 p = motion.X_WB.translation();
  const std::optional<double> z = floor_.height_m(p.head<2>());
  return z && std::abs(*z - p.z()) < 1;
}

std::string Watch::place(const Headway& headway, const Motion& motion) const {
  const Vec3 p = motion.X_WB.translation();
  return say("at (%.2f, %.2f, %.2f) m after %.1f s, %.1f m along the %s", p.x(), p.y(), p.z(), headway.t_s,
             headway.driven_m, headway.by_route ? "route" : "way driven");
}

std::string Watch::face_name(size_t face) const {
  const Mesh& mesh = world_.mesh;
  std::string what = face < mesh.label.size() ? label_name(mesh.label[face]) : "rock";
  if (face < mesh.part.size() && mesh.part[face] >= 0) what += say(" of part %d", mesh.part[face]);
  return what;
}

}  // namespace adit
