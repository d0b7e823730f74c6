// SPDX-License-Identifier: BSD-3-Clause
#include "base/polyline.h"

#include <algorithm>
#include <cstddef>
#include <utility>

namespace adit {
namespace {

double distance_to(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double s = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
  return (p - a - s * d).norm();
}

}  // namespace

std::vector<Vec2> simplified(const std::vector<Vec2>& line, double tolerance_m) {
  if (line.size() < 3) return line;
  std::vector<char> keep(line.size(), 0);
  keep.front() = keep.back() = 1;
  std::vector<std::pair<size_t, size_t>> todo = {{0, line.size() - 1}};
  while (!todo.empty()) {
    const auto [a, b] = todo.back();
    todo.pop_back();
    size_t far = a;
    double most = tolerance_m;
    for (size_t k = a + 1; k < b; ++k) {
      const double d = distance_to(line[k], line[a], line[b]);
      if (d > most) most = d, far = k;
    }
    if (far == a) continue;
    keep[far] = 1;
    todo.insert(todo.end(), {{a, far}, {far, b}});
  }
  std::vector<Vec2> kept;
  for (size_t k = 0; k < line.size(); ++k)
    if (keep[k]) kept.push_back(line[k]);
  return kept;
}

double signed_area(const std::vector<Vec2>& ring) {
  double twice = 0;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

bool contains(const std::vector<Vec2>& ring, const Vec2& p) {
  bool inside = false;
  for (size_t k = 0; k < ring.size(); ++k) {
    const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
    if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      inside = !inside;
  }
  return inside;
}

}  // namespace adit
