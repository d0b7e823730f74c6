// SPDX-License-Identifier: BSD-3-Clause
#include "base/dexel_raster.h"
#include "base/parallel.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

namespace adit {

using namespace dexel;

namespace {

constexpr int tile_cells = 64;     // a multiple of 4
constexpr double margin_m = 1e-9;  // far above the rounding of a height, far below touch_m

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

/// An edge of a tetrahedron as a function of the row that it crosses: there it stands at low + per_y * (y - y0).
struct EdgeInRows {
  double y0, y_low, y_high;
  double x_low, x_high, x_per_y, z_low, z_high, z_per_y;

  EdgeInRows(const Corner& a, const Corner& b) {
    const auto ax = static_cast<double>(a.x), bx = static_cast<double>(b.x), by = static_cast<double>(b.y);
    y0 = static_cast<double>(a.y);
    y_low = std::min(y0, by), y_high = std::max(y0, by);
    const bool flat = y_high - y_low <= 2 * slack;  // along the row
    x_low = flat ? std::min(ax, bx) : ax, x_high = flat ? std::max(ax, bx) : ax;
    z_low = flat ? std::min(a.z, b.z) : a.z, z_high = flat ? std::max(a.z, b.z) : a.z;
    x_per_y = flat ? 0 : (bx - ax) / (by - y0), z_per_y = flat ? 0 : (b.z - a.z) / (by - y0);
  }

  static constexpr double slack = 4;  // units: axes on an edge, and rounding
};

/// On which side of its six edges an axis stands, in integers. cross() of an edge is a part by row less one by column.
struct Sides {
  struct Edge {
    std::int64_t x, y, dx, dy, tie;
  };
  std::array<Edge, 6> edge;
  std::array<std::int64_t, 6> by_row, w;  // w: twice the area of an edge and the axis

  explicit Sides(const std::array<Corner, 4>& corner) {
    for (int e = 0; e < 6; ++e) {
      const Corner &a = corner[edge_ends[e][0]], &b = corner[edge_ends[e][1]];
      edge[e] = {a.x, a.y, b.x - a.x, b.y - a.y, tie(a, b)};
    }
  }
  void enter_row(std::int64_t y) {
    for (int e = 0; e < 6; ++e) by_row[e] = edge[e].dx * (y - edge[e].y);
  }
  /// The faces that the axis at x in this row passes through, a bit each.
  unsigned faces_at(std::int64_t x) {
    unsigned sides = 0;
    for (int e = 0; e < 6; ++e) {
      w[e] = by_row[e] - edge[e].dy * (x - edge[e].x);
      sides |= static_cast<unsigned>(w[e] + edge[e].tie < 0) << e;
    }
    return crossed_faces[sides];
  }
  /// Between those faces. @return low >= high where nothing is
  Interval stretch(unsigned faces, const std::array<Corner, 4>& corner) const {
    Interval s = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (; faces != 0; faces &= faces - 1) {
      const FaceEdges& face = face_edges[std::countr_zero(faces)];
      const auto wa = static_cast<double>(w[face.bc]), wb = static_cast<double>(-w[face.ac]),
                 wc = static_cast<double>(w[face.ab]);
      const double z = (wa * corner[face.a].z + wb * corner[face.b].z + wc * corner[face.c].z) / (wa + wb + wc);
      s.low_m = std::min(s.low_m, z);
      s.high_m = std::max(s.high_m, z);
    }
    return s;
  }
};

/// Which columns of each row of a tile a tetrahedron may meet, a superset by a few, and between which heights.
struct Shadow {
  using Four = Eigen::Array4d;
  std::array<int, tile_cells> begin, end;  // begin >= end: none
  std::array<double, tile_cells> z_low, z_high;

