// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/route_graph.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double step_m = 0.25;
constexpr double fine_m = 0.05;
constexpr double rib_clearance_m = 0.75;  // of the middle of a turn-about's line

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// A line by its length.
class Track {
 public:
  explicit Track(std::vector<Vec2> points) : p_(std::move(points)), s_(p_.size(), 0.0) {
    for (size_t i = 1; i < p_.size(); ++i) s_[i] = s_[i - 1] + (p_[i] - p_[i - 1]).norm();
  }
  double length() const { return s_.back(); }
  Vec2 at(double s) const {
    const size_t i = piece(s);
    const double t = std::clamp((s - s_[i]) / (s_[i + 1] - s_[i]), 0.0, 1.0);
    return p_[i] + t * (p_[i + 1] - p_[i]);
  }
  Vec2 direction(double s) const { return (at(std::min(length(), s + 0.5)) - at(std::max(0.0, s - 0.5))).normalized(); }

 private:
  size_t piece(double s) const {
    const auto above = std::upper_bound(s_.begin(), s_.end(), s);
    return std::clamp<std::ptrdiff_t>(above - s_.begin() - 1, 0, static_cast<std::ptrdiff_t>(s_.size()) - 2);
  }
  std::vector<Vec2> p_;
  std::vector<double> s_;
};

Track track_of(const World& world, const Leg& leg) {
  std::vector<Vec2> points;
  for (const Vec3& v : world.passages[leg.passage].centre_line) points.push_back(v.head<2>());
  if (!leg.forward) std::reverse(points.begin(), points.end());
  return Track(std::move(points));
}

// The arc from p with direction t to q, without p.
void add_arc(const Vec2& p, const Vec2& t, const Vec2& q, std::vector<Vec2>& out) {
  const Vec2 chord = q - p;
  if (chord.norm() < 1e-9) return;
  const double half = std::atan2(cross(t, chord), t.dot(chord));
  const bool straight = std::abs(half) < 1e-6;
  const double radius = straight ? 0 : chord.norm() / (2 * std::sin(half));
  const double length = straight ? chord.norm() : std::abs(2 * half * radius);
  const int n = std::max(1, static_cast<int>(std::ceil(length / fine_m)));
  const Vec2 left(-t.y(), t.x());
  for (int k = 1; k <= n; ++k) {
    const double phi = 2 * half * k / n;
    out.push_back(straight ? Vec2(p + chord * k / n)
                           : Vec2(p + radius * (std::sin(phi) * t + (1 - std::cos(phi)) * left)));
  }
}

// Two arcs that join two points with their directions (biarc with equal tangent lengths: Bolton, "Biarc curves",
// Computer-Aided Design 1975).
void add_biarc(const Vec2& p, const Vec2& tp, const Vec2& q, const Vec2& tq, std::vector<Vec2>& out) {
  const Vec2 v = q - p, t = tp + tq;
  const double turn = 2 * (1 - tp.dot(tq)), b = v.dot(t);
  const double d = turn < 1e-6 ? v.squaredNorm() / (4 * std::max(1e-9, v.dot(tq)))
                               : (-b + std::sqrt(b * b + turn * v.squaredNorm())) / turn;
  const Vec2 joint = 0.5 * ((p + d * tp) + (q - d * tq));
  add_arc(p, tp, joint, out);
  // The direction at the joint is that of the line between the two tangents' ends.
  add_arc(joint, ((q - d * tq) - (p + d * tp)).normalized(), q, out);
}

// How far before and after a junction the rounding begins and ends.
double tangent_m(const Track& in, const Track& out, double radius) {
  const double room = 0.45 * std::min(in.length(), out.length());
  double t = std::min(2.0, room);
  for (int round = 0; round < 3; ++round) {
    const double c = std::clamp(in.direction(in.length() - t).dot(out.direction(t)), -1.0, 1.0);
    t = std::clamp(radius * std::tan(std::acos(c) / 2), std::min(1.0, room), room);
  }
  return t;
}

// About and back again on the line on which one came: out to one side, half a circle, in from the other side.
void add_turn_about(const Track& in, double from, double to, double radius, std::vector<Vec2>& out) {
  const Vec2 t = in.direction(to), left(-t.y(), t.x());
  const Vec2 p = in.at(from), q = in.at(to);
  add_biarc(p, in.direction(from), q - radius * left, t, out);
  add_arc(q - radius * left, t, q + radius * left, out);
  add_biarc(q + radius * left, -t, p, -in.direction(from), out);
}

std::vector<Vec2> evenly(const std::vector<Vec2>& points) {
  const Track track(points);
  const int n = std::max(1, static_cast<int>(std::lround(track.length() / step_m)));
  std::vector<Vec2> line;
  for (int k = 0; k <= n; ++k) line.push_back(track.at(track.length() * k / n));
  return line;
}

}  // namespace

std::vector<Vec2> line_of(const World& world, const std::vector<Leg>& legs, double turn_radius_m, bool turn_in_place) {
  std::vector<Track> tracks;
  for (const Leg& leg : legs) tracks.push_back(track_of(world, leg));
  std::vector<Vec2> points{tracks.front().at(0)};
  double begin = 0;
  for (size_t i = 0; i < legs.size(); ++i) {
    const Track& track = tracks[i];
    const bool last = i + 1 == legs.size();
    const bool about = !last && legs[i].passage == legs[i + 1].passage && legs[i].forward != legs[i + 1].forward;
    const double radius = about
                              ? std::min(turn_radius_m, 0.5 * world.passages[legs[i].passage].width_m - rib_clearance_m)
                              : turn_radius_m;
    const double tangent = last    ? 0
                           : about ? std::min(2 + radius, 0.3 * track.length())
                                   : tangent_m(track, tracks[i + 1], radius);
    const double drift = about ? std::min(3.0, 0.3 * track.length()) : 0;  // along which one moves over to one side
    const double end = track.length() - tangent - drift;
    for (double s = begin + fine_m; s < end; s += fine_m) points.push_back(track.at(s));
    points.push_back(track.at(end));
    if (about && turn_in_place) {
      points.push_back(track.at(end + drift));
      for (double s = end + drift - fine_m; s > end; s -= fine_m) points.push_back(track.at(s));
      points.push_back(track.at(end));
      begin = tangent + drift;
    } else if (about) {
      add_turn_about(track, end, end + drift, radius, points);
      begin = tangent + drift;
    } else if (!last) {
      add_biarc(track.at(end), track.direction(end), tracks[i + 1].at(tangent), tracks[i + 1].direction(tangent),
                points);
      begin = tangent;
    }
  }
  return evenly(points);
}

}  // namespace adit
