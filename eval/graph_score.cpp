// SPDX-License-Identifier: BSD-3-Clause
#include "eval/graph_score.h"

#include "base/parallel.h"
#include "base/rng.h"
#include "eval/junction_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double graph_cell_m = 0.2, way_cell_m = 0.4;
constexpr size_t most_starts = 8;

// Where W's places are in the section, metres from the corner of its first cell.
class Places {
 public:
  Places(const TrueSection& s, const Pose& X_WM) : s_(&s), X_MW_(X_WM.inverse()) {}
  Vec2 of(const Vec3& p_W) const { return (X_MW_ * p_W).head<2>() - s_->origin; }
  Vec3 back(const Vec2& p, double height_W_m) const {
    const Vec2 p_M = p + s_->origin;
    // The point of M's plane through that height, near enough: M is level to a degree.
    return X_MW_.inverse() * Vec3(p_M.x(), p_M.y(), (X_MW_ * Vec3(0, 0, height_W_m)).z());
  }

 private:
  const TrueSection* s_;
  Pose X_MW_;
};

FreeCells cells_of(const TrueSection& s, const std::vector<std::uint8_t>& free, double cell_m) {
  FreeCells fine{s.cell_m, s.width, s.height, free};
  return coarsened(fine, static_cast<int>(std::lround(cell_m / s.cell_m)));
}

std::optional<size_t> cell_at(const FreeCells& c, const Vec2& p) {
  const Vec2 at = (p / c.cell_m).array().floor();
  if (!(at.x() >= 0 && at.y() >= 0 && at.x() < c.width && at.y() < c.height)) return std::nullopt;
  return c.index(static_cast<int>(at.x()), static_cast<int>(at.y()));
}

// The free cell nearest to a place, within reach.
std::optional<size_t> free_near(const FreeCells& c, const Vec2& p, double reach_m) {
  std::optional<size_t> best;
  double least = reach_m;
  const int r = static_cast<int>(std::ceil(reach_m / c.cell_m));
  const int i0 = static_cast<int>(std::floor(p.x() / c.cell_m)), j0 = static_cast<int>(std::floor(p.y() / c.cell_m));
  for (int j = std::max(0, j0 - r); j <= std::min(c.height - 1, j0 + r); ++j)
    for (int i = std::max(0, i0 - r); i <= std::min(c.width - 1, i0 + r); ++i) {
      const double d = (c.cell_m * Vec2(i + 0.5, j + 0.5) - p).norm();
      if (c.free[c.index(i, j)] && d <= least) least = d, best = c.index(i, j);
    }
  return best;
}

// Every half metre of a passage's centre line.
std::vector<Vec2> middle_of(const Passage& passage, const Places& places) {
  std::vector<Vec2> line;
  for (size_t k = 0; k + 1 < passage.centre_line.size(); ++k) {
    const Vec3 &a = passage.centre_line[k], &b = passage.centre_line[k + 1];
    const int n = std::max(1, static_cast<int>(std::ceil((b - a).norm() / 0.5)));
    for (int i = 0; i < n; ++i) line.push_back(places.of(a + (b - a) * i / n));
  }
  if (!passage.centre_line.empty()) line.push_back(places.of(passage.centre_line.back()));
  return line;
}

// Do free cells lead from one end of a passage to the other without leaving it?
bool leads_through(const FreeCells& c, const std::vector<Vec2>& middle, double half_m) {
  FreeCells corridor{c.cell_m, c.width, c.height, std::vector<std::uint8_t>(c.free.size(), 0)};
  const int r = static_cast<int>(std::ceil(half_m / c.cell_m));
  for (const Vec2& p : middle) {
    const int i0 = static_cast<int>(std::floor(p.x() / c.cell_m)), j0 = static_cast<int>(std::floor(p.y() / c.cell_m));
    for (int j = std::max(0, j0 - r); j <= std::min(c.height - 1, j0 + r); ++j)
      for (int i = std::max(0, i0 - r); i <= std::min(c.width - 1, i0 + r); ++i)
        if ((c.cell_m * Vec2(i + 0.5, j + 0.5) - p).norm() <= half_m)
          corridor.free[c.index(i, j)] = c.free[c.index(i, j)];
  }
  const auto a = free_near(corridor, middle.front(), half_m), b = free_near(corridor, middle.back(), half_m);
  if (!a || !b) return false;
  std::vector<size_t> open{*a};
  corridor.free[*a] = 0;
  while (!open.empty()) {
    const size_t k = open.back();
    open.pop_back();
    if (k == *b) return true;
    const int i = static_cast<int>(k % c.width), j = static_cast<int>(k / c.width);
    for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (i + di < 0 || j + dj < 0 || i + di >= c.width || j + dj >= c.height) continue;
      const size_t n = c.index(i + di, j + dj);
      if (corridor.free[n]) corridor.free[n] = 0, open.push_back(n);
    }
  }
  return false;
}

