// SPDX-License-Identifier: BSD-3-Clause
#include "eval/grid_error.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double jump_m = 0.5;

// Raises a cell to at least `to`; the order of the threads does not matter.
void raise(CellTruth& cell, CellTruth to) {
  auto& byte = reinterpret_cast<std::uint8_t&>(cell);
  std::atomic_ref<std::uint8_t> shared(byte);
  std::uint8_t now = shared.load(std::memory_order_relaxed);
  while (now < static_cast<std::uint8_t>(to) && !shared.compare_exchange_weak(now, static_cast<std::uint8_t>(to))) {
  }
}

// Every cell whose centre is in the triangle, borders included; corners in cells.
template <typename Found>
void fill_triangle(const std::array<Vec2, 3>& t, int width, int height, Found&& found) {
  const auto [low, high] = std::minmax({t[0].y(), t[1].y(), t[2].y()});
  const int first = std::max(0, static_cast<int>(std::ceil(low - 0.5)));
  const int last = std::min(height - 1, static_cast<int>(std::floor(high - 0.5)));
  for (int j = first; j <= last; ++j) {
    const double y = j + 0.5;
    double left = infinity, right = -infinity;
    for (int k = 0; k < 3; ++k) {
      const Vec2 &a = t[k], &b = t[(k + 1) % 3];
      if ((a.y() < y && b.y() < y) || (a.y() > y && b.y() > y)) continue;
      const double x0 = a.y() == b.y() ? a.x() : a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y());
      const double x1 = a.y() == b.y() ? b.x() : x0;
      left = std::min({left, x0, x1});
      right = std::max({right, x0, x1});
    }
    const int from = std::max(0, static_cast<int>(std::ceil(left - 0.5)));
    const int to = std::min(width - 1, static_cast<int>(std::floor(right - 0.5)));
    for (int i = from; i <= to; ++i) found(i, j);
  }
}

Vec2 on_plane(const Pose& X_MW, const Vec3& p_W) {
  return (X_MW * p_W).head<2>();
}

// Grid and ends of all beams, in whole cells from the grid's origin.
TrueSection empty_section(const Grid& grid, const Pose& X_MW, const TrueScans& scans, size_t laser) {
  struct Box {
    Vec2 low = Vec2::Constant(infinity), high = Vec2::Constant(-infinity);
  };
  std::vector<Box> boxes(scans.scans(laser));
  parallel_for(
      boxes.size(),
      [&](size_t i) {
        for (const TrueBeam& b : scans.fan(laser, i, 1)) {
          if (!b.met) continue;
          const Vec2 p = on_plane(X_MW, b.end());
          boxes[i].low = boxes[i].low.cwiseMin(p);
          boxes[i].high = boxes[i].high.cwiseMax(p);
        }
      },
      16);
  Box all{grid.origin, grid.origin + grid.cell_m * Vec2(grid.width, grid.height)};
  for (const Box& b : boxes) all.low = all.low.cwiseMin(b.low), all.high = all.high.cwiseMax(b.high);
  TrueSection s;
  s.cell_m = grid.cell_m;
  const Vec2 first = ((all.low - grid.origin) / grid.cell_m).array().floor() - 1;
  const Vec2 size = ((all.high - grid.origin) / grid.cell_m).array().ceil() + 1 - first.array();
  if (!(size.x() * size.y() < 4e9))
    throw Error("the section has more than 4e9 cells of " + std::to_string(grid.cell_m) + " m");
  s.origin = grid.origin + grid.cell_m * first;
  s.width = static_cast<int>(size.x());
  s.height = static_cast<int>(size.y());
  s.cell.assign(static_cast<size_t>(s.width) * s.height, CellTruth::unseen);
  return s;
}

// How many of `of` have one of `in` within one cell.
std::int64_t near_count(const TrueSection& s, const std::vector<char>& of, const std::vector<char>& in) {
  std::int64_t n = 0;
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i) {
      if (!of[s.index(i, j)]) continue;
      bool found = false;
      for (int b = std::max(0, j - 1); b <= std::min(s.height - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(s.width - 1, i + 1); ++a) found = found || in[s.index(a, b)];
      n += found;
    }
  return n;
}

double ratio(std::int64_t a, std::int64_t b) {
  return b ? static_cast<double>(a) / static_cast<double>(b) : none;
}

}  // namespace

