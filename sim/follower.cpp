// SPDX-License-Identifier: BSD-3-Clause
#include "sim/follower.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace adit {
namespace {

constexpr double tightest = 2.5;  // 1/m, of the axle's path
constexpr double manoeuvre_m = 2.5, manoeuvre_lookahead_m = 0.4;
constexpr double turn_from_rad = std::numbers::pi / 2, turn_to_rad = 0.15;  // off the way on: begins and ends a turn
constexpr double creep_s = 2, creep_max_mps = 0.15;

}  // namespace

bool SpotTurn::look(const Guide& guide) {
  const double off_rad = std::abs(guide.bearing_rad);
  const bool begins = !on_;
  on_ = off_rad > (on_ ? turn_to_rad : turn_from_rad);
  if (begins || off_rad < turn_from_rad) left_ = guide.bearing_rad > 0;
  return on_;
}

double SpotTurn::creep_mps(const Guide& guide) const {
  return std::clamp(-guide.ahead_m / creep_s, -creep_max_mps, creep_max_mps);
}

Follower::Follower(const Route& route) {
  std::vector<size_t> kept;  // which point of the line a point of the route became
  for (const Vec2& p : route.line) {
    if (line_.empty() || (p - line_.back()).norm() > 1e-6) line_.push_back(p);
    kept.push_back(line_.size() - 1);
  }
  if (line_.size() < 2) throw Error("route: needs at least two different points, has " + std::to_string(line_.size()));
  at_m_.assign(line_.size(), 0);
  for (size_t i = 1; i < line_.size(); ++i) at_m_[i] = at_m_[i - 1] + (line_[i] - line_[i - 1]).norm();
  length_m_ = at_m_.back();
  for (size_t i = 1; i + 1 < line_.size(); ++i)
    if ((line_[i] - line_[i - 1]).dot(line_[i + 1] - line_[i]) < 0) turns_m_.push_back(at_m_[i]);
  for (const auto& [first, last] : route.backwards)
    for (const int i : {first, last}) {
      if (i < 0 || i >= static_cast<int>(kept.size()) ||
          (!shifts_m_.empty() && at_m_[kept[static_cast<size_t>(i)]] <= shifts_m_.back()))
        throw Error("route: its stretches to drive backwards are not points of its line in their order");
      shifts_m_.push_back(at_m_[kept[static_cast<size_t>(i)]]);
    }
}

double Follower::shift_m() const {
  return shifted_ < shifts_m_.size() ? shifts_m_[shifted_] : std::numeric_limits<double>::infinity();
}

void Follower::shift() {
  foot_m_ = shift_m();
  ++shifted_;
}

size_t Follower::segment(double along_m) const {
  const auto next = std::upper_bound(at_m_.begin() + 1, at_m_.end() - 1, along_m);
  return static_cast<size_t>(next - at_m_.begin()) - 1;
}

Vec2 Follower::point(double along_m) const {
  const size_t i = segment(along_m);
  return line_[i] + (along_m - at_m_[i]) / (at_m_[i + 1] - at_m_[i]) * (line_[i + 1] - line_[i]);
}

double Follower::heading_rad(double along_m) const {
  const size_t i = segment(along_m);
  const Vec2 d = line_[i + 1] - line_[i];
  return std::atan2(d.y(), d.x());
}

// Straight on where the route runs back on itself before that: first to the end, then round. Where forward and backward
// change it is the arc that goes on.
Vec2 Follower::goal(double lookahead_m) const {
  if (foot_m_ + lookahead_m > shift_m()) {
    const double end = shift_m(), heading = heading_rad(std::nextafter(end, 0)), beyond = foot_m_ + lookahead_m - end;
    const double turn = wrap_angle(heading - heading_rad(end - 0.3)) / 0.3 * beyond / 2;
    return point(end) + beyond * Vec2(std::cos(heading + turn), std::sin(heading + turn));
  }
  const auto end = std::upper_bound(turns_m_.begin(), turns_m_.end(), foot_m_);
  if (end == turns_m_.end() || *end >= foot_m_ + lookahead_m) return point(foot_m_ + lookahead_m);
  const double heading = heading_rad(std::nextafter(*end, 0));
  return point(*end) + (foot_m_ + lookahead_m - *end) * Vec2(std::cos(heading), std::sin(heading));
}

Guide Follower::look(const Pose2& X_WF, double lookahead_m) {
  const bool backward = shifted_ % 2 == 1;
  const Pose2 X_WA = backward ? X_WF * Pose2{0, 0, std::numbers::pi} : X_WF;
  const double end = std::nextafter(shift_m(), 0);
  const bool manoeuvre =
      foot_m_ + manoeuvre_m > end || (shifted_ > 0 && foot_m_ < shifts_m_[shifted_ - 1] + manoeuvre_m);
  if (manoeuvre) lookahead_m = std::min(lookahead_m, manoeuvre_lookahead_m);
  // Newton's steps to the foot of the perpendicular; small ones, for the foot never leaps to another stretch, and
  // onward ones, for where the route runs back on itself the way out lies on the way in.
  const bool found = std::exchange(found_, true);
  for (int k = found ? 3 : 100; k > 0; --k) {
    const double heading = heading_rad(foot_m_);
    const double ahead = (X_WA.position() - point(foot_m_)).dot(Vec2(std::cos(heading), std::sin(heading)));
    foot_m_ = std::min(foot_m_ + std::clamp(ahead, found ? 0 : -0.05, 0.05), end);
  }
  Guide guide;
  guide.along_m = foot_m_;
  guide.backward = backward;
  guide.shift_in_m = shift_m() - foot_m_;
  const double heading = heading_rad(foot_m_);
  const Vec2 off = X_WA.position() - point(foot_m_);
  guide.cross_m = -std::sin(heading) * off.x() + std::cos(heading) * off.y();
  guide.ahead_m = off.dot(Vec2(std::cos(X_WA.yaw_rad), std::sin(X_WA.yaw_rad)));
  const Vec2 goal_A = X_WA.inverse() * goal(lookahead_m);
  guide.bearing_rad = std::atan2(goal_A.y(), goal_A.x());
  const double arc = 2 * goal_A.y() / std::max(goal_A.squaredNorm(), 0.25 * lookahead_m * lookahead_m);
  // A goal behind is what a route that runs back on itself leaves: turn round, as tightly as may be.
  guide.curvature = goal_A.x() < 0 ? std::copysign(tightest, goal_A.y()) : std::clamp(arc, -tightest, tightest);
  guide.curvature_ahead = std::abs(guide.curvature);
  for (double s = foot_m_; s < std::min(foot_m_ + 1.5, end - 0.75); s += 0.25) {
    const double turn = wrap_angle(heading_rad(s + 0.75) - heading_rad(s));
    guide.curvature_ahead = std::max(guide.curvature_ahead, std::abs(turn) / 0.75);
  }
  return guide;
}

}  // namespace adit
