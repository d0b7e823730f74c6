// SPDX-License-Identifier: BSD-3-Clause
#include "eval/topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace adit {
namespace {

// Cells of the section whose centre is within an outline given in W.
std::vector<size_t> cells_within(const std::vector<Vec2>& outline, const TrueSection& s, const Pose& X_MW,
                                 double height_W_m) {
  std::vector<Vec2> corner;
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vec2& p : outline) {
    corner.push_back(((X_MW * Vec3(p.x(), p.y(), height_W_m)).head<2>() - s.origin) / s.cell_m);
    low = low.cwiseMin(corner.back());
    high = high.cwiseMax(corner.back());
  }
  std::vector<size_t> cells;
  for (int j = std::max(0, static_cast<int>(low.y())); j < std::min<double>(s.height, high.y()); ++j) {
    std::vector<double> x;
    for (size_t k = 0; k < corner.size(); ++k) {
      const Vec2 &a = corner[k], &b = corner[(k + 1) % corner.size()];
      if ((a.y() <= j + 0.5) != (b.y() <= j + 0.5))
        x.push_back(a.x() + (b.x() - a.x()) * (j + 0.5 - a.y()) / (b.y() - a.y()));
    }
    std::sort(x.begin(), x.end());
    for (size_t k = 0; k + 1 < x.size(); k += 2)
      for (int i = std::max(0, static_cast<int>(std::ceil(x[k] - 0.5))); i < s.width && i + 0.5 < x[k + 1]; ++i)
        cells.push_back(s.index(i, j));
  }
  return cells;
}

std::int64_t loops(const Islands& islands, size_t least_cells) {
  std::int64_t n = 0;
  for (size_t k = 0; k < islands.cells.size(); ++k) n += islands.enclosed[k] && islands.cells[k] >= least_cells;
  return n;
}

// The island that has most of the cells; -1 where most are free.
int island_under(const std::vector<size_t>& cells, const Islands& islands) {
  std::map<int, size_t> count;
  for (const size_t c : cells) ++count[islands.of[c]];
  int best = -1;
  for (const auto& [island, n] : count)
    if (island >= 0 && 2 * n > cells.size()) best = island;
  return best;
}

// Per pillar: does it lie alone on an enclosed island?
std::vector<char> stands_alone(const std::vector<std::vector<size_t>>& pillars, const Islands& islands,
                               size_t least_cells) {
  std::vector<int> under;
  std::map<int, int> tenants;
  for (const auto& cells : pillars) {
    under.push_back(island_under(cells, islands));
    if (under.back() >= 0) ++tenants[under.back()];
  }
  std::vector<char> alone;
  for (const int island : under)
    alone.push_back(island >= 0 && islands.enclosed[static_cast<size_t>(island)] &&
                    islands.cells[static_cast<size_t>(island)] >= least_cells && tenants[island] == 1);
  return alone;
}

// Parts into which the free cells cut a pillar, less one; 1 where nothing of it is left.
std::int64_t ways_through(const std::vector<size_t>& cells, const std::vector<char>& free, const TrueSection& s,
                          size_t least_cells) {
  if (cells.empty()) return 0;
  int i0 = s.width, i1 = 0, j0 = s.height, j1 = 0;
  for (const size_t c : cells) {
    const int i = static_cast<int>(c % s.width), j = static_cast<int>(c / s.width);
    i0 = std::min(i0, i), i1 = std::max(i1, i + 1), j0 = std::min(j0, j), j1 = std::max(j1, j + 1);
  }
  // Outside of the outline counts as free, so that only ways through the pillar itself join or part it.
  std::vector<char> inner(static_cast<size_t>(i1 - i0) * (j1 - j0), 1);
  for (const size_t c : cells) inner[(c / s.width - j0) * (i1 - i0) + (c % s.width - i0)] = free[c];
  const Islands parts = islands_of(inner, i1 - i0, j1 - j0);
  const auto n =
      std::count_if(parts.cells.begin(), parts.cells.end(), [&](size_t size) { return size >= least_cells; });
  return n == 0 ? 1 : n - 1;
}

}  // namespace

Islands islands_of(const std::vector<char>& free, int width, int height) {
  Islands islands;
  islands.of.assign(free.size(), -1);
  std::vector<size_t> open;
  for (size_t start = 0; start < free.size(); ++start) {
    if (free[start] || islands.of[start] >= 0) continue;
    const int id = static_cast<int>(islands.cells.size());
    islands.cells.push_back(0);
    islands.enclosed.push_back(1);
    islands.of[start] = id;
    open.push_back(start);
    while (!open.empty()) {
      const size_t c = open.back();
      open.pop_back();
      ++islands.cells.back();
      const int i = static_cast<int>(c % width), j = static_cast<int>(c / width);
      if (i == 0 || j == 0 || i == width - 1 || j == height - 1) islands.enclosed.back() = 0;
      for (int b = std::max(0, j - 1); b <= std::min(height - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(width - 1, i + 1); ++a) {
          const size_t next = static_cast<size_t>(b) * width + a;
          if (free[next] || islands.of[next] >= 0) continue;
          islands.of[next] = id;
          open.push_back(next);
        }
    }
  }
  return islands;
}

void add_topology(const MetricList& list, const World& world, const TrueSection& s,
                  const std::vector<Grid::Cell>& cells, const Pose& X_WM, double height_W_m, double pillar_m2,
                  const std::string& why) {
  std::int64_t loops_true = 0, loops_found = 0, pillars_true = 0, pillars_found = 0, connections = 0;
  if (why.empty()) {
    std::vector<char> free(s.cell.size()), said(s.cell.size());
    for (size_t c = 0; c < s.cell.size(); ++c) {
      free[c] = s.cell[c] == CellTruth::free;
      said[c] = cells[c] == Grid::free;
    }
    const Islands truth = islands_of(free, s.width, s.height), map = islands_of(said, s.width, s.height);
    const auto least = static_cast<size_t>(std::ceil(pillar_m2 / (s.cell_m * s.cell_m)));
    loops_true = loops(truth, least);
    loops_found = loops(map, least);
    std::vector<std::vector<size_t>> pillars;
    for (const Pillar& p : world.pillars) pillars.push_back(cells_within(p.outline, s, X_WM.inverse(), height_W_m));
    const std::vector<char> alone = stands_alone(pillars, truth, least), found = stands_alone(pillars, map, least);
    for (size_t k = 0; k < pillars.size(); ++k) {
      if (!alone[k]) continue;
      ++pillars_true;
      pillars_found += found[k];
      connections += ways_through(pillars[k], said, s, std::max<size_t>(1, least / 4));
    }
  }
  list.count("pillars_true", pillars_true, Better::higher, why);
  list.count("pillars_found", pillars_found, Better::higher, why);
  list.count("loops_true", loops_true, Better::higher, why);
  list.count("loops_found", loops_found, Better::higher, why);
  list.count("false_connections", connections, Better::lower, why);
}

}  // namespace adit
