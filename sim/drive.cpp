// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "sim/follower.h"
#include "sim/ground.h"
#include "sim/physics.h"
#include "sim/pusher.h"
#include "sim/sim.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace adit {
namespace {

constexpr double lookahead_m = 0.9;
constexpr double settle_s = 5;    // longest time to come to rest before the drive
constexpr double patience_s = 5;  // without moving on in it, a vehicle is stuck
constexpr double turning_s = 30;  // nor does it take longer to turn on the spot
constexpr double headway_m = 0.1;
constexpr double stray_m = 1.5;   // off its route, a vehicle is lost
constexpr double upright = 0.5;   // cosine of the tilt at which it has tipped over
constexpr double fall_mps = 1.2;  // no bump that is rolled over lets it down so fast
constexpr double still = 5e-3;    // m/s and rad/s
constexpr double still_for_s = 0.2;

std::string say(const char* format, ...) {
  char text[400];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  return text;
}

void check(const DriveSettings& settings) {
  if (settings.step_hz % settings.sample_hz != 0)
    throw Error(say("drive.sample_hz = %d must divide drive.step_hz = %d", settings.sample_hz, settings.step_hz));
  if (settings.stop_gap_min_m > settings.stop_gap_max_m)
    throw Error("drive.stop_gap_min_m must not exceed stop_gap_max_m");
  if (settings.stop_min_s > settings.stop_max_s) throw Error("drive.stop_min_s must not exceed stop_max_s");
  if (settings.wobble_min_hz > settings.wobble_max_hz) throw Error("drive.wobble_min_hz must not exceed wobble_max_hz");
}

void check_width(const World& world, const Route& route, const Vehicle& vehicle) {
  for (const int id : route.passages) {
    if (id < 0 || id >= static_cast<int>(world.passages.size()))
      throw Error(say("route: passage %d is not in the world, which has %zu", id, world.passages.size()));
    const double width = world.passages[static_cast<size_t>(id)].width_m;
    if (width < vehicle.width_m())
      throw Error(say("passage %d is %.2f m wide and %s %.2f m: choose a narrower vehicle or a route around it", id,
                      width, vehicle.name.c_str(), vehicle.width_m()));
  }
}

// The vehicle while it drives: what is constant by reference, what changes by value.
class Run {
 public:
  Run(const World& world, const Route& route, const Vehicle& vehicle, const DriveSettings& settings, std::uint64_t seed)
      : world_(world),
        vehicle_(vehicle),
        settings_(settings),
        step_s_(1.0 / settings.step_hz),
        follower_(route),
        pusher_(settings, seed, follower_.length_m()),
        start_(start(world, vehicle, follower_)),
        physics_(world.mesh, vehicle, start_, step_s_) {
    drive_.route = route;
    settle();
  }

  Drive finish(const Progress& progress) {
    for (std::int64_t k = 0;; ++k) {
      const double t_s = static_cast<double>(k) * step_s_;
      if (k % (settings_.step_hz / settings_.sample_hz) == 0) record(t_s);
      if (k % settings_.step_hz == 0) progress("drive", drive_.driven_m, follower_.length_m());
      if (pusher_.done(t_s) || went_wrong(t_s)) break;
      step(t_s);
    }
    progress("drive", drive_.driven_m, follower_.length_m());
    return std::move(drive_);
  }

 private:
  static Pose start(const World& world, const Vehicle& vehicle, const Follower& follower) {
    const Vec2 ahead = follower.point(std::min(0.5, follower.length_m())) - follower.point(0);
    return stand_on(floor_of(world), vehicle, follower.point(0), std::atan2(ahead.y(), ahead.x()));
  }

  // Comes to rest on its tyres before the clock starts.
  void settle() {
    motion_ = physics_.motion();
    for (int k = 0; k < settle_s * settings_.step_hz && !resting_; ++k) {
      physics_.step(push(vehicle_, {}, 0, motion_, step_s_, hands_));
      motion_ = physics_.motion();
      watch_rest(true);
    }
    const double moved = (motion_.X_WB.translation() - start_.translation()).norm();
    if (!resting_ || moved > 0.2)
      throw Error(say(
          "%s cannot stand at the start (%.2f, %.2f, %.2f) m: it moved by %.2f m; start in a clear, level place",
          vehicle_.name.c_str(), start_.translation().x(), start_.translation().y(), start_.translation().z(), moved));
    look();
  }

  // A held vehicle that has come to rest is left alone: standing still is exact, and costs nothing.
  void watch_rest(bool hold) {
    if (!hold) still_s_ = 0, resting_ = false;
    if (!hold || resting_) return;
    still_s_ = motion_.v_W.norm() < still && motion_.omega_W.norm() < still ? still_s_ + step_s_ : 0;
    if (still_s_ < still_for_s) return;
    physics_.rest();
    motion_ = physics_.motion();
    resting_ = true;
  }