  Shadow(const std::array<Corner, 4>& corner, std::span<const double> row_y, Range columns, const Dexels& like) {
    constexpr double none = 1e18;
    const std::array<EdgeInRows, 6> edge = {EdgeInRows{corner[0], corner[1]}, {corner[0], corner[2]},
                                            {corner[0], corner[3]},           {corner[1], corner[2]},
                                            {corner[1], corner[3]},           {corner[2], corner[3]}};
    const double per_unit = 1 / (units_per_m * like.cell_m), first = columns.begin, last = columns.end;
    for (size_t r = 0; r < row_y.size(); r += 4) {
      const Four y = Eigen::Map<const Four>(row_y.data() + r);
      Four x0 = Four::Constant(none), x1 = -x0, z0 = x0, z1 = x1;
      for (const EdgeInRows& e : edge) {
        const Four within = y.max(e.y_low).min(e.y_high), off = within - e.y0;
        const Four miss = ((y - within).abs() - EdgeInRows::slack).max(0.0) * none;
        const Four x = e.x_per_y * off, z = e.z_per_y * off;
        x0 = x0.min(x + e.x_low + miss);
        x1 = x1.max(x + e.x_high - miss);
        z0 = z0.min(z + e.z_low + miss);
        z1 = z1.max(z + e.z_high - miss);
      }
      const Four from = ((x0 - EdgeInRows::slack) * per_unit - 0.5).floor().max(first).min(last),
                 to = ((x1 + EdgeInRows::slack) * per_unit + 0.5).ceil().max(first).min(last);
      Eigen::Map<Eigen::Array4i>(begin.data() + r) = from.cast<int>();
      Eigen::Map<Eigen::Array4i>(end.data() + r) = to.cast<int>();
      Eigen::Map<Four>(z_low.data() + r) = z0;
      Eigen::Map<Four>(z_high.data() + r) = z1;
    }
  }
};

}  // namespace

struct DexelUnion::Impl {
  struct Tile {  // tile_cells^2 columns, or none where nothing was added
    std::vector<std::vector<Interval>> column;
    std::vector<Interval> longest;  // of a column's stretches, low > high for none: most of what comes lies within it
  };

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

void DexelUnion::Impl::add_to_tile(size_t t, const std::array<Corner, 4>& corner) {
  const int first_i = static_cast<int>(t % across) * tile_cells, first_j = static_cast<int>(t / across) * tile_cells;
  const auto [x_low, x_high] = std::minmax({corner[0].x, corner[1].x, corner[2].x, corner[3].x});
  const auto [y_low, y_high] = std::minmax({corner[0].y, corner[1].y, corner[2].y, corner[3].y});
  const Range columns = overlap({first_i, first_i + tile_cells},
                                axes_within(static_cast<double>(x_low), static_cast<double>(x_high), grid, grid.width));
  const Range rows = overlap({first_j, first_j + tile_cells},
                             axes_within(static_cast<double>(y_low), static_cast<double>(y_high), grid, grid.height));
  if (rows.begin >= rows.end) return;
  Tile& tile = tiles[t];
  if (tile.column.empty()) {
    tile.column.resize(tile_cells * tile_cells);
    tile.longest.resize(tile_cells * tile_cells, {1e18, -1e18});
  }
  Sides sides(corner);
  const Shadow shadow(corner, std::span(axes.y_units).subspan(rows.begin, rows.end - rows.begin), columns, grid);
  for (int j = rows.begin; j < rows.end; ++j) {
    const int r = j - rows.begin, end = shadow.end[r];
    const ptrdiff_t row = static_cast<ptrdiff_t>(j - first_j) * tile_cells - first_i;
    Interval* const longest = tile.longest.data() + row;
    const auto within = [&](int i, double low_m, double high_m) {
      return longest[i].low_m <= low_m && high_m <= longest[i].high_m;
    };
    const double low_m = shadow.z_low[r] - margin_m, high_m = shadow.z_high[r] + margin_m;
    int i = shadow.begin[r];
    while (i < end && within(i, low_m, high_m)) ++i;
    if (i >= end) continue;
    sides.enter_row(axes.y[j]);
    for (; i < end; ++i) {
      if (within(i, low_m, high_m)) continue;
      const unsigned faces = sides.faces_at(axes.x[i]);
      if (faces == 0) continue;
      const Interval s = sides.stretch(faces, corner);
      if (s.low_m >= s.high_m || within(i, s.low_m, s.high_m)) continue;
      const Interval now = insert(tile.column[row + i], s);
      if (now.high_m - now.low_m > longest[i].high_m - longest[i].low_m) longest[i] = now;
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
    return tile.column.empty() ? none : tile.column[j % tile_cells * tile_cells + i % tile_cells];
  });
  return solid;
}

Dexels dexels_of(std::span<const Tetrahedron> tetrahedra, const Dexels& like) {
  DexelUnion all(like);
  constexpr size_t batch = 1 << 18;
  for (size_t begin = 0; begin < tetrahedra.size(); begin += batch)
    all.add(tetrahedra.subspan(begin, std::min(batch, tetrahedra.size() - begin)));
  return all.solid();
}

}  // namespace adit
