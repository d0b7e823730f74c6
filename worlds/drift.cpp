// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/drift.h"

#include "worlds/waves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace adit {
namespace {

constexpr double step_m = 0.5;
constexpr double face_corner_m = 0.7;  // radius of the corners of a dead end
constexpr double face_reach_m = 3;     // of a dead end's plane along its passage
constexpr double past_wall_m = 0.5;    // by which two drifts run past the wall that will part them
constexpr double wall_foot_m = 0.8;    // by which a wall's ends reach into the rock

std::vector<Vec2> resampled(const std::vector<Vec2>& line) {
  std::vector<Vec2> dense{line.front()};
  for (size_t i = 1; i < line.size(); ++i) {
    const int pieces = std::max(1, static_cast<int>(std::ceil((line[i] - line[i - 1]).norm() / step_m)));
    for (int k = 1; k <= pieces; ++k) dense.push_back(line[i - 1] + (line[i] - line[i - 1]) * k / pieces);
  }
  return dense;
}

// Corners cut three times (Chaikin 1974): the ways between two nodes are driven round.
std::vector<Vec2> rounded(std::vector<Vec2> line) {
  for (int round = 0; round < 3 && line.size() > 2; ++round) {
    std::vector<Vec2> cut{line.front()};
    for (size_t i = 0; i + 1 < line.size(); ++i) {
      if (i > 0) cut.push_back(0.75 * line[i] + 0.25 * line[i + 1]);
      if (i + 2 < line.size()) cut.push_back(0.25 * line[i] + 0.75 * line[i + 1]);
    }
    cut.push_back(line.back());
    line = cut;
  }
  return line;
}

std::vector<double> arc_length(const std::vector<Vec2>& line) {
  std::vector<double> s(line.size(), 0.0);
  for (size_t i = 1; i < line.size(); ++i) s[i] = s[i - 1] + (line[i] - line[i - 1]).norm();
  return s;
}

double smooth_step(double x) {
  x = std::clamp(x, 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

struct Walls {
  Waves left, right;
};

// Half widths along a drift: its own width and its ribs' wander in the middle, the nodes' widths at the ends.
void draw_walls(Drift& d, double width, double width_a, double width_b, const Walls& walls) {
  const std::vector<double> s = arc_length(d.line);
  const double blend = std::min(5.0, 0.4 * s.back());
  for (size_t i = 0; i < d.line.size(); ++i) {
    const double from_a = smooth_step(s[i] / blend), from_b = smooth_step((s.back() - s[i]) / blend);
    const double mean = width * from_a * from_b + width_a * (1 - from_a) + width_b * (1 - from_b);
    d.left.push_back(0.5 * mean + from_a * from_b * walls.left(d.line[i]));
    d.right.push_back(0.5 * mean + from_a * from_b * walls.right(d.line[i]));
  }
}

// The corner in which two half planes meet, rounded by a circle; exact away from it.
double rounded_max(double a, double b, double radius) {
  const double u = std::max(radius + a, 0.0), v = std::max(radius + b, 0.0);
  return std::min(-radius, std::max(a, b)) + std::hypot(u, v);
}

}  // namespace

double Drift::width_m() const {
  double sum = 0;
  for (size_t i = 0; i < left.size(); ++i) sum += left[i] + right[i];
  return sum / static_cast<double>(left.size());
}

std::vector<Drift> drive_passages(const MinePlan& plan, const WorldSettings& s, std::uint64_t seed) {
  const Waves::Spectrum wander{s.wander_m, s.wander_length_m / 4, 1.5, 0, 64, 2.5};
  const Waves east(wander, seed, Draw::world_wander, 0, true), north(wander, seed, Draw::world_wander, 1, true);
  const Waves::Spectrum wall{s.wall_wander_m, 2, 1.5, 3, 64, 2.5};
  const Walls walls{{wall, seed, Draw::world_wander, 2, true}, {wall, seed, Draw::world_wander, 3, true}};

  std::vector<double> width(plan.passages.size()), at_node(plan.nodes.size(), 0.0);
  std::vector<int> degree(plan.nodes.size(), 0);
  for (size_t i = 0; i < plan.passages.size(); ++i) {
    const double off = s.width_sd_m * std::clamp(normal(seed, Draw::world_width, i), -2.5, 2.5);
    width[i] = std::max(0.8 * plan.passages[i].width_m, plan.passages[i].width_m + off);
    for (int node : {plan.passages[i].a, plan.passages[i].b}) {
      at_node[node] += width[i];
      ++degree[node];
    }
  }
  for (size_t n = 0; n < at_node.size(); ++n) at_node[n] /= std::max(1, degree[n]);

  std::vector<Drift> drifts;
  for (size_t i = 0; i < plan.passages.size(); ++i) {
    const PlanPassage& p = plan.passages[i];
    Drift d;
    d.line = resampled(rounded(p.line));
    for (Vec2& q : d.line) q += Vec2(east(q), north(q));
    d.flat_a = degree[p.a] == 1;
    d.flat_b = degree[p.b] == 1;
    draw_walls(d, width[i], at_node[p.a], at_node[p.b], walls);
    drifts.push_back(std::move(d));
  }
  for (const PlanWall& w : plan.walls) {
    for (size_t i = 0; i < drifts.size(); ++i) {
      for (int node : {w.a, w.b}) {
        if (plan.passages[i].a == node) drifts[i].face_a_m += w.thick_m + past_wall_m;
        if (plan.passages[i].b == node) drifts[i].face_b_m += w.thick_m + past_wall_m;
      }
    }
  }
  return drifts;
}

double Wall::distance(const Vec2& p) const {
  const Vec2 w = p - middle;
  const bool beside = std::abs(along.x() * w.y() - along.y() * w.x()) > 0.5 * wide_m;
  return beside ? std::numeric_limits<double>::infinity() : std::abs(w.dot(along)) - 0.5 * thick_m;
}

std::vector<Wall> walls_of(const MinePlan& plan, const std::vector<Drift>& drifts) {
  struct End {  // where a node came to lie, how wide the passage is there
    Vec2 p = Vec2::Zero();
    double width_m = 0;
  };
  std::map<int, End> end;
  for (const PlanWall& w : plan.walls) end[w.a] = end[w.b] = {};
  for (size_t i = 0; i < drifts.size(); ++i) {
    const Drift& d = drifts[i];
    if (const auto a = end.find(plan.passages[i].a); a != end.end())
      a->second = {d.line.front(), d.left.front() + d.right.front()};
    if (const auto b = end.find(plan.passages[i].b); b != end.end())
      b->second = {d.line.back(), d.left.back() + d.right.back()};
  }
  std::vector<Wall> walls;
  for (const PlanWall& w : plan.walls) {
    const auto& [a, width_a] = end[w.a];
    const auto& [b, width_b] = end[w.b];
    walls.push_back({0.5 * (a + b), (b - a).normalized(), w.thick_m, std::max(width_a, width_b) + 2 * wall_foot_m});
  }
  return walls;
}

double beyond_end(const Drift& d, bool at_b, const Vec2& p) {
  const size_t n = d.line.size();
  const Vec2 end = at_b ? d.line[n - 1] : d.line[0];
  const Vec2 before = at_b ? d.line[n - 1 - std::min<size_t>(n - 1, 4)] : d.line[std::min<size_t>(n - 1, 4)];
  return (p - end).dot((end - before).normalized()) - (at_b ? d.face_b_m : d.face_a_m);
}

double signed_distance(const Drift& d, size_t k, const Vec2& p) {
  const Vec2 a = d.line[k], u = d.line[k + 1] - a, w = p - a;
  const double along = w.dot(u) / u.squaredNorm(), t = std::clamp(along, 0.0, 1.0);
  const double across = (u.x() * w.y() - u.y() * w.x()) / u.norm();
  const std::vector<double>& half = across > 0 ? d.left : d.right;
  const size_t last = d.line.size() - 2;
  // Beyond a dead end's node the ribs run on to the face.
  const bool runs_on = (d.flat_a && k == 0 && along < 0) || (d.flat_b && k == last && along > 1);
  double distance = (runs_on ? std::abs(across) : (w - t * u).norm()) - (half[k] + t * (half[k + 1] - half[k]));
  const auto reach = static_cast<size_t>(face_reach_m / step_m);
  if (d.flat_a && k < reach) distance = rounded_max(distance, beyond_end(d, false, p), face_corner_m);
  if (d.flat_b && k + reach > last) distance = rounded_max(distance, beyond_end(d, true, p), face_corner_m);
  return distance;
}

}  // namespace adit