TrueSection true_section(const Grid& grid, const Pose& X_WM, const TrueScans& scans, size_t laser, const Mesh& mesh) {
  const Pose X_MW = X_WM.inverse();
  TrueSection s = empty_section(grid, X_MW, scans, laser);
  const auto in_cells = [&](const Vec3& p_W) -> Vec2 { return (on_plane(X_MW, p_W) - s.origin) / s.cell_m; };
  parallel_for(
      scans.scans(laser),
      [&](size_t n) {
        const std::vector<TrueBeam> fan = scans.fan(laser, n, 1);
        for (size_t k = 0; k < fan.size(); ++k) {
          const TrueBeam& a = fan[k];
          if (!a.met) continue;
          const Label label = mesh.label.empty() ? Label::rib : mesh.label[static_cast<size_t>(a.face)];
          const Vec2 end = in_cells(a.end());
          if (!is_ground(label) && !is_roof(label) && label != Label::water)
            raise(s.cell[s.index(static_cast<int>(end.x()), static_cast<int>(end.y()))], CellTruth::wall);
          if (k + 1 == fan.size() || !fan[k + 1].met) continue;
          const TrueBeam& b = fan[k + 1];
          const double near_m = std::min(a.range_m, b.range_m);
          const bool jumps = std::abs(a.range_m - b.range_m) > jump_m;
          const auto reach = [&](const TrueBeam& t) {
            return in_cells(t.origin + (jumps ? near_m : t.range_m) * t.direction);
          };
          fill_triangle({in_cells(a.origin), reach(a), reach(b)}, s.width, s.height,
                        [&](int i, int j) { raise(s.cell[s.index(i, j)], CellTruth::free); });
        }
      },
      16);
  return s;
}

std::vector<Grid::Cell> cells_over(const TrueSection& s, const Grid& grid) {
  std::vector<Grid::Cell> cells(s.cell.size(), Grid::unknown);
  const Vec2 shift = (s.origin - grid.origin) / s.cell_m;
  const int di = static_cast<int>(std::lround(shift.x())), dj = static_cast<int>(std::lround(shift.y()));
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i)
      if (i + di >= 0 && j + dj >= 0 && i + di < grid.width && j + dj < grid.height)
        cells[s.index(i, j)] = grid.cell(i + di, j + dj);
  return cells;
}

void add_grid(const MetricList& list, const TrueSection& s, const Grid& grid, const std::string& why) {
  std::int64_t both = 0, either = 0, known = 0;
  double squares = 0;
  std::vector<char> wall(s.cell.size(), 0), occupied(s.cell.size(), 0);
  const std::vector<Grid::Cell> cells = why.empty() ? cells_over(s, grid) : std::vector<Grid::Cell>();
  const Vec2 shift = cells.empty() ? Vec2::Zero() : Vec2((s.origin - grid.origin) / s.cell_m);
  const int di = static_cast<int>(std::lround(shift.x())), dj = static_cast<int>(std::lround(shift.y()));
  for (size_t c = 0; c < cells.size(); ++c) {
    const bool free = s.cell[c] == CellTruth::free, said = cells[c] == Grid::free;
    both += free && said;
    either += free || said;
    wall[c] = s.cell[c] == CellTruth::wall;
    occupied[c] = cells[c] == Grid::occupied;
    if (s.cell[c] == CellTruth::unseen || cells[c] == Grid::unknown) continue;
    const int i = static_cast<int>(c % s.width) + di, j = static_cast<int>(c / s.width) + dj;
    const double p = 1 / (1 + std::exp(-static_cast<double>(grid.log_odds[grid.index(i, j)])));
    squares += (p - wall[c]) * (p - wall[c]);
    ++known;
  }
  const auto walls = static_cast<std::int64_t>(std::count(wall.begin(), wall.end(), 1));
  const auto said = static_cast<std::int64_t>(std::count(occupied.begin(), occupied.end(), 1));
  const double precision = why.empty() ? ratio(near_count(s, occupied, wall), said) : none;
  const double recall = why.empty() ? ratio(near_count(s, wall, occupied), walls) : none;
  // A map without a wall where there are some has F = 0.
  const double f =
      precision + recall > 0 ? 2 * precision * recall / (precision + recall) : (walls > 0 && why.empty() ? 0 : none);
  list.add("iou_free", why.empty() ? ratio(both, either) : none, "share", Better::higher, either, why);
  list.add("f_occupied", f, "share", Better::higher, walls, why);
  list.add("precision_occupied", precision, "share", Better::higher, said,
           why.empty() ? "the grid has no occupied cell" : why);
  list.add("recall_occupied", recall, "share", Better::higher, walls, why.empty() ? "no wall was swept" : why);
  list.add("brier", known ? squares / static_cast<double>(known) : none, "ratio", Better::lower, known, why);
}

}  // namespace adit
