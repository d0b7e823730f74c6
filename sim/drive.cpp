// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "sim/autopilot.h"
#include "sim/follower.h"
#include "sim/ground.h"
#include "sim/physics.h"
#include "sim/pusher.h"
#include "sim/relief.h"
#include "sim/remote.h"
#include "sim/sim.h"
#include "sim/struggle.h"
#include "sim/watch.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

namespace adit {
namespace {

constexpr double lookahead_m = 0.9;
constexpr size_t stretch_s = 10;  // of a drive that is given away at once
constexpr double kept_s = 60;     // of the path at least, for what a trouble's picture shows
constexpr double settle_s = 15;   // longest time to come to rest before the drive
constexpr double still = 5e-3;    // m/s and rad/s
constexpr double still_for_s = 0.2;
constexpr double line_m = 0.25;                  // between points of the line that was driven
constexpr double run_mps = 1.2;                  // with which a person comes again where a cart got stuck
constexpr double shift_m = 0.01, shift_s = 1.5;  // so near to where forward and backward change it stops, and so long

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

// In a mine with ribs a point off the floor is in the rock.
void check_line(const World& world, const Floor& floor, const Route& route) {
  if (std::find(world.mesh.label.begin(), world.mesh.label.end(), Label::rib) == world.mesh.label.end()) return;
  for (size_t i = 1; i < route.line.size(); ++i)  // the first point is where the vehicle has to stand
    if (!floor.height_m(route.line[i]))
      throw Error(say("route: point %zu at (%.2f, %.2f) m lies in the rock; a route stays in the passages", i,
                      route.line[i].x(), route.line[i].y()));
}

using Driver = std::variant<Pusher, Autopilot, Remote>;

Driver make_driver(const DriveSettings& settings, const Vehicle& vehicle, std::uint64_t seed, double length_m) {
  if (!settings.commands.empty()) return Remote(read_commands(settings.commands), vehicle);
  if (vehicle.drivetrain == Drivetrain::skid_steer) return Autopilot(settings, vehicle.motors, length_m);
  return Pusher(settings, seed, length_m);
}

// The vehicle while it drives: what is constant by reference, what changes by value.
class Run {
 public:
  Run(const World& world, const Route& route, const Vehicle& vehicle, const DriveSettings& settings, std::uint64_t seed)
      : vehicle_(vehicle),
        settings_(settings),
        step_s_(1.0 / settings.step_hz),
        floor_(world.mesh),
        follower_(route),
        driver_(make_driver(settings, vehicle, seed, follower_.length_m())),
        watch_(world, floor_, vehicle) {
    lay_ground(world, seed);
    start_ = start();
    if (by_route()) check_line(world, floor_, route);
    physics_.emplace(world.mesh, vehicle, start_, step_s_, relief_ ? &*relief_ : nullptr);
    drive_.route = route;
    drive_.end = DriveEnd::underway;
    settle();
  }

  Drive finish(const std::function<void(Drive&&)>& take, const Progress& progress) {
    for (std::int64_t k = 0;; ++k) {
      const double t_s = static_cast<double>(k) * step_s_;
      if (k % (settings_.step_hz / settings_.sample_hz) == 0) record(t_s);
      if (k % settings_.step_hz == 0) progress("drive", drive_.driven_m, follower_.length_m());
      if (std::visit([&](const auto& driver) { return driver.done(t_s); }, driver_) || went_wrong(t_s)) break;
      step(t_s);
      if (drive_.path.size() - given_ == stretch_s * static_cast<size_t>(settings_.sample_hz)) give(take);
    }
    if (drive_.end == DriveEnd::underway) drive_.end = DriveEnd::finished;
    if (!by_route()) keep_line();
    progress("drive", drive_.driven_m, drive_.route.length_m);
    give(take);
    return std::move(drive_);
  }

