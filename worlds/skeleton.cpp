// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/skeleton.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace adit {
namespace {

constexpr int stride = 2;             // of the depth's lattice
constexpr double least_half_m = 0.6;  // of a void that counts as a way
constexpr double step_m = 0.5;        // of the drifts' points

struct Mask {
  int width = 0, height = 0;
  std::vector<char> on;  // a border of nodes is off
  char at(int i, int j) const { return on[static_cast<size_t>(j) * width + i]; }
};

// The eight neighbours, counter-clockwise from the right.
constexpr std::array<std::array<int, 2>, 8> around{
    {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}}};

Mask mask_of(const Lattice& depth) {
  Mask m{depth.width / stride, depth.height / stride, {}};
  m.on.assign(static_cast<size_t>(m.width) * m.height, 0);
  for (int j = 1; j + 1 < m.height; ++j)
    for (int i = 1; i + 1 < m.width; ++i)
      m.on[static_cast<size_t>(j) * m.width + i] = depth.value[depth.index(i * stride, j * stride)] < -least_half_m;
  return m;
}

// Whether a node may go in one of the two half steps.
bool goes(const Mask& m, int i, int j, bool second) {
  std::array<char, 8> n{};
  int count = 0, turns = 0;
  for (int k = 0; k < 8; ++k) count += n[k] = m.at(i + around[k][0], j + around[k][1]);
  for (int k = 0; k < 8; ++k) turns += !n[k] && n[(k + 1) % 8];
  if (count < 2 || count > 6 || turns != 1) return false;
  const bool east = n[0], north = n[2], west = n[4], south = n[6];
  return second ? !(north && east && west) && !(north && south && west)
                : !(north && east && south) && !(east && south && west);
}

void thin(Mask& m) {
  std::vector<size_t> alive;
  for (size_t n = 0; n < m.on.size(); ++n)
    if (m.on[n]) alive.push_back(n);
  for (bool changed = true; changed;) {
    changed = false;
    for (bool second : {false, true}) {
      std::vector<size_t> gone;
      for (size_t n : alive)
        if (m.on[n] && goes(m, static_cast<int>(n % m.width), static_cast<int>(n / m.width), second)) gone.push_back(n);
      for (size_t n : gone) m.on[n] = 0;
      changed = changed || !gone.empty();
    }
    std::erase_if(alive, [&](size_t n) { return !m.on[n]; });
  }
}

class Tracer {
 public:
  Tracer(const Lattice& depth, Mask mask)
      : depth_(depth), m_(std::move(mask)), node_(m_.on.size(), -1), seen_(m_.on.size(), 0) {}

  MinePlan trace() {
    for (size_t n = 0; n < m_.on.size(); ++n)
      if (m_.on[n] && node_[n] < 0 && neighbours(n).size() != 2) add_cluster(n);
    for (size_t n = 0; n < m_.on.size(); ++n)
      if (node_[n] >= 0) leave(n);
    for (size_t n = 0; n < m_.on.size(); ++n) {  // rings without a junction
      if (!m_.on[n] || node_[n] >= 0 || seen_[n]) continue;
      add_cluster(n);
      leave(n);
    }
    return std::move(plan_);
  }

 private:
  std::vector<size_t> neighbours(size_t n) const {
    std::vector<size_t> found;
    for (const auto& d : around) {
      const size_t next = n + d[0] + static_cast<std::ptrdiff_t>(d[1]) * m_.width;
      if (m_.on[next]) found.push_back(next);
    }
    return found;
  }
  Vec2 at(size_t n) const {
    return depth_.node(static_cast<int>(n % m_.width) * stride, static_cast<int>(n / m_.width) * stride);
  }

  // Pixels of junctions that touch are one node, in their middle.
  void add_cluster(size_t first) {
    const int id = static_cast<int>(plan_.nodes.size());
    std::vector<size_t> stack{first};
    node_[first] = id;
    Vec2 sum = Vec2::Zero();
    double count = 0;
    while (!stack.empty()) {
      const size_t n = stack.back();
      stack.pop_back();
      sum += at(n);
      ++count;
      if (neighbours(n).size() < 3) continue;
      for (size_t next : neighbours(n)) {
        if (node_[next] >= 0 || neighbours(next).size() < 3) continue;
        node_[next] = id;
        stack.push_back(next);
      }
    }
    plan_.nodes.push_back(sum / count);
    plan_.cut.push_back(0);
  }

  void leave(size_t from) {
    for (size_t first : neighbours(from)) {
      if (node_[first] >= 0) {
        if (node_[first] > node_[from]) add(node_[from], node_[first], {});
        continue;
      }
      if (seen_[first]) continue;
      std::vector<Vec2> line;
      size_t before = from, here = first;
      while (node_[here] < 0) {
        seen_[here] = 1;
        line.push_back(at(here));
        size_t next = before;
        for (size_t n : neighbours(here))
          if (n != before && !(seen_[n]) && (next == before || node_[n] >= 0)) next = n;
        if (next == before) break;
        before = here;
        here = next;
      }
      if (node_[here] >= 0) add(node_[from], node_[here], line);
    }
  }

