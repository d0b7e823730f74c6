// SPDX-License-Identifier: BSD-3-Clause
#include "eval/junction_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>
#include <utility>

namespace adit {
namespace {

constexpr double least_half_width_m = 0.3, stub_m = 1.5, merge_share = 0.8, knot_m = 4;

// Neighbours in the order of Zhang and Suen: north, then clockwise.
constexpr std::array<std::pair<int, int>, 8> around{
    {{0, 1}, {1, 1}, {1, 0}, {1, -1}, {0, -1}, {-1, -1}, {-1, 0}, {-1, 1}}};

// Parts of equal cells that are smaller than so many become what lies about them.
void fill_small(FreeCells& cells, size_t least, std::uint8_t kind) {
  std::vector<std::uint8_t> seen(cells.free.size(), 0);
  std::vector<size_t> part, open;
  for (size_t start = 0; start < cells.free.size(); ++start) {
    if (seen[start] || cells.free[start] != kind) continue;
    part.clear();
    open.assign(1, start);
    seen[start] = 1;
    while (!open.empty()) {
      const size_t c = open.back();
      open.pop_back();
      part.push_back(c);
      const int i = static_cast<int>(c % cells.width), j = static_cast<int>(c / cells.width);
      for (const auto& [di, dj] : around) {
        if (i + di < 0 || j + dj < 0 || i + di >= cells.width || j + dj >= cells.height) continue;
        const size_t next = cells.index(i + di, j + dj);
        if (seen[next] || cells.free[next] != kind) continue;
        seen[next] = 1;
        open.push_back(next);
      }
    }
    if (part.size() < least)
      for (const size_t c : part) cells.free[c] = !kind;
  }
}

class Skeleton {
 public:
  explicit Skeleton(FreeCells cells) : c_(std::move(cells)) {
    std::vector<size_t> alive;
    for (size_t k = 0; k < c_.free.size(); ++k)
      if (c_.free[k]) alive.push_back(k);
    for (bool changed = true; changed;) {
      changed = false;
      for (const bool second : {false, true}) {
        std::vector<size_t> gone, kept;
        for (const size_t k : alive) (goes(k, second) ? gone : kept).push_back(k);
        for (const size_t k : gone) c_.free[k] = 0;
        changed = changed || !gone.empty();
        alive.swap(kept);
      }
    }
    pixels_ = std::move(alive);
  }
  const std::vector<size_t>& pixels() const { return pixels_; }
  std::vector<size_t> neighbours(size_t k) const {
    std::vector<size_t> out;
    const int i = static_cast<int>(k % c_.width), j = static_cast<int>(k / c_.width);
    for (const auto& [di, dj] : around)
      if (on(i + di, j + dj)) out.push_back(c_.index(i + di, j + dj));
    return out;
  }

 private:
  FreeCells c_;
  std::vector<size_t> pixels_;

