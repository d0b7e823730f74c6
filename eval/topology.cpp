// SPDX-License-Identifier: BSD-3-Clause
#include "eval/topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

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

struct Stand {
  int island = -1;
  bool alone = false;   // on an island that free space goes round and that has no other pillar
  bool merged = false;  // on one that it shares, or that reaches the border
};
std::vector<Stand> stands(const std::vector<std::vector<size_t>>& pillars, const Islands& islands, size_t least_cells) {
  std::vector<int> under;
  std::map<int, int> tenants;
  for (const auto& cells : pillars) {
    under.push_back(island_under(cells, islands));
    if (under.back() >= 0) ++tenants[under.back()];
  }
  std::vector<Stand> all;
  for (const int island : under) {
    const auto k = static_cast<size_t>(island);
    Stand stand{island, false, false};
    if (island >= 0) {
      stand.merged = tenants[island] > 1 || !islands.enclosed[k];
      stand.alone = !stand.merged && islands.cells[k] >= least_cells;
    }
    all.push_back(stand);
  }
  return all;
}

// Free area over free area and enclosed islands.
double extraction_of(const std::vector<char>& free, const Islands& islands, size_t least_cells) {
  const auto open = static_cast<double>(std::count(free.begin(), free.end(), 1));
  double pillars = 0;
  for (size_t k = 0; k < islands.cells.size(); ++k)
    if (islands.enclosed[k] && islands.cells[k] >= least_cells) pillars += static_cast<double>(islands.cells[k]);
  return open + pillars > 0 ? open / (open + pillars) : none;
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

std::vector<PillarScore> add_topology(const MetricList& list, const World& world, const TrueSection& s,
                                      const std::vector<Grid::Cell>& cells, const Pose& X_WM, double height_W_m,
                                      double pillar_m2, const std::string& why) {
  std::int64_t loops_true = 0, loops_found = 0, pillars_found = 0, connections = 0, split = 0, merged = 0;
  double extraction_true = none, extraction = none, area_error = 0;
  std::vector<PillarScore> scores;
  if (why.empty()) {
    std::vector<char> free(s.cell.size()), said(s.cell.size());
    for (size_t c = 0; c < s.cell.size(); ++c) {
      free[c] = s.cell[c] == CellTruth::free;
      said[c] = cells[c] == Grid::free;
    }
    const Islands truth = islands_of(free, s.width, s.height), map = islands_of(said, s.width, s.height);
    const double cell_m2 = s.cell_m * s.cell_m;
    const auto least = static_cast<size_t>(std::ceil(pillar_m2 / cell_m2));
    loops_true = loops(truth, least);
    loops_found = loops(map, least);
    extraction_true = extraction_of(free, truth, least);
    extraction = extraction_of(said, map, least);
    std::vector<std::vector<size_t>> pillars;
    for (const Pillar& p : world.pillars) pillars.push_back(cells_within(p.outline, s, X_WM.inverse(), height_W_m));
    const std::vector<Stand> stood = stands(pillars, truth, least), found = stands(pillars, map, least);
    for (size_t k = 0; k < pillars.size(); ++k) {
      if (!stood[k].alone) continue;
      const double true_m2 = cell_m2 * static_cast<double>(truth.cells[static_cast<size_t>(stood[k].island)]);
      const double found_m2 =
          found[k].alone ? cell_m2 * static_cast<double>(map.cells[static_cast<size_t>(found[k].island)]) : none;
      scores.push_back({static_cast<int>(k), true_m2, found_m2});
      if (found[k].alone) area_error += 100 * std::abs(found_m2 - true_m2) / true_m2;
      pillars_found += found[k].alone;
      merged += found[k].merged;
      const std::int64_t ways = ways_through(pillars[k], said, s, std::max<size_t>(1, least / 4));
      connections += ways;
      split += ways > 0;
    }
  }
  const auto because = [&](const char* what) { return why.empty() ? std::string(what) : why; };
  list.count("pillars_true", static_cast<std::int64_t>(scores.size()), Better::higher, why);
  list.count("pillars_found", pillars_found, Better::higher, why);
  list.count("loops_true", loops_true, Better::higher, why);
  list.count("loops_found", loops_found, Better::higher, why);
  list.count("false_connections", connections, Better::lower, why);
  list.count("pillars_split", split, Better::lower, why);
  list.count("pillars_merged", merged, Better::lower, why);
  list.add("pillar_area_error_percent", pillars_found ? area_error / static_cast<double>(pillars_found) : none,
           "percent", Better::lower, pillars_found, because("no pillar was found"));
  const auto n = static_cast<std::int64_t>(s.cell.size());
  list.add("extraction_ratio_true", extraction_true, "share", Better::higher, n, because("nothing was swept"));
  list.add("extraction_ratio", extraction, "share", Better::higher, n, because("the map has no free cell"));
  return scores;
}

}  // namespace adit