  void look() {
    const Pose2 X_WB = flatten(motion_.X_WB);
    guide_ = follower_.look(X_WB * Pose2{vehicle_.axle_x_m(), 0, 0}, lookahead_m);
    along_m_ = guide_.along_m - vehicle_.axle_x_m();  // of B's origin
    drive_.driven_m = std::clamp(along_m_, drive_.driven_m, follower_.length_m());
  }

  void step(double t_s) {
    const Intent intent = pusher_.want(t_s, step_s_, along_m_, guide_.curvature_ahead);
    if (intent.hold) moved_s_ = ahead_s_ = t_s;
    watch_rest(intent.hold);
    if (resting_) return;
    effort_ = push(vehicle_, intent, guide_.curvature, motion_, step_s_, hands_);
    physics_.step(effort_);
    motion_ = physics_.motion();
    look();
  }

  void record(double t_s) {
    drive_.path.stamp_s.push_back(t_s);
    drive_.path.X_WB.push_back(motion_.X_WB);
  }

  // It moves on along the route, or at least about the place: a turn on the spot has no headway.
  void watch_headway(double t_s) {
    if (along_m_ > best_m_ + headway_m) best_m_ = along_m_, ahead_s_ = t_s;
    const Vec3& p = motion_.X_WB.translation();
    if (ahead_s_ == t_s || (p - moved_to_).norm() > 2 * headway_m) moved_to_ = p, moved_s_ = t_s;
  }

  bool went_wrong(double t_s) {
    watch_headway(t_s);
    const std::string& name = vehicle_.name;
    if (motion_.X_WB.linear()(2, 2) < upright || motion_.v_W.z() < -fall_mps) {
      if (over_floor()) return end(DriveEnd::tipped, name + " tipped over " + place(t_s));
      return end(DriveEnd::fell, name + " fell " + place(t_s) + ": there is no floor under it");
    }
    if (std::abs(guide_.cross_m) > stray_m)
      return end(DriveEnd::stuck, name + say(" strayed %.1f m off its route ", std::abs(guide_.cross_m)) + place(t_s));
    if (t_s - moved_s_ > patience_s || t_s - ahead_s_ > turning_s)
      return end(DriveEnd::stuck, name + " got stuck " + place(t_s) +
                                      say(": pushed for %.0f s, at last with %.0f N, ", patience_s, effort_.force_N) +
                                      touching());
    return false;
  }

  bool over_floor() const {
    const Vec3 p = motion_.X_WB.translation();
    const std::optional<double> z = floor_height_m(floor_of(world_), p.head<2>());
    return z && std::abs(*z - p.z()) < 1;
  }

  std::string place(double t_s) const {
    const Vec3 p = motion_.X_WB.translation();
    return say("at (%.2f, %.2f, %.2f) m after %.1f s, %.1f m along the route", p.x(), p.y(), p.z(), t_s,
               drive_.driven_m);
  }

  std::string touching() const {
    const std::optional<size_t> face = physics_.touched_face();
    if (!face) return "its wheels do not get on";
    std::string what = *face < world_.mesh.label.size() ? label_name(world_.mesh.label[*face]) : "rock";
    if (*face < world_.mesh.part.size() && world_.mesh.part[*face] >= 0)
      what += say(" of part %d", world_.mesh.part[*face]);
    return "its frame against the " + what;
  }

  bool end(DriveEnd how, const std::string& cause) {
    drive_.end = how;
    drive_.cause = cause;
    return true;
  }

  const World& world_;
  const Vehicle& vehicle_;
  const DriveSettings& settings_;
  const double step_s_;
  Follower follower_;
  Pusher pusher_;
  const Pose start_;
  Physics physics_;
  Motion motion_;
  Guide guide_;
  Hands hands_;
  Effort effort_;
  Drive drive_;
  double along_m_ = 0, best_m_ = 0, ahead_s_ = 0, moved_s_ = 0, still_s_ = 0;
  Vec3 moved_to_ = Vec3::Zero();
  bool resting_ = false;
};

}  // namespace

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
          {"step_hz", &s.step_hz, "steps of the physics a second", 120, 2000},
          {"sample_hz", &s.sample_hz, "poses of the path a second; divides step_hz", 120, 2000}};
}

Drive drive(const World& world, const Route& route, const Vehicle& vehicle, const DriveSettings& settings,
            std::uint64_t seed, const Progress& progress) {
  check(settings);
  check_width(world, route, vehicle);
  if (world.mesh.face.empty()) throw Error("world " + world.name + ": its mesh has no faces");
  return Run(world, route, vehicle, settings, seed).finish(progress);
}

}  // namespace adit