bool swept(const FreeCells& truth, const std::vector<Vec2>& middle) {
  size_t in = 0;
  for (const Vec2& p : middle)
    if (const auto c = cell_at(truth, p); c && truth.free[*c]) ++in;
  return !middle.empty() && static_cast<double>(in) >= 0.95 * static_cast<double>(middle.size());
}

bool shows(const JunctionGraph& g, const Vec2& p, double reach_m) {
  for (size_t n = 0; n < g.node.size(); ++n)
    if (g.degree[n] >= 3 && (g.node[n] - p).norm() <= reach_m) return true;
  return false;
}

struct Ways {
  std::vector<double> ratio;
  std::int64_t unreachable = 0;
};

// From a few junctions, drawn by address, to all others.
Ways compare_ways(const FreeCells& truth, const FreeCells& map, const std::vector<Vec2>& junctions, double reach_m) {
  struct Drawn {
    std::uint64_t key;
    size_t junction;
  };
  std::vector<Drawn> drawn;
  for (size_t k = 0; k < junctions.size(); ++k) drawn.push_back({random_bits(0, Draw::eval_sample, k), k});
  std::sort(drawn.begin(), drawn.end(), [](const Drawn& a, const Drawn& b) { return a.key < b.key; });
  drawn.resize(std::min(drawn.size(), most_starts));
  std::vector<Ways> found(drawn.size());
  parallel_for(drawn.size(), [&](size_t k) {
    const Vec2& start = junctions[drawn[k].junction];
    const auto in_truth = free_near(truth, start, reach_m), in_map = free_near(map, start, reach_m);
    if (!in_truth) return;
    const std::vector<float> true_way = ways_from(truth, *in_truth);
    const std::vector<float> map_way = in_map ? ways_from(map, *in_map) : std::vector<float>{};
    for (size_t other = 0; other < junctions.size(); ++other) {
      const auto end = free_near(truth, junctions[other], reach_m), end_map = free_near(map, junctions[other], reach_m);
      if (other == drawn[k].junction || !end || !std::isfinite(true_way[*end]) || !(true_way[*end] > 0)) continue;
      if (map_way.empty() || !end_map || !std::isfinite(map_way[*end_map]))
        ++found[k].unreachable;
      else
        found[k].ratio.push_back(static_cast<double>(map_way[*end_map]) / static_cast<double>(true_way[*end]));
    }
  });
  Ways all;
  for (const Ways& w : found) {
    all.ratio.insert(all.ratio.end(), w.ratio.begin(), w.ratio.end());
    all.unreachable += w.unreachable;
  }
  return all;
}

// Of the edges of the map's graph those that run along a passage.
struct Edges {
  std::int64_t right = 0, all = 0;
};
Edges along_passages(const JunctionGraph& g, const World& world, const PassageMap& passages, const Places& places,
                     double height_W_m) {
  Edges edges;
  for (const auto& e : g.edge) {
    size_t in = 0;
    for (const Vec2& p : e.line) {
      const OnPassage at = passages.locate(places.back(p, height_W_m).head<2>());
      in += at.distance_m <= 0.5 * world.passages[static_cast<size_t>(at.passage)].width_m + 0.5;
    }
    edges.right += static_cast<double>(in) >= 0.8 * static_cast<double>(e.line.size());
    ++edges.all;
  }
  return edges;
}

