// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/plan.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace adit {
namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

struct Crossing {
  size_t segment_p, segment_q;
  Vec2 point;
};

// Where the inside of one line meets another one, away from the ends that they may share.
std::optional<Crossing> crossing_of(const std::vector<Vec2>& p, const std::vector<Vec2>& q) {
  for (size_t i = 0; i + 1 < p.size(); ++i) {
    for (size_t j = 0; j + 1 < q.size(); ++j) {
      const Vec2 u = p[i + 1] - p[i], v = q[j + 1] - q[j], w = q[j] - p[i];
      const double det = cross(u, v);
      if (std::abs(det) < 1e-9 * u.norm() * v.norm()) continue;
      const double s = cross(w, v) / det, t = cross(w, u) / det;
      if (s < 0 || s > 1 || t < 0 || t > 1) continue;
      const Vec2 x = p[i] + s * u;
      double to_end = 1e300;
      for (const Vec2& end : {p.front(), p.back(), q.front(), q.back()}) to_end = std::min(to_end, (x - end).norm());
      if (to_end > 1e-6) return Crossing{i, j, x};
    }
  }
  return std::nullopt;
}

// Cuts passage k at a point of its segment; the second half goes to the end of the list.
void split(MinePlan& plan, size_t k, size_t segment, const Vec2& point, int node) {
  PlanPassage first = plan.passages[k], second = first;
  first.line.resize(segment + 1);
  first.line.push_back(point);
  first.b = node;
  second.line.erase(second.line.begin(), second.line.begin() + static_cast<std::ptrdiff_t>(segment) + 1);
  second.line.insert(second.line.begin(), point);
  second.a = node;
  plan.passages[k] = first;
  plan.passages.push_back(second);
}

struct Span {
  Vec2 low{1e300, 1e300}, high{-1e300, -1e300};
  bool meets(const Span& o) const {
    const double near_m = 1e-6;
    return low.x() <= o.high.x() + near_m && o.low.x() <= high.x() + near_m && low.y() <= o.high.y() + near_m &&
           o.low.y() <= high.y() + near_m;
  }
};

std::vector<Span> spans_of(const MinePlan& plan) {
  std::vector<Span> spans(plan.passages.size());
  for (size_t k = 0; k < spans.size(); ++k) {
    for (const Vec2& p : plan.passages[k].line) {
      spans[k].low = spans[k].low.cwiseMin(p);
      spans[k].high = spans[k].high.cwiseMax(p);
    }
  }
  return spans;
}

bool split_first_crossing(MinePlan& plan) {
  const std::vector<Span> spans = spans_of(plan);
  for (size_t k = 0; k < plan.passages.size(); ++k) {
    for (size_t l = k + 1; l < plan.passages.size(); ++l) {
      if (!spans[k].meets(spans[l])) continue;
      const auto crossing = crossing_of(plan.passages[k].line, plan.passages[l].line);
      if (!crossing) continue;
      const int node = static_cast<int>(plan.nodes.size());
      plan.nodes.push_back(crossing->point);
      plan.cut.push_back(0);
      split(plan, k, crossing->segment_p, crossing->point, node);
      split(plan, l, crossing->segment_q, crossing->point, node);
      return true;
    }
  }
  return false;
}

std::vector<int> parts_of(const MinePlan& plan) {
  std::vector<int> part(plan.nodes.size());
  for (size_t i = 0; i < part.size(); ++i) part[i] = static_cast<int>(i);
  for (bool changed = true; changed;) {
    changed = false;
    for (const PlanPassage& p : plan.passages) {
      const int low = std::min(part[p.a], part[p.b]);
      changed = changed || part[p.a] != low || part[p.b] != low;
      part[p.a] = part[p.b] = low;
    }
  }
  return part;
}

std::string at(const Vec2& p) {
  return "(" + std::to_string(std::lround(p.x())) + ", " + std::to_string(std::lround(p.y())) + ")";
}

void check_connected(const std::string& name, const MinePlan& plan) {
  const std::vector<int> part = parts_of(plan);
  for (size_t i = 1; i < part.size(); ++i)
    if (part[i] != part[0])
      throw Error(name + ": the plan is not connected: no passage leads from the node at " + at(plan.nodes[0]) +
                  " to that at " + at(plan.nodes[i]) +
                  "; select one part (x_min ... y_max) or open the passages between (passages = \"all\")");
}

MinePlan drawn_plan(const WorldSettings& s, std::uint64_t seed) {
  if (s.kind == "panel") return panel_plan(s.panel, seed);
  if (s.kind == "rooms") return rooms_plan(s.rooms, seed);
  if (s.kind == "district") return district_plan(s.district, seed);
  return read_plan(s);
}

}  // namespace

MinePlan split_crossings(MinePlan plan) {
  while (split_first_crossing(plan)) {
  }
  return plan;
}

MinePlan make_plan(const WorldSettings& s, std::uint64_t seed) {
  const bool from_file = s.kind == "plan";
  const std::string name = from_file ? "world.plan = \"" + s.plan + "\"" : "world." + s.kind;
  MinePlan plan = split_crossings(drawn_plan(s, seed));
  if (plan.passages.empty())
    throw Error(name + ": no passage lies in the part that is selected (world.x_min ... world.y_max)");
  check_connected(name, plan);
  return plan;
}

}  // namespace adit