 private:
  // What was driven since the last time; of what came before the last `keep` poses stay.
  void give(const std::function<void(Drive&&)>& take) {
    Trajectory& path = drive_.path;
    const auto from = static_cast<std::ptrdiff_t>(given_);
    take({drive_.route,
          {{path.stamp_s.begin() + from, path.stamp_s.end()}, {path.X_WB.begin() + from, path.X_WB.end()}},
          drive_.end,
          drive_.cause,
          drive_.driven_m,
          drive_.ground});
    const auto keep = static_cast<size_t>(kept_s * settings_.sample_hz);
    if (path.size() > 2 * keep) {
      const auto gone = static_cast<std::ptrdiff_t>(path.size() - keep);
      path.stamp_s.erase(path.stamp_s.begin(), path.stamp_s.begin() + gone);
      path.X_WB.erase(path.X_WB.begin(), path.X_WB.begin() + gone);
    }
    given_ = path.size();
  }

  bool by_route() const { return settings_.commands.empty(); }

  void lay_ground(const World& world, std::uint64_t seed) {
    if (settings_.ground == "smooth") return;
    const bool mixed = settings_.ground == "mixed";
    const FloorKind kind = settings_.ground == "track" ? FloorKind::track : FloorKind::rubble;
    std::vector<FloorKind> kinds(world.passages.size(), kind);
    if (mixed) kinds = draw_floor_kinds(world, settings_.track_share, settings_.rubble_share, seed);
    for (const FloorKind k : kinds) drive_.ground.push_back(static_cast<int>(k));
    if (mixed)
      relief_.emplace(world, floor_, std::move(kinds), seed);
    else
      relief_.emplace(world, floor_, kind, seed);
  }

  Pose start() const {
    const Vec2 ahead = follower_.point(std::min(0.5, follower_.length_m())) - follower_.point(0);
    const GroundHeight on_relief = [&](const Vec2& p_W, double radius_m) {
      return relief_->rest_height_m(p_W, radius_m);
    };
    return stand_on(relief_ ? on_relief : height_of(floor_), vehicle_, follower_.point(0),
                    std::atan2(ahead.y(), ahead.x()));
  }

  // Comes to rest on its tyres before the clock starts.
  void settle() {
    motion_ = physics_->motion();
    for (int k = 0; k < settle_s * settings_.step_hz && !resting_; ++k) {
      physics_->step(effort({}));
      motion_ = physics_->motion();
      watch_rest(true);
    }
    const double moved = (motion_.X_WB.translation() - start_.translation()).norm();
    if (!resting_ || moved > 0.2) {
      const Vec3 p = start_.translation();
      throw Error(
          vehicle_.name + say(" cannot stand at the start (%.2f, %.2f, %.2f) m: it ", p.x(), p.y(), p.z()) +
          say(resting_ ? "moved by %.2f m" : "did not come to rest within %.0f s", resting_ ? moved : settle_s) +
          "; start in a clear, level place, with wheels that grip");
    }
    look();
  }

  // A held vehicle that has come to rest is left alone: standing still is exact, and costs nothing.
  void watch_rest(bool hold) {
    if (!hold) still_s_ = 0, resting_ = false;
    if (!hold || resting_) return;
    still_s_ = motion_.v_W.norm() < still && motion_.omega_W.norm() < still ? still_s_ + step_s_ : 0;
    if (still_s_ < still_for_s) return;
    physics_->rest();
    motion_ = physics_->motion();
    resting_ = true;
  }

  void look() {
    if (!by_route()) return extend_line();
    const Pose2 X_WB = flatten(motion_.X_WB);
    guide_ = follower_.look(X_WB * Pose2{vehicle_.axle_x_m(), 0, 0}, lookahead_m);
    if (guide_.backward) guide_.curvature = -guide_.curvature;  // of the nose, whose speed is negative
    along_m_ = guide_.along_m - vehicle_.axle_x_m();            // of B's origin
    drive_.driven_m = std::clamp(along_m_, drive_.driven_m, follower_.length_m());
  }

  Intent want(double t_s) {
    if (auto* remote = std::get_if<Remote>(&driver_)) return remote->want(t_s, step_s_);
    if (guide_.shift_in_m < shift_m) {
      if (!shift_at_s_) shift_at_s_ = t_s + shift_s;
      if (t_s < *shift_at_s_) return {};
      shift_at_s_.reset();
      follower_.shift();
      struggle_.give_up();
      look();
    }
    if (const auto again = struggle_.want(t_s, step_s_, along_m_, guide_, motion_)) return *again;
    Intent intent;
    if (auto* pusher = std::get_if<Pusher>(&driver_)) intent = pusher->want(t_s, step_s_, along_m_, guide_);
    if (auto* autopilot = std::get_if<Autopilot>(&driver_)) intent = autopilot->want(t_s, step_s_, along_m_, guide_);
    if (guide_.backward) intent.speed_mps = -intent.speed_mps;
    return intent;
  }

