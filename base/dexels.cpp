// SPDX-License-Identifier: BSD-3-Clause
#include "base/dexels.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace adit {
namespace {

constexpr double units_per_m = 1 << 17;
constexpr std::int64_t farthest = std::int64_t{1} << 29;  // units; keeps every product below 2^62
constexpr double touch_m = 1e-6;                          // intervals that come this near are one
constexpr int tile_cells = 32;

/// A corner: plan in whole units from the grid's origin, height in metres.
struct Corner {
  std::int64_t x, y;
  double z;
};

/// Twice the signed area of (a, b, p); +1 unit at most of rounding, for none is done.
std::int64_t cross(const Corner& a, const Corner& b, std::int64_t x, std::int64_t y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// 0 where an axis on the edge a->b counts as left of it, else -1: the axis stands at (x + e, y + e^2).
std::int64_t tie(const Corner& a, const Corner& b) {
  const bool left = b.y < a.y || (b.y == a.y && b.x > a.x);
  return left ? 0 : -1;
}

/// The axes of the columns in whole units, and which of them lie in a range.
struct Axes {
  std::vector<std::int64_t> x, y;

  explicit Axes(const Dexels& like) {
    for (int i = 0; i < like.width; ++i) x.push_back(std::llround((i + 0.5) * like.cell_m * units_per_m));
    for (int j = 0; j < like.height; ++j) y.push_back(std::llround((j + 0.5) * like.cell_m * units_per_m));
  }
};

struct Range {
  int begin, end;
};

/// Indices of the axes within [low, high], a superset by at most one at each end, clipped to the grid.
Range axes_within(double low, double high, const Dexels& like, int count) {
  const double per_unit = 1 / (units_per_m * like.cell_m);
  const double first = std::floor(low * per_unit - 0.5);
  const double last = std::ceil(high * per_unit - 0.5);
  return {static_cast<int>(std::clamp(first, 0.0, static_cast<double>(count))),
          static_cast<int>(std::clamp(last + 1, 0.0, static_cast<double>(count)))};
}

Range overlap(Range a, Range b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

Corner corner_of(const Vec3& p, const Dexels& like) {
  const double x = (p.x() - like.origin.x()) * units_per_m, y = (p.y() - like.origin.y()) * units_per_m;
  if (!(std::abs(x) <= farthest && std::abs(y) <= farthest && std::isfinite(p.z())))
    throw Error("a corner at (" + std::to_string(p.x()) + ", " + std::to_string(p.y()) + ", " + std::to_string(p.z()) +
                ") m is not finite or more than 4 km from the origin of the columns");
  return {std::llround(x), std::llround(y), p.z()};
}

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

/// Adds a stretch to sorted, disjoint stretches.
void insert(std::vector<Interval>& stretches, Interval added) {
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
}

void check_same_grid(const Dexels& a, const Dexels& b) {
  ADIT_CHECK(a.cell_m == b.cell_m && a.origin == b.origin && a.width == b.width && a.height == b.height);
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
  const int bands = (like.height + tile_cells - 1) / tile_cells;
  std::vector<std::vector<std::uint32_t>> faces(bands);
  for (std::uint32_t f = 0; f < mesh.face.size(); ++f) {
    const auto [low, high] =
        std::minmax({corner[mesh.face[f][0]].y, corner[mesh.face[f][1]].y, corner[mesh.face[f][2]].y});
    const Range rows = axes_within(static_cast<double>(low), static_cast<double>(high), like, like.height);
    for (int band = rows.begin / tile_cells; band * tile_cells < rows.end; ++band) faces[band].push_back(f);
  }
  struct Crossing {
    double z;
    int step;  // of the winding number, going up
  };
  std::vector<std::vector<Interval>> columns(like.columns());
  parallel_for(bands, [&](size_t band) {
    const Range rows = {static_cast<int>(band) * tile_cells,
                        std::min(like.height, (static_cast<int>(band) + 1) * tile_cells)};
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

Dexels dexels_of(std::span<const Tetrahedron> tetrahedra, const Dexels& like) {
  DexelUnion all(like);
  constexpr size_t batch = 1 << 18;
  for (size_t begin = 0; begin < tetrahedra.size(); begin += batch)
    all.add(tetrahedra.subspan(begin, std::min(batch, tetrahedra.size() - begin)));
  return all.solid();
}

struct DexelUnion::Impl {
  using Tile = std::vector<std::vector<Interval>>;  // tile_cells^2 columns, or none where nothing was added

  explicit Impl(const Dexels& like)
      : grid(like),
        axes(like),
        across((like.width + tile_cells - 1) / tile_cells),
        tiles(static_cast<size_t>(across) * ((like.height + tile_cells - 1) / tile_cells)) {
    grid.interval.clear();
    grid.offset.assign(grid.columns() + 1, 0);
  }

  void add_to_tile(size_t t, const std::array<Corner, 4>& corner);

  Dexels grid;
  Axes axes;
  int across;  // tiles in a row
  std::vector<Tile> tiles;
};

namespace {

// Corners 0..3 of a tetrahedron; faces by their edges ab, bc, ac with a < b < c.
constexpr int edge_ends[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
struct FaceEdges {
  int a, b, c, ab, bc, ac;
};
constexpr FaceEdges face_edges[4] = {{0, 1, 2, 0, 3, 1}, {0, 1, 3, 0, 4, 2}, {0, 2, 3, 1, 5, 2}, {1, 2, 3, 3, 5, 4}};

/// Bit f of entry m: an axis on those sides of the six edges (bit e of m: right of edge e) passes through face f.
constexpr std::array<std::uint8_t, 64> crossed_faces = [] {
  std::array<std::uint8_t, 64> table{};
  for (int sides = 0; sides < 64; ++sides)
    for (int f = 0; f < 4; ++f) {
      const int ab = sides >> face_edges[f].ab & 1, bc = sides >> face_edges[f].bc & 1,
                ac = sides >> face_edges[f].ac & 1;
      if (ab == bc && ab != ac) table[sides] |= static_cast<std::uint8_t>(1 << f);
    }
  return table;
}();

/// Which columns of each row of a tile the shadow of a tetrahedron covers: a superset by a few. Loops without branches
/// over the rows, edge by edge, which the compiler turns into vectors.
struct Shadow {
  std::array<int, tile_cells> begin, end;  // begin >= end: none

  Shadow(const std::array<Corner, 4>& corner, std::span<const std::int64_t> row_y, Range columns, const Dexels& like) {
    constexpr double slack = 4;  // units: axes on an edge, and rounding
    constexpr double none = 1e18;
    const size_t rows = row_y.size();
    std::array<double, tile_cells> y, low, high;
    for (size_t r = 0; r < rows; ++r) y[r] = static_cast<double>(row_y[r]), low[r] = none, high[r] = -none;
    for (const auto& ends : edge_ends) {
      const Corner &a = corner[ends[0]], &b = corner[ends[1]];
      const auto ax = static_cast<double>(a.x), ay = static_cast<double>(a.y), bx = static_cast<double>(b.x),
                 by = static_cast<double>(b.y);
      const bool flat = std::abs(ay - by) <= 2 * slack;  // along the row
      const double y_low = std::min(ay, by), y_high = std::max(ay, by), slope = flat ? 0 : (bx - ax) / (by - ay);
      const double x_low = flat ? std::min(ax, bx) : ax, x_high = flat ? std::max(ax, bx) : ax;
      for (size_t r = 0; r < rows; ++r) {
        const double within = y[r] < y_low ? y_low : y[r] > y_high ? y_high : y[r];
        const double off = slope * (within - ay), miss = std::abs(y[r] - within) <= slack ? 0 : 2 * none;
        const double x0 = x_low + off + miss, x1 = x_high + off - miss;
        low[r] = x0 < low[r] ? x0 : low[r];
        high[r] = x1 > high[r] ? x1 : high[r];
      }
    }
    const double per_unit = 1 / (units_per_m * like.cell_m), first = columns.begin, last = columns.end;
    for (size_t r = 0; r < rows; ++r) {
      const double from = std::floor((low[r] - slack) * per_unit - 0.5),
                   to = std::ceil((high[r] + slack) * per_unit + 0.5);
      begin[r] = static_cast<int>(from < first ? first : from > last ? last : from);
      end[r] = static_cast<int>(to < first ? first : to > last ? last : to);
    }
  }
};

}  // namespace

void DexelUnion::Impl::add_to_tile(size_t t, const std::array<Corner, 4>& corner) {
  const int first_i = static_cast<int>(t % across) * tile_cells, first_j = static_cast<int>(t / across) * tile_cells;
  const auto [x_low, x_high] = std::minmax({corner[0].x, corner[1].x, corner[2].x, corner[3].x});
  const auto [y_low, y_high] = std::minmax({corner[0].y, corner[1].y, corner[2].y, corner[3].y});
  const Range columns = overlap({first_i, first_i + tile_cells},
                                axes_within(static_cast<double>(x_low), static_cast<double>(x_high), grid, grid.width));
  const Range rows = overlap({first_j, first_j + tile_cells},
                             axes_within(static_cast<double>(y_low), static_cast<double>(y_high), grid, grid.height));
  // cross() of each edge is a part by row less a part by column.
  std::int64_t by_column[6][tile_cells], ties[6];
  for (int e = 0; e < 6; ++e) {
    const Corner &a = corner[edge_ends[e][0]], &b = corner[edge_ends[e][1]];
    ties[e] = tie(a, b);
    for (int i = columns.begin; i < columns.end; ++i) by_column[e][i - first_i] = (b.y - a.y) * (axes.x[i] - a.x);
  }
  Tile& tile = tiles[t];
  if (rows.begin >= rows.end) return;
  const Shadow shadow(corner, std::span(axes.y).subspan(rows.begin, rows.end - rows.begin), columns, grid);
  for (int j = rows.begin; j < rows.end; ++j) {
    const Range in_row = {shadow.begin[j - rows.begin], shadow.end[j - rows.begin]};
    if (in_row.begin >= in_row.end) continue;
    std::int64_t by_row[6];
    for (int e = 0; e < 6; ++e) {
      const Corner &a = corner[edge_ends[e][0]], &b = corner[edge_ends[e][1]];
      by_row[e] = (b.x - a.x) * (axes.y[j] - a.y);
    }
    for (int i = in_row.begin; i < in_row.end; ++i) {
      std::int64_t w[6];
      unsigned sides = 0;
      for (int e = 0; e < 6; ++e) {
        w[e] = by_row[e] - by_column[e][i - first_i];
        sides |= static_cast<unsigned>(w[e] + ties[e] < 0) << e;
      }
      if (crossed_faces[sides] == 0) continue;
      Interval s = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
      for (int f = 0; f < 4; ++f) {
        if (!(crossed_faces[sides] >> f & 1)) continue;
        const FaceEdges& face = face_edges[f];
        const auto wa = static_cast<double>(w[face.bc]), wb = static_cast<double>(-w[face.ac]),
                   wc = static_cast<double>(w[face.ab]);
        const double z = (wa * corner[face.a].z + wb * corner[face.b].z + wc * corner[face.c].z) / (wa + wb + wc);
        s.low_m = std::min(s.low_m, z);
        s.high_m = std::max(s.high_m, z);
      }
      if (s.low_m >= s.high_m) continue;
      if (tile.empty()) tile.resize(tile_cells * tile_cells);
      insert(tile[static_cast<size_t>(j - first_j) * tile_cells + (i - first_i)], s);
    }
  }
}

double enclosed_volume(const Tetrahedron& t) {
  return std::abs((t[1] - t[0]).cross(t[2] - t[0]).dot(t[3] - t[0])) / 6;
}

DexelUnion::DexelUnion(const Dexels& like) : impl_(std::make_unique<Impl>(like)) {}
DexelUnion::~DexelUnion() = default;
DexelUnion::DexelUnion(DexelUnion&&) noexcept = default;
DexelUnion& DexelUnion::operator=(DexelUnion&&) noexcept = default;

void DexelUnion::add(std::span<const Tetrahedron> tetrahedra) {
  const Dexels& grid = impl_->grid;
  std::vector<std::array<Corner, 4>> corner(tetrahedra.size());
  parallel_for(
      tetrahedra.size(),
      [&](size_t n) {
        for (int k = 0; k < 4; ++k) corner[n][k] = corner_of(tetrahedra[n][k], grid);
      },
      4096);
  // each(tile, tetrahedron), tetrahedra rising
  const auto for_tiles = [&](const auto& each) {
    for (std::uint32_t n = 0; n < corner.size(); ++n) {
      const auto& c = corner[n];
      const auto [x_low, x_high] = std::minmax({c[0].x, c[1].x, c[2].x, c[3].x});
      const auto [y_low, y_high] = std::minmax({c[0].y, c[1].y, c[2].y, c[3].y});
      const Range columns = axes_within(static_cast<double>(x_low), static_cast<double>(x_high), grid, grid.width),
                  rows = axes_within(static_cast<double>(y_low), static_cast<double>(y_high), grid, grid.height);
      if (columns.begin >= columns.end) continue;
      for (int tj = rows.begin / tile_cells; tj * tile_cells < rows.end; ++tj)
        for (int ti = columns.begin / tile_cells; ti * tile_cells < columns.end; ++ti)
          each(static_cast<size_t>(tj) * impl_->across + ti, n);
    }
  };
  // Sorted by tile: counted, then put in place.
  std::vector<std::uint32_t> begin(impl_->tiles.size() + 1, 0);
  for_tiles([&](size_t tile, std::uint32_t) { ++begin[tile + 1]; });
  std::vector<std::uint32_t> busy;  // tiles with work
  for (std::uint32_t t = 0; t < impl_->tiles.size(); ++t) {
    if (begin[t + 1] > 0) busy.push_back(t);
    begin[t + 1] += begin[t];
  }
  std::vector<std::uint32_t> work(begin.back()), next = begin;
  for_tiles([&](size_t tile, std::uint32_t n) { work[next[tile]++] = n; });
  parallel_for(busy.size(), [&](size_t k) {
    const std::uint32_t t = busy[k];
    for (std::uint32_t w = begin[t]; w < begin[t + 1]; ++w) impl_->add_to_tile(t, corner[work[w]]);
  });
}

Dexels DexelUnion::solid() const {
  Dexels solid = impl_->grid;
  const std::vector<Interval> none;
  fill(solid, [&](size_t c) -> const std::vector<Interval>& {
    const size_t i = c % solid.width, j = c / solid.width;
    const auto& tile = impl_->tiles[j / tile_cells * impl_->across + i / tile_cells];
    return tile.empty() ? none : tile[j % tile_cells * tile_cells + i % tile_cells];
  });
  return solid;
}

}  // namespace adit