double share(std::int64_t a, std::int64_t b) {
  return b ? static_cast<double>(a) / static_cast<double>(b) : none;
}

}  // namespace

void add_graph(const MetricList& list, const World& world, const PassageMap& passages, const TrueSection& s,
               const std::vector<Grid::Cell>& cells, const Pose& X_WM, const ScoreSettings& settings,
               const std::string& given_why) {
  const std::string why = given_why.empty() && passages.empty() ? "the world has no passages" : given_why;
  std::int64_t true_junctions = 0, found_junctions = 0, right_nodes = 0, nodes = 0, true_passages = 0,
               found_passages = 0;
  Edges edges;
  Ways ways;
  if (why.empty()) {
    std::vector<std::uint8_t> free(s.cell.size()), said(s.cell.size());
    for (size_t c = 0; c < s.cell.size(); ++c) {
      free[c] = s.cell[c] == CellTruth::free;
      said[c] = cells[c] == Grid::free;
    }
    const Places places(s, X_WM);
    const FreeCells truth = cells_of(s, free, graph_cell_m), map = cells_of(s, said, graph_cell_m);
    const JunctionGraph true_graph = junction_graph(truth, settings.pillar_m2),
                        map_graph = junction_graph(map, settings.pillar_m2);
    std::vector<Vec2> all, seen;
    double height_m = 0;
    for (const Junction& j : world.junctions) {
      height_m += j.p_W.z() / static_cast<double>(world.junctions.size());
      if (j.degree() < 3) continue;
      all.push_back(places.of(j.p_W));
      if (shows(true_graph, all.back(), settings.junction_m)) seen.push_back(all.back());
    }
    true_junctions = static_cast<std::int64_t>(seen.size());
    for (const Vec2& p : seen) found_junctions += shows(map_graph, p, settings.junction_m);
    for (size_t n = 0; n < map_graph.node.size(); ++n) {
      if (map_graph.degree[n] < 3) continue;
      ++nodes;
      right_nodes += std::any_of(all.begin(), all.end(),
                                 [&](const Vec2& p) { return (p - map_graph.node[n]).norm() <= settings.junction_m; });
    }
    for (const Passage& p : world.passages) {
      const std::vector<Vec2> middle = middle_of(p, places);
      if (!swept(truth, middle)) continue;
      ++true_passages;
      found_passages += leads_through(map, middle, p.width_m / 2);
    }
    edges = along_passages(map_graph, world, passages, places, height_m);
    ways = compare_ways(cells_of(s, free, way_cell_m), cells_of(s, said, way_cell_m), seen, settings.junction_m);
  }
  const auto because = [&](const char* what) { return why.empty() ? std::string(what) : why; };
  const auto add_share = [&](const char* name, std::int64_t a, std::int64_t b, const char* what) {
    list.add(name, why.empty() ? share(a, b) : none, "share", Better::higher, b, because(what));
  };
  list.count("junctions_true", true_junctions, Better::higher, why);
  list.count("junctions_found", found_junctions, Better::higher, why);
  add_share("junction_recall", found_junctions, true_junctions, "no junction was swept");
  add_share("junction_precision", right_nodes, nodes, "the map's free space has no junction");
  list.count("passages_true", true_passages, Better::higher, why);
  list.count("passages_found", found_passages, Better::higher, why);
  add_share("passage_recall", found_passages, true_passages, "no passage was swept from end to end");
  add_share("passage_precision", edges.right, edges.all, "the map's free space has no ways");
  list.count("broken_connections", true_passages - found_passages, Better::lower, why);
  const auto pairs = static_cast<std::int64_t>(ways.ratio.size());
  double worst = none;
  for (const double r : ways.ratio)
    if (!(std::abs(std::log(r)) <= std::abs(std::log(worst)))) worst = r;
  const std::string no_pair = because("no two junctions are joined by a way in section and map");
  list.add("path_ratio", quantile(ways.ratio, 0.5), "ratio", Better::higher, pairs, no_pair);
  list.add("path_ratio_worst", worst, "ratio", Better::higher, pairs, no_pair);
  list.count("unreachable", ways.unreachable, Better::lower, why);
}

}  // namespace adit
