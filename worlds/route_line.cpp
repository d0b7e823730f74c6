// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/route_graph.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double step_m = 0.25;
constexpr double fine_m = 0.05;
constexpr double off_face_m = 1.3;        // from a dead end's, a route begins and ends: a vehicle stands there
constexpr double rib_clearance_m = 0.75;  // of the middle of a turn-about's line
constexpr double at_junction_m = 1;       // before a junction that is turned round at: about it nothing stands
// A three-point turn, of arcs of 60 degrees: what a vehicle's corners need across beside the arcs' own width, which is
// their radius; ahead of the foremost point of the line; and the least radius.
constexpr double swing_m = 2.6, nose_m = 1.5, tight_m = 0.5;

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

// Forward to one side, tail first to the other, forward again: it ends where it began, the other way round. Marks the
// points at which the direction changes.
void add_three_point_turn(const Track& in, double at, double radius, std::vector<Vec2>& out,
                          std::vector<size_t>& shifts) {
  const Vec2 p = in.at(at), t = in.direction(at), left(-t.y(), t.x());
  const auto place = [&](double ahead, double aside) -> Vec2 { return p + radius * (ahead * t + aside * left); };
  const auto toward = [&](double rad) -> Vec2 { return std::cos(rad) * t + std::sin(rad) * left; };
  constexpr double third = std::numbers::pi / 3;
  const double reach = std::sin(third);
  add_arc(p, t, place(reach, 0.5), out);
  shifts.push_back(out.size() - 1);
  add_arc(place(reach, 0.5), -toward(third), place(reach, -0.5), out);
  shifts.push_back(out.size() - 1);
  add_arc(place(reach, -0.5), toward(2 * third), p, out);
}

void add_evenly(const std::vector<Vec2>& points, std::vector<Vec2>& line) {
  const Track track(points);
  const int n = std::max(1, static_cast<int>(std::lround(track.length() / step_m)));
  for (int k = line.empty() ? 0 : 1; k <= n; ++k) line.push_back(track.at(track.length() * k / n));
}

// Points at even distances between the shifts, every second stretch driven backwards.
Route evenly(const std::vector<Vec2>& points, const std::vector<size_t>& shifts) {
  Route route;
  auto from = points.begin();
  for (size_t k = 0; k <= shifts.size(); ++k) {
    const auto to = k < shifts.size() ? points.begin() + static_cast<std::ptrdiff_t>(shifts[k]) : points.end() - 1;
    const int first = static_cast<int>(route.line.size()) - 1;
    add_evenly({from, to + 1}, route.line);
    if (k % 2) route.backwards.push_back({first, static_cast<int>(route.line.size()) - 1});
    from = to;
  }
  return route;
}

// What a leg leaves of its length for what follows it, from its end: where the turn or the corner begins.
struct Corner {
  double radius, tangent_m, drift_m;
};
enum class Turn { none, at_face, at_junction };  // round, at a leg's end

Corner corner_of(const Passage& passage, const Track& track, const Track* next, Turn about, const RouteSettings& s) {
  if (about != Turn::none && s.turn == "three_point") {
    const double room = std::min(passage.width_m - swing_m, (0.9 * track.length() - nose_m) / 0.87);
    const double radius = std::clamp(room, tight_m, std::max(tight_m, s.turn_radius_m));
    return {radius, std::min(0.87 * radius + nose_m, 0.9 * track.length()), 0};
  }
  if (about != Turn::none) {
    const double radius = std::min(s.turn_radius_m, 0.5 * passage.width_m - rib_clearance_m);
    const double before = about == Turn::at_face ? 2 + radius : at_junction_m;
    return {radius, std::min(before, 0.3 * track.length()), std::min(3.0, 0.3 * track.length())};
  }
  return {s.turn_radius_m, next ? tangent_m(track, *next, s.turn_radius_m) : 0, 0};
}

}  // namespace

Route route_along(const World& world, const std::vector<Leg>& legs, const RouteSettings& s) {
  std::vector<Track> tracks;
  for (const Leg& leg : legs) tracks.push_back(track_of(world, leg));
  const auto off_face = [&](int junction, const Track& track) {
    return world.junctions[static_cast<size_t>(junction)].degree() == 1 ? std::min(off_face_m, 0.3 * track.length())
                                                                        : 0;
  };
  double begin = off_face(from_of(world, legs.front()), tracks.front());
  std::vector<Vec2> points{tracks.front().at(begin)};
  std::vector<size_t> shifts;
  for (size_t i = 0; i < legs.size(); ++i) {
    const Track& track = tracks[i];
    const Track* next = i + 1 < legs.size() ? &tracks[i + 1] : nullptr;
    const bool about = next && legs[i].passage == legs[i + 1].passage && legs[i].forward != legs[i + 1].forward;
    const bool face = world.junctions[static_cast<size_t>(to_of(world, legs[i]))].degree() == 1;
    const Turn turn = !about ? Turn::none : face ? Turn::at_face : Turn::at_junction;
    const auto [radius, tangent, drift] = corner_of(world.passages[legs[i].passage], track, next, turn, s);
    const double end = track.length() - (next ? tangent + drift : off_face(to_of(world, legs[i]), track));
    for (double at = begin + fine_m; at < end; at += fine_m) points.push_back(track.at(at));
    points.push_back(track.at(end));
    begin = tangent + drift;
    if (about && s.turn == "three_point") {
      add_three_point_turn(track, end, radius, points, shifts);
    } else if (about && s.turn == "in_place") {
      points.push_back(track.at(end + drift));
      for (double at = end + drift - fine_m; at > end; at -= fine_m) points.push_back(track.at(at));
      points.push_back(track.at(end));
    } else if (about) {
      add_turn_about(track, end, end + drift, radius, points);
    } else if (next) {
      add_biarc(track.at(end), track.direction(end), next->at(tangent), next->direction(tangent), points);
    }
  }
  Route route = evenly(points, shifts);
  for (const Leg& leg : legs) route.passages.push_back(leg.passage);
  for (size_t i = 1; i < route.line.size(); ++i) route.length_m += (route.line[i] - route.line[i - 1]).norm();
  return route;
}

}  // namespace adit