  bool on(int i, int j) const { return i >= 0 && j >= 0 && i < c_.width && j < c_.height && c_.free[c_.index(i, j)]; }
  std::array<bool, 8> ring(size_t k) const {
    const int i = static_cast<int>(k % c_.width), j = static_cast<int>(k / c_.width);
    std::array<bool, 8> p{};
    for (size_t n = 0; n < 8; ++n) p[n] = on(i + around[n].first, j + around[n].second);
    return p;
  }
  static int rises(const std::array<bool, 8>& p) {
    int n = 0;
    for (size_t k = 0; k < 8; ++k) n += !p[k] && p[(k + 1) % 8];
    return n;
  }
  bool goes(size_t k, bool second) const {
    const auto p = ring(k);
    const auto n = std::count(p.begin(), p.end(), true);
    if (n < 2 || n > 6 || rises(p) != 1) return false;
    return second ? !(p[0] && p[2] && p[6]) && !(p[0] && p[4] && p[6])
                  : !(p[0] && p[2] && p[4]) && !(p[2] && p[4] && p[6]);
  }
};

// Nodes and the lines of pixels between them.
struct Web {
  std::vector<std::vector<size_t>> cluster;  // (nodes) pixels
  struct Line {
    int a, b;
    std::vector<size_t> pixels;  // between the nodes
  };
  std::vector<Line> lines;
};

Web web_of(const Skeleton& skeleton, size_t cells) {
  Web web;
  std::vector<int> node(cells, -1);
  const auto is_node = [&](size_t k) { return skeleton.neighbours(k).size() != 2; };
  for (const size_t start : skeleton.pixels()) {
    if (node[start] >= 0 || !is_node(start)) continue;
    const int id = static_cast<int>(web.cluster.size());
    web.cluster.emplace_back();
    std::vector<size_t> open{start};
    node[start] = id;
    while (!open.empty()) {
      const size_t k = open.back();
      open.pop_back();
      web.cluster.back().push_back(k);
      for (const size_t n : skeleton.neighbours(k))
        if (node[n] < 0 && is_node(n)) node[n] = id, open.push_back(n);
    }
  }
  std::vector<std::uint8_t> walked(cells, 0);
  // A pixel that is no node has two neighbours: one goes on at the other.
  const auto walk = [&](int from, size_t before, size_t at) {
    Web::Line line{from, from, {}};
    while (true) {
      walked[at] = 1;
      line.pixels.push_back(at);
      const std::vector<size_t> both = skeleton.neighbours(at);
      const size_t next = both[0] == before ? both[1] : both[0];
      if (node[next] >= 0) line.b = node[next];
      if (node[next] >= 0 || walked[next]) break;
      before = at;
      at = next;
    }
    web.lines.push_back(std::move(line));
  };
  for (size_t id = 0; id < web.cluster.size(); ++id)
    for (const size_t k : web.cluster[id])
      for (const size_t n : skeleton.neighbours(k))
        if (node[n] < 0 && !walked[n]) walk(static_cast<int>(id), k, n);
  // Rings without a junction get a node where they are met first.
  for (const size_t k : skeleton.pixels()) {
    if (node[k] >= 0 || walked[k]) continue;
    node[k] = static_cast<int>(web.cluster.size());
    web.cluster.push_back({k});
    walked[k] = 1;
    for (const size_t n : skeleton.neighbours(k))
      if (!walked[n]) walk(node[k], k, n);
  }
  return web;
}

JunctionGraph graph_of(const Web& web, const FreeCells& cells) {
  JunctionGraph g;
  const auto place = [&](size_t k) {
    return Vec2(cells.cell_m * (static_cast<double>(k % cells.width) + 0.5),
                cells.cell_m * (static_cast<double>(k / cells.width) + 0.5));
  };
  for (const auto& cluster : web.cluster) {
    Vec2 sum = Vec2::Zero();
    for (const size_t k : cluster) sum += place(k);
    g.node.push_back(sum / static_cast<double>(cluster.size()));
  }
  for (const Web::Line& l : web.lines) {
    JunctionGraph::Edge e{l.a, l.b, {g.node[l.a]}, 0};
    for (const size_t k : l.pixels) e.line.push_back(place(k));
    e.line.push_back(g.node[l.b]);
    for (size_t k = 1; k < e.line.size(); ++k) e.length_m += (e.line[k] - e.line[k - 1]).norm();
    g.edge.push_back(std::move(e));
  }
  return g;
}

void count_degrees(JunctionGraph& g) {
  g.degree.assign(g.node.size(), 0);
  for (const auto& e : g.edge) ++g.degree[e.a], ++g.degree[e.b];
}

// Rings about nothing, as thinning leaves them within a crossing, are no ways round a pillar.
void drop_knots(JunctionGraph& g) {
  std::erase_if(g.edge, [](const JunctionGraph::Edge& e) { return e.a == e.b && e.length_m < knot_m; });
}

// Two edges at a node of degree 2 become one.
void join_bends(JunctionGraph& g) {
  drop_knots(g);
  count_degrees(g);
  for (int n = 0; n < static_cast<int>(g.node.size()); ++n) {
    if (g.degree[n] != 2) continue;
    std::vector<size_t> at;
    for (size_t k = 0; k < g.edge.size(); ++k)
      if (g.edge[k].a == n || g.edge[k].b == n) at.push_back(k);
    if (at.size() != 2) continue;  // a ring
    auto one = g.edge[at[0]], two = g.edge[at[1]];
    if (one.a == n) std::swap(one.a, one.b), std::reverse(one.line.begin(), one.line.end());
    if (two.b == n) std::swap(two.a, two.b), std::reverse(two.line.begin(), two.line.end());
    one.b = two.b;
    one.line.insert(one.line.end(), two.line.begin() + 1, two.line.end());
    one.length_m += two.length_m;
    g.edge[at[0]] = std::move(one);
    g.edge.erase(g.edge.begin() + static_cast<std::ptrdiff_t>(at[1]));
    g.degree[n] = 0;
  }
  count_degrees(g);
}

// The shortest stub that is none goes first: what it leaves may be a bend, and its neighbours longer.
void prune(JunctionGraph& g, const std::vector<double>& clearance) {
  while (true) {
    join_bends(g);
    size_t best = g.edge.size();
    for (size_t k = 0; k < g.edge.size(); ++k) {
      const auto& e = g.edge[k];
      const bool leaf = (g.degree[e.a] == 1) != (g.degree[e.b] == 1);
      const int root = g.degree[e.a] == 1 ? e.b : e.a;
      if (!leaf || e.length_m >= clearance[root] + stub_m) continue;
      if (best == g.edge.size() || e.length_m < g.edge[best].length_m) best = k;
    }
    if (best == g.edge.size()) return;
    g.edge.erase(g.edge.begin() + static_cast<std::ptrdiff_t>(best));
  }
}

// Junctions of one crossing become one.
void merge(JunctionGraph& g, std::vector<double>& clearance) {
  while (true) {
    size_t best = g.edge.size();
    for (size_t k = 0; k < g.edge.size(); ++k) {
      const auto& e = g.edge[k];
      if (e.a == e.b || g.degree[e.a] < 3 || g.degree[e.b] < 3) continue;
      if (e.length_m > merge_share * (clearance[e.a] + clearance[e.b])) continue;
      if (best == g.edge.size() || e.length_m < g.edge[best].length_m) best = k;
    }
    if (best == g.edge.size()) return;
    const int a = g.edge[best].a, b = g.edge[best].b;
    g.node[a] = (g.node[a] + g.node[b]) / 2;
    clearance[a] = std::max(clearance[a], clearance[b]);
    g.edge.erase(g.edge.begin() + static_cast<std::ptrdiff_t>(best));
    for (auto& e : g.edge) {
      if (e.a == b) e.a = a;
      if (e.b == b) e.b = a;
    }
    join_bends(g);
  }
}

}  // namespace

FreeCells coarsened(const FreeCells& cells, int factor) {
  if (factor <= 1) return cells;
  FreeCells out{cells.cell_m * factor, (cells.width + factor - 1) / factor, (cells.height + factor - 1) / factor, {}};
  out.free.assign(static_cast<size_t>(out.width) * out.height, 0);
  for (int j = 0; j < out.height; ++j)
    for (int i = 0; i < out.width; ++i) {
      int n = 0;
      for (int b = j * factor; b < std::min(cells.height, (j + 1) * factor); ++b)
        for (int a = i * factor; a < std::min(cells.width, (i + 1) * factor); ++a) n += cells.free[cells.index(a, b)];
      out.free[out.index(i, j)] = 2 * n >= factor * factor;
    }
  return out;
}

std::vector<float> clearance_m(const FreeCells& cells) {
  std::vector<float> d(cells.free.size());
  const auto at = [&](int i, int j) {
    return i < 0 || j < 0 || i >= cells.width || j >= cells.height ? 0.0f : d[cells.index(i, j)];
  };
  for (size_t k = 0; k < d.size(); ++k) d[k] = cells.free[k] ? 1e9f : 0;
  for (int j = 0; j < cells.height; ++j)
    for (int i = 0; i < cells.width; ++i) {
      float& v = d[cells.index(i, j)];
      v = std::min({v, at(i - 1, j) + 3, at(i, j - 1) + 3, at(i - 1, j - 1) + 4, at(i + 1, j - 1) + 4});
    }
  for (int j = cells.height; j-- > 0;)
    for (int i = cells.width; i-- > 0;) {
      float& v = d[cells.index(i, j)];
      v = std::min({v, at(i + 1, j) + 3, at(i, j + 1) + 3, at(i + 1, j + 1) + 4, at(i - 1, j + 1) + 4});
    }
  for (float& v : d) v *= static_cast<float>(cells.cell_m / 3);
  return d;
}

JunctionGraph junction_graph(const FreeCells& given, double island_m2) {
  FreeCells cells = given;
  const auto least = static_cast<size_t>(std::ceil(island_m2 / (cells.cell_m * cells.cell_m)));
  fill_small(cells, least, 0);
  const std::vector<float> wide = clearance_m(cells);
  for (size_t k = 0; k < cells.free.size(); ++k) cells.free[k] = wide[k] > least_half_width_m;
  fill_small(cells, least, 1);
  const Skeleton skeleton(cells);
  const Web web = web_of(skeleton, cells.free.size());
  JunctionGraph g = graph_of(web, cells);
  std::vector<double> clearance;
  for (const auto& cluster : web.cluster) {
    double most = 0;
    for (const size_t k : cluster) most = std::max(most, static_cast<double>(wide[k]));
    clearance.push_back(most);
  }
  prune(g, clearance);
  merge(g, clearance);
  prune(g, clearance);
  return g;
}

std::vector<float> ways_from(const FreeCells& cells, size_t from) {
  std::vector<float> way(cells.free.size(), std::numeric_limits<float>::infinity());
  using Step = std::pair<float, size_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  way[from] = 0;
  open.push({0, from});
  while (!open.empty()) {
    const auto [d, k] = open.top();
    open.pop();
    if (d > way[k]) continue;
    const int i = static_cast<int>(k % cells.width), j = static_cast<int>(k / cells.width);
    for (const auto& [di, dj] : around) {
      if (i + di < 0 || j + dj < 0 || i + di >= cells.width || j + dj >= cells.height) continue;
      const size_t n = cells.index(i + di, j + dj);
      if (!cells.free[n]) continue;
      const float next = d + static_cast<float>(cells.cell_m * (di != 0 && dj != 0 ? std::sqrt(2.0) : 1.0));
      if (next < way[n]) way[n] = next, open.push({next, n});
    }
  }
  return way;
}

}  // namespace adit
