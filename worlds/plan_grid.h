// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace adit {

struct Box3 {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  void add(const Vec3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  bool meets(const Box3& o) const {
    return (low.array() <= o.high.array()).all() && (o.low.array() <= high.array()).all();
  }
};

inline Box3 box_of(const std::vector<Vec3>& vertex, const std::array<std::uint32_t, 3>& face) {
  Box3 b;
  for (std::uint32_t v : face) b.add(vertex[v]);
  return b;
}

inline Box3 box_of(const Solid& s) {
  Box3 b;
  for (const Vec3& v : s.vertex) b.add(v);
  return b;
}

/// Squares of the plan, each with the items whose boxes reach into it.
struct PlanGrid {
  Vec2 low = Vec2::Zero();
  double cell_m = 0.5;
  long nx = 0, ny = 0;
  std::vector<std::uint32_t> begin, item;

  /// @param box_of  of item 0 .. n - 1, within from .. to
  template <class F>
  void build(const Vec2& from, const Vec2& to, double cell, size_t n, const F& box_of);
  /// Items whose cells meet a box; some come several times.
  template <class F>
  void for_near(const Vec2& from, const Vec2& to, const F& f) const;
};

template <class F>
void PlanGrid::build(const Vec2& from, const Vec2& to, double cell, size_t n, const F& box) {
  low = from;
  cell_m = cell;
  nx = static_cast<long>((to.x() - from.x()) / cell) + 1;
  ny = static_cast<long>((to.y() - from.y()) / cell) + 1;
  begin.assign(static_cast<size_t>(nx * ny) + 1, 0);
  const auto each = [&](auto&& take) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const Box3 b = box(i);
      const Vec2 f = (b.low.head<2>() - low) / cell_m, t = (b.high.head<2>() - low) / cell_m;
      for (long y = static_cast<long>(f.y()); y <= static_cast<long>(t.y()); ++y)
        for (long x = static_cast<long>(f.x()); x <= static_cast<long>(t.x()); ++x)
          take(static_cast<size_t>(y * nx + x), i);
    }
  };
  each([&](size_t c, std::uint32_t) { ++begin[c + 1]; });
  for (size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  item.resize(begin.back());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  each([&](size_t c, std::uint32_t i) { item[next[c]++] = i; });
}

template <class F>
void PlanGrid::for_near(const Vec2& from, const Vec2& to, const F& f) const {
  const auto at = [&](double v, long n) { return std::clamp(static_cast<long>(std::floor(v / cell_m)), 0L, n - 1); };
  for (long y = at(from.y() - low.y(), ny); y <= at(to.y() - low.y(), ny); ++y)
    for (long x = at(from.x() - low.x(), nx); x <= at(to.x() - low.x(), nx); ++x)
      for (std::uint32_t i = begin[static_cast<size_t>(y * nx + x)]; i < begin[static_cast<size_t>(y * nx + x) + 1];
           ++i)
        f(item[i]);
}

/// Squares in which bodies are looked up.
inline std::pair<long, long> cell_of(const Vec2& p) {
  constexpr double cell_m = 2;
  return {std::lround(std::floor(p.x() / cell_m)), std::lround(std::floor(p.y() / cell_m))};
}

}  // namespace adit