  void add(int a, int b, const std::vector<Vec2>& line) {
    PlanPassage p{a, b, 0, {plan_.nodes[a]}};
    p.line.insert(p.line.end(), line.begin(), line.end());
    p.line.push_back(plan_.nodes[b]);
    plan_.passages.push_back(std::move(p));
  }

  const Lattice& depth_;
  Mask m_;
  std::vector<int> node_;
  std::vector<char> seen_;
  MinePlan plan_;
};

double length_of(const std::vector<Vec2>& line) {
  double length = 0;
  for (size_t i = 1; i < line.size(); ++i) length += (line[i] - line[i - 1]).norm();
  return length;
}

std::vector<int> degrees(const MinePlan& plan) {
  std::vector<int> degree(plan.nodes.size(), 0);
  for (const PlanPassage& p : plan.passages) {
    ++degree[p.a];
    ++degree[p.b];
  }
  return degree;
}

double half_at(const Lattice& depth, const Vec2& p) {
  return std::max(least_half_m, -depth.at(p));
}

// Thinning leaves knots of a few nodes; a way round real rock is longer than the rock's rounded corners allow.
bool drop_knot(MinePlan& plan, const Lattice& depth) {
  const auto knot = std::find_if(plan.passages.begin(), plan.passages.end(), [&](const PlanPassage& p) {
    return p.a == p.b && length_of(p.line) < 4 + 2 * half_at(depth, plan.nodes[p.a]);
  });
  if (knot == plan.passages.end()) return false;
  plan.passages.erase(knot);
  return true;
}

// Joins the two passages at a node that nothing else meets.
bool join_through(MinePlan& plan) {
  const std::vector<int> degree = degrees(plan);
  for (size_t i = 0; i < plan.passages.size(); ++i) {
    for (size_t k = i + 1; k < plan.passages.size(); ++k) {
      PlanPassage &p = plan.passages[i], &q = plan.passages[k];
      const int shared = p.b == q.a || p.b == q.b ? p.b : p.a == q.a || p.a == q.b ? p.a : -1;
      if (shared < 0 || degree[shared] != 2 || p.a == p.b || q.a == q.b) continue;
      if (p.a == shared) std::swap(p.a, p.b), std::reverse(p.line.begin(), p.line.end());
      if (q.b == shared) std::swap(q.a, q.b), std::reverse(q.line.begin(), q.line.end());
      if (p.a == q.b && degree[p.a] == 2) continue;  // a ring: two nodes are kept
      p.b = q.b;
      p.line.insert(p.line.end(), q.line.begin() + 1, q.line.end());
      plan.passages.erase(plan.passages.begin() + static_cast<std::ptrdiff_t>(k));
      return true;
    }
  }
  return false;
}

// Takes off the shortest spur that does not lead out of its junction's width.
bool take_spur(MinePlan& plan, const Lattice& depth) {
  const std::vector<int> degree = degrees(plan);
  size_t shortest = plan.passages.size();
  double least = 1e300;
  for (size_t i = 0; i < plan.passages.size() && plan.passages.size() > 1; ++i) {
    const PlanPassage& p = plan.passages[i];
    if ((degree[p.a] == 1) == (degree[p.b] == 1)) continue;
    const double length = length_of(p.line);
    if (length > 1.5 * half_at(depth, plan.nodes[degree[p.a] == 1 ? p.b : p.a]) + 1 || length >= least) continue;
    least = length;
    shortest = i;
  }
  if (shortest == plan.passages.size()) return false;
  plan.passages.erase(plan.passages.begin() + static_cast<std::ptrdiff_t>(shortest));
  return true;
}

// Two junctions of which one lies in the other's width become one, in their middle.
bool unite_junctions(MinePlan& plan, const Lattice& depth) {
  const std::vector<int> degree = degrees(plan);
  for (size_t i = 0; i < plan.passages.size(); ++i) {
    const PlanPassage p = plan.passages[i];
    if (p.a == p.b || degree[p.a] < 3 || degree[p.b] < 3) continue;
    if (length_of(p.line) > std::max(half_at(depth, plan.nodes[p.a]), half_at(depth, plan.nodes[p.b]))) continue;
    const Vec2 middle = 0.5 * (plan.nodes[p.a] + plan.nodes[p.b]);
    plan.nodes[p.a] = middle;
    plan.passages.erase(plan.passages.begin() + static_cast<std::ptrdiff_t>(i));
    for (PlanPassage& q : plan.passages) {
      if (q.a == p.b) q.a = p.a;
      if (q.b == p.b) q.b = p.a;
      if (q.a == p.a) q.line.front() = middle;
      if (q.b == p.a) q.line.back() = middle;
    }
    return true;
  }
  return false;
}

