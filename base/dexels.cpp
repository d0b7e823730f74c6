// SPDX-License-Identifier: BSD-3-Clause
#include "base/dexels.h"

#include "base/dexel_raster.h"
#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace adit {

using namespace dexel;

namespace {

constexpr int band_rows = 32;

/// found(i, j, z, up): the axis (i, j) crosses the face abc at height z; up = the face is counter-clockwise from above.
template <typename Found>
void crossings(Corner a, Corner b, Corner c, const Dexels& like, const Axes& axes, Range columns, Range rows,
               Found&& found) {
  std::int64_t area = cross(a, b, c.x, c.y);
  if (area == 0) return;
  const bool up = area > 0;
  if (!up) {
    std::swap(b, c);
    area = -area;
  }
  const auto [x_low, x_high] = std::minmax({a.x, b.x, c.x});
  const auto [y_low, y_high] = std::minmax({a.y, b.y, c.y});
  columns = overlap(columns, axes_within(static_cast<double>(x_low), static_cast<double>(x_high), like, like.width));
  rows = overlap(rows, axes_within(static_cast<double>(y_low), static_cast<double>(y_high), like, like.height));
  const std::int64_t tie_a = tie(b, c), tie_b = tie(c, a), tie_c = tie(a, b);
  const double scale = 1 / static_cast<double>(area);
  for (int j = rows.begin; j < rows.end; ++j)
    for (int i = columns.begin; i < columns.end; ++i) {
      const std::int64_t x = axes.x[i], y = axes.y[j];
      const std::int64_t wa = cross(b, c, x, y), wb = cross(c, a, x, y), wc = cross(a, b, x, y);
      if (((wa + tie_a) | (wb + tie_b) | (wc + tie_c)) < 0) continue;
      const double z =
          (static_cast<double>(wa) * a.z + static_cast<double>(wb) * b.z + static_cast<double>(wc) * c.z) * scale;
      found(i, j, z, up);
    }
}

void check_same_grid(const Dexels& a, const Dexels& b) {
  ADIT_CHECK(a.cell_m == b.cell_m && a.origin == b.origin && a.width == b.width && a.height == b.height);
}

/// Where wanted(in a, in b) holds, column by column.
template <typename Wanted>
Dexels combine(const Dexels& a, const Dexels& b, const Wanted& wanted) {
  check_same_grid(a, b);
  Dexels result = a;
  std::vector<Interval> out;
  fill(result, [&](size_t c) -> std::span<const Interval> {
    const auto sa = a.column(c), sb = b.column(c);
    out.clear();
    const auto edge = [](std::span<const Interval> s, size_t k) {
      if (k >= 2 * s.size()) return std::numeric_limits<double>::infinity();
      return k % 2 == 0 ? s[k / 2].low_m : s[k / 2].high_m;
    };
    size_t ka = 0, kb = 0;  // edges passed; odd = inside
    bool inside = false;
    while (ka < 2 * sa.size() || kb < 2 * sb.size()) {
      const double z = std::min(edge(sa, ka), edge(sb, kb));
      while (edge(sa, ka) == z) ++ka;
      while (edge(sb, kb) == z) ++kb;
      const bool now = wanted(ka % 2 == 1, kb % 2 == 1);
      if (now && !inside) out.push_back({z, z});
      if (!now && inside) out.back().high_m = z;
      inside = now;
    }
    return out;
  });
  return result;
}

}  // namespace

double Dexels::volume_m3() const {
  double length = 0;
  for (const Interval& s : interval) length += s.high_m - s.low_m;
  return length * cell_m * cell_m;
}

Dexels empty_dexels(const Vec2& low, const Vec2& high, double cell_m) {
  if (!(cell_m > 0) || !low.allFinite() || !high.allFinite() || (high - low).minCoeff() < 0)
    throw Error("columns need a cell_m > 0 and a finite box, low before high; cell_m is " + std::to_string(cell_m));
  Dexels empty;
  empty.cell_m = cell_m;
  const Vec2 first = (low / cell_m).array().floor(), last = (high / cell_m).array().ceil();
  empty.origin = first * cell_m;
  empty.width = static_cast<int>(last.x() - first.x());
  empty.height = static_cast<int>(last.y() - first.y());
  empty.offset.assign(empty.columns() + 1, 0);
  return empty;
}

Dexels unite(const Dexels& a, const Dexels& b) {
  return combine(a, b, [](bool in_a, bool in_b) { return in_a || in_b; });
}
Dexels intersect(const Dexels& a, const Dexels& b) {
  return combine(a, b, [](bool in_a, bool in_b) { return in_a && in_b; });
}
Dexels subtract(const Dexels& a, const Dexels& b) {
  return combine(a, b, [](bool in_a, bool in_b) { return in_a && !in_b; });
}

Dexels dexels_of(const std::vector<std::vector<Interval>>& columns, const Dexels& like) {
  ADIT_CHECK(columns.size() == like.columns());
  Dexels solid = like;
  std::vector<Interval> merged;
  fill(solid, [&](size_t c) -> const std::vector<Interval>& {
    merged.clear();
    for (const Interval& s : columns[c])
      if (s.high_m > s.low_m) insert(merged, s);
    return merged;
  });
  return solid;
}

Dexels dexels_of(const Mesh& mesh, const Dexels& like) {
  const Axes axes(like);
  std::vector<Corner> corner;
  for (const Vec3& p : mesh.vertex) corner.push_back(corner_of(p, like));
  const int bands = (like.height + band_rows - 1) / band_rows;
  std::vector<std::vector<std::uint32_t>> faces(bands);
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    const auto [low, high] =
        std::minmax({corner[mesh.face[f][0]].y, corner[mesh.face[f][1]].y, corner[mesh.face[f][2]].y});
    const Range rows = axes_within(static_cast<double>(low), static_cast<double>(high), like, like.height);
    for (int band = rows.begin / band_rows; band * band_rows < rows.end; ++band) faces[band].push_back(f);
  }
  struct Crossing {
    double z;
    int step;  // of the winding number, going up
  };
  std::vector<std::vector<Interval>> columns(like.columns());
  parallel_for(bands, [&](size_t band) {
    const Range rows = {static_cast<int>(band) * band_rows,
                        std::min(like.height, (static_cast<int>(band) + 1) * band_rows)};
    std::vector<std::vector<Crossing>> met(static_cast<size_t>(rows.end - rows.begin) * like.width);
    for (const std::uint32_t f : faces[band])
      crossings(corner[mesh.face[f][0]], corner[mesh.face[f][1]], corner[mesh.face[f][2]], like, axes, {0, like.width},
                rows, [&](int i, int j, double z, bool up) {
                  met[static_cast<size_t>(j - rows.begin) * like.width + i].push_back({z, up ? -1 : 1});
                });
    for (size_t c = 0; c < met.size(); ++c) {
      std::sort(met[c].begin(), met[c].end(),
                [](const Crossing& a, const Crossing& b) { return a.z != b.z ? a.z < b.z : a.step > b.step; });
      int winding = 0;
      auto& column = columns[static_cast<size_t>(rows.begin) * like.width + c];
      for (const Crossing& crossing : met[c]) {
        if (winding == 0) column.push_back({crossing.z, crossing.z});
        winding += crossing.step;
        column.back().high_m = crossing.z;
      }
    }
  });
  return dexels_of(columns, like);
}

}  // namespace adit
