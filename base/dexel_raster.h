// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// What base/dexels and base/dexel_union share: corners in whole units, the exact side of an edge, stretches of a column.

#include "base/dexels.h"
#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace adit::dexel {

inline constexpr double units_per_m = 1 << 17;
inline constexpr std::int64_t farthest = std::int64_t{1} << 29;  // units; keeps every product below 2^62
inline constexpr double touch_m = 1e-6;                          // intervals that come this near are one

/// A corner: plan in whole units from the grid's origin, height in metres.
struct Corner {
  std::int64_t x, y;
  double z;
};

/// Twice the signed area of (a, b, p).
inline std::int64_t cross(const Corner& a, const Corner& b, std::int64_t x, std::int64_t y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// 0 where an axis on the edge a->b counts as left of it, else -1: the axis stands at (x + e, y + e^2).
inline std::int64_t tie(const Corner& a, const Corner& b) {
  const bool left = b.y < a.y || (b.y == a.y && b.x > a.x);
  return left ? 0 : -1;
}

/// The axes of the columns in whole units, and which of them lie in a range.
struct Axes {
  std::vector<std::int64_t> x, y;
  std::vector<double> y_units;  // y, and three more

  explicit Axes(const Dexels& like) {
    for (int i = 0; i < like.width; ++i) x.push_back(std::llround((i + 0.5) * like.cell_m * units_per_m));
    for (int j = 0; j < like.height; ++j) y.push_back(std::llround((j + 0.5) * like.cell_m * units_per_m));
    y_units.assign(y.begin(), y.end());
    y_units.resize(y.size() + 3, 0);
  }
};

struct Range {
  int begin, end;
};

/// Indices of the axes within [low, high], a superset by at most one at each end, clipped to the grid.
inline Range axes_within(double low, double high, const Dexels& like, int count) {
  const double per_unit = 1 / (units_per_m * like.cell_m);
  const double first = std::floor(low * per_unit - 0.5);
  const double last = std::ceil(high * per_unit - 0.5);
  return {static_cast<int>(std::clamp(first, 0.0, static_cast<double>(count))),
          static_cast<int>(std::clamp(last + 1, 0.0, static_cast<double>(count)))};
}

inline Range overlap(Range a, Range b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

inline Corner corner_of(const Vec3& p, const Dexels& like) {
  const double x = (p.x() - like.origin.x()) * units_per_m, y = (p.y() - like.origin.y()) * units_per_m;
  if (!(std::abs(x) <= farthest && std::abs(y) <= farthest && std::isfinite(p.z())))
    throw Error("a corner at (" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) +
                ") m is not finite or more than 4 km from the origin of the columns");
  return {std::llround(x), std::llround(y), p.z()};
}

/// Adds a stretch to sorted, disjoint stretches. @return the stretch that holds it now
inline Interval insert(std::vector<Interval>& stretches, Interval added) {
  auto from = stretches.begin();
  while (from != stretches.end() && from->high_m + touch_m < added.low_m) ++from;
  auto to = from;
  for (; to != stretches.end() && to->low_m <= added.high_m + touch_m; ++to) {
    added.low_m = std::min(added.low_m, to->low_m);
    added.high_m = std::max(added.high_m, to->high_m);
  }
  if (from == to) {
    stretches.insert(from, added);
  } else {
    *from = added;
    stretches.erase(from + 1, to);
  }
  return added;
}

/// Fills `into` from a function that says the stretches of column c.
template <typename Stretches>
void fill(Dexels& into, const Stretches& stretches) {
  into.interval.clear();
  into.offset.assign(1, 0);
  into.offset.reserve(into.columns() + 1);
  for (size_t c = 0; c < into.columns(); ++c) {
    for (const Interval& s : stretches(c)) into.interval.push_back(s);
    if (into.interval.size() > std::numeric_limits<std::uint32_t>::max())
      throw Error("too many intervals: take a larger cell");
    into.offset.push_back(static_cast<std::uint32_t>(into.interval.size()));
  }
}

}  // namespace adit::dexel