// A passage from a node back to it is two that meet half way.
void split_rings(MinePlan& plan) {
  for (size_t i = 0, n = plan.passages.size(); i < n; ++i) {
    PlanPassage& p = plan.passages[i];
    if (p.a != p.b) continue;
    const auto half = static_cast<std::ptrdiff_t>(p.line.size() / 2);
    PlanPassage second{static_cast<int>(plan.nodes.size()), p.b, 0, {p.line.begin() + half, p.line.end()}};
    plan.nodes.push_back(p.line[half]);
    plan.cut.push_back(0);
    p.b = second.a;
    p.line.resize(half + 1);
    plan.passages.push_back(std::move(second));
  }
}

void drop_unused_nodes(MinePlan& plan) {
  const std::vector<int> degree = degrees(plan);
  std::vector<int> id(plan.nodes.size(), -1);
  MinePlan kept;
  for (size_t n = 0; n < plan.nodes.size(); ++n) {
    if (degree[n] == 0) continue;
    id[n] = static_cast<int>(kept.nodes.size());
    kept.nodes.push_back(plan.nodes[n]);
    kept.cut.push_back(plan.cut[n]);
  }
  for (PlanPassage& p : plan.passages) {
    p.a = id[p.a];
    p.b = id[p.b];
  }
  kept.passages = std::move(plan.passages);
  plan = std::move(kept);
}

// Stairs of the lattice are smoothed over about two metres; the ends stay.
std::vector<Vec2> smoothed(std::vector<Vec2> line) {
  for (int round = 0; round < 12; ++round) {
    std::vector<Vec2> next = line;
    for (size_t i = 1; i + 1 < line.size(); ++i) next[i] = 0.25 * line[i - 1] + 0.5 * line[i] + 0.25 * line[i + 1];
    line = std::move(next);
  }
  return line;
}

// Thinning is good to a node of its lattice: points are moved across the line to where they are farthest from the ribs.
std::vector<Vec2> centred(const std::vector<Vec2>& line, const Lattice& depth) {
  std::vector<Vec2> moved = line;
  for (size_t i = 1; i + 1 < line.size(); ++i) {
    const Vec2 along = line[std::min(line.size() - 1, i + 3)] - line[i - std::min<size_t>(i, 3)];
    if (along.norm() < 1e-6) continue;
    const Vec2 across = Vec2(-along.y(), along.x()).normalized();
    double most = -depth.at(line[i]);
    for (double t = -0.4; t < 0.45; t += 0.1) {
      const double here = -depth.at(line[i] + t * across);
      if (here <= most + 1e-9) continue;
      most = here;
      moved[i] = line[i] + t * across;
    }
  }
  return moved;
}

Drift drift_along(const std::vector<Vec2>& line, const Lattice& depth) {
  const double length = length_of(line);
  const int n = std::max(2, static_cast<int>(std::lround(length / step_m)));
  Drift d;
  double behind = 0;
  size_t i = 0;
  for (int k = 0; k <= n; ++k) {
    const double s = length * k / n;
    while (i + 2 < line.size() && behind + (line[i + 1] - line[i]).norm() < s)
      behind += (line[i + 1] - line[i]).norm(), ++i;
    const double t = std::clamp((s - behind) / std::max(1e-9, (line[i + 1] - line[i]).norm()), 0.0, 1.0);
    d.line.push_back(line[i] + t * (line[i + 1] - line[i]));
    d.left.push_back(half_at(depth, d.line.back()));
  }
  d.line.back() = line.back();
  d.right = d.left;
  return d;
}

}  // namespace

Skeleton skeleton_of(const Lattice& depth) {
  Mask mask = mask_of(depth);
  thin(mask);
  MinePlan plan = Tracer(depth, std::move(mask)).trace();
  for (bool changed = true; changed;) {
    changed = false;
    while (drop_knot(plan, depth)) changed = true;
    while (take_spur(plan, depth)) changed = true;
    while (join_through(plan)) changed = true;
    while (unite_junctions(plan, depth)) changed = true;
  }
  split_rings(plan);
  drop_unused_nodes(plan);
  if (plan.passages.empty())
    throw Error("world.plan: the polygons leave no way of " + std::to_string(2 * least_half_m) + " m width or more");
  Skeleton skeleton;
  for (PlanPassage& p : plan.passages) {
    p.line = smoothed(centred(p.line, depth));
    skeleton.drifts.push_back(drift_along(p.line, depth));
    p.width_m = skeleton.drifts.back().width_m();
  }
  skeleton.plan = std::move(plan);
  return skeleton;
}

}  // namespace adit