  Effort effort(const Intent& intent) {
    const double curvature = struggle_.curvature(guide_.curvature);
    if (vehicle_.drivetrain == Drivetrain::skid_steer) return steer(vehicle_, intent, curvature);
    return push(vehicle_, intent, curvature, motion_, step_s_, hands_);
  }

  void step(double t_s) {
    const Intent intent = want(t_s);
    if (intent.hold) watch_.stands(t_s);
    watch_rest(intent.hold);
    if (resting_) return;
    effort_ = effort(intent);
    physics_->step(effort_);
    motion_ = physics_->motion();
    look();
  }

  void record(double t_s) {
    drive_.path.stamp_s.push_back(t_s);
    drive_.path.X_WB.push_back(motion_.X_WB);
  }

  bool went_wrong(double t_s) {
    const Headway headway{t_s, along_m_, drive_.driven_m, guide_, by_route()};
    const std::optional<Trouble> trouble = watch_.look(headway, motion_, effort_, *physics_);
    if (!trouble || (trouble->held_up && by_route() && tries_again(t_s, trouble->end == DriveEnd::blocked)))
      return false;
    drive_.end = trouble->end;
    drive_.cause = trouble->cause;
    if (trouble->held_up && by_route()) drive_.cause += say("; %d more tries did not help", struggle_.tries());
    return true;
  }

  bool tries_again(double t_s, bool against_rock) {
    const bool pushed = vehicle_.drivetrain == Drivetrain::pushed;
    const double walk_mps = pushed ? settings_.speed_mps : settings_.robot_speed_mps;
    if (!struggle_.again(t_s, along_m_, motion_, against_rock, walk_mps, pushed ? run_mps : walk_mps)) return false;
    hands_ = {};
    watch_.stands(t_s);
    return true;
  }

  // By commands there is no route to follow: what is driven becomes the route.
  void extend_line() {
    const Vec2 p = motion_.X_WB.translation().head<2>();
    if (line_.empty()) line_.push_back(p);
    const double on = (p - line_.back()).norm();
    if (on < line_m) return;
    line_.push_back(p);
    drive_.driven_m += on;
  }

  void keep_line() {
    const Vec2 p = motion_.X_WB.translation().head<2>();
    drive_.driven_m += (p - line_.back()).norm();
    line_.push_back(p);
    drive_.route = {std::move(line_), {}, drive_.driven_m};
  }

  const Vehicle& vehicle_;
  const DriveSettings& settings_;
  const double step_s_;
  const Floor floor_;
  Follower follower_;
  Driver driver_;
  Watch watch_;
  std::optional<Relief> relief_;
  Pose start_ = Pose::Identity();
  std::optional<Physics> physics_;
  Motion motion_;
  Guide guide_;
  Hands hands_;
  Struggle struggle_;
  Effort effort_;
  Drive drive_;
  double along_m_ = 0, still_s_ = 0;
  std::optional<double> shift_at_s_;  // when it goes on, the other way round
  std::vector<Vec2> line_;            // driven by commands
  bool resting_ = false;
  size_t given_ = 0;  // poses of the path that were given away
};

}  // namespace

Drive drive(const World& world, const Route& route, const Vehicle& vehicle, const DriveSettings& settings,
            std::uint64_t seed, const std::function<void(Drive&&)>& take, const Progress& progress) {
  check(settings);
  check_width(world, route, vehicle);
  if (world.mesh.face.empty()) throw Error("world " + world.name + ": its mesh has no faces");
  return Run(world, route, vehicle, settings, seed).finish(take, progress);
}

Drive drive(const World& world, const Route& route, const Vehicle& vehicle, const DriveSettings& settings,
            std::uint64_t seed, const Progress& progress) {
  Drive whole;
  drive(
      world, route, vehicle, settings, seed, [&](Drive&& stretch) { append(whole, stretch); }, progress);
  return whole;
}

}  // namespace adit
