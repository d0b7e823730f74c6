// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/tiles.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>

namespace adit {
namespace {

constexpr double hash_m = 2;       // squares in which columns are looked up
constexpr double roughness_m = 2;  // by which floor, roof and ribs may leave the outline
constexpr size_t apart = 6;        // columns between two cuts' ends on a rib

std::vector<Vec2> spaced(const Loop& loop, double edge_m) {
  double length = 0;
  for (size_t i = 0; i < loop.size(); ++i) length += (loop[(i + 1) % loop.size()] - loop[i]).norm();
  const int n = std::max(6, static_cast<int>(std::lround(length / edge_m)));
  std::vector<Vec2> points;
  points.reserve(n);
  double behind = 0;
  size_t i = 0;
  for (int k = 0; k < n; ++k) {
    const double s = length * k / n;
    double piece = (loop[(i + 1) % loop.size()] - loop[i]).norm();
    while (behind + piece < s && i + 1 < loop.size()) {
      behind += piece;
      ++i;
      piece = (loop[(i + 1) % loop.size()] - loop[i]).norm();
    }
    const double t = piece > 0 ? std::clamp((s - behind) / piece, 0.0, 1.0) : 0.0;
    points.push_back(loop[i] + t * (loop[(i + 1) % loop.size()] - loop[i]));
  }
  return points;
}

// The columns of all ribs by squares of the plan.
class Columns {
 public:
  explicit Columns(const std::vector<Loop>& ribs) : ribs_(ribs) {
    for (size_t l = 0; l < ribs.size(); ++l)
      for (size_t i = 0; i < ribs[l].size(); ++i) entries_.push_back({key(ribs[l][i], 0, 0), l, i});
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return a.key != b.key             ? a.key < b.key
             : a.end.loop != b.end.loop ? a.end.loop < b.end.loop
                                        : a.end.column < b.end.column;
    });
  }

  /// The column nearest to a point, within hash_m.
  std::optional<Cut::End> nearest(const Vec2& p) const {
    std::optional<Cut::End> best;
    double least = hash_m;
    for_near(p, [&](const Cut::End& e, double distance) {
      if (distance >= least) return;
      least = distance;
      best = e;
    });
    return best;
  }

  /// Whether every column near the way from one end to the other belongs to the rib at one of the two.
  bool free(const Cut::End& a, const Cut::End& b) const {
    const Vec2 &from = at(a), way = at(b) - from;
    const int steps = static_cast<int>(way.norm() / 0.5);
    for (int k = 1; k < steps; ++k) {
      const Vec2 p = from + way * k / steps;
      const double room = 0.7 * std::min((p - from).norm(), (at(b) - p).norm());
      bool clear = true;
      for_near(p, [&](const Cut::End&, double distance) { clear = clear && distance > std::min(room, 1.0); });
      if (!clear) return false;
    }
    return true;
  }

  const Vec2& at(const Cut::End& e) const { return ribs_[e.loop][e.column]; }

 private:
  struct Entry {
    std::int64_t key;
    Cut::End end;
    Entry(std::int64_t k, size_t l, size_t i) : key(k), end{l, i} {}
  };
  static std::int64_t key(const Vec2& p, int dx, int dy) {
    return ((static_cast<std::int64_t>(std::floor(p.y() / hash_m)) + dy) << 32) +
           static_cast<std::int64_t>(std::floor(p.x() / hash_m)) + dx;
  }
  template <class F>
  void for_near(const Vec2& p, const F& f) const {
    for (int dy = -1; dy <= 1; ++dy) {
      for (int dx = -1; dx <= 1; ++dx) {
        const std::int64_t k = key(p, dx, dy);
        auto it = std::lower_bound(entries_.begin(), entries_.end(), k,
                                   [](const Entry& a, std::int64_t b) { return a.key < b; });
        for (; it != entries_.end() && it->key == k; ++it) f(it->end, (at(it->end) - p).norm());
      }
    }
  }

  const std::vector<Loop>& ribs_;
  std::vector<Entry> entries_;
};

class Cutter {
 public:
  Cutter(const MinePlan& plan, const Workings& workings, Tiling& tiling, double edge_m)
      : plan_(plan),
        workings_(workings),
        t_(tiling),
        edge_m_(edge_m),
        columns_(tiling.ribs),
        used_(tiling.ribs.size()),
        cuts_(plan.passages.size()) {}

  /// Squares that a passage joins but that cannot be parted become one: `square` is (nodes) that of each.
  void cut(std::vector<int>& square) {
    for (size_t p = 0; p < plan_.passages.size();) {
      const int a = square[plan_.passages[p].a], b = square[plan_.passages[p].b];
      if (a == b || cuts_[p]) {
        ++p;
      } else if (cuts_[p] = across(p); cuts_[p]) {
        for (const Cut::End& e : {cuts_[p]->left, cuts_[p]->right}) used_[e.loop].push_back(e.column);
      } else {
        unite(square, a, b);
        p = 0;  // what stood in another cut's way may be gone
      }
    }
    t_.cuts.clear();
    t_.cut_of.assign(plan_.passages.size(), -1);
    for (size_t p = 0; p < cuts_.size(); ++p) {
      if (!cuts_[p]) continue;
      t_.cut_of[p] = static_cast<int>(t_.cuts.size());
      t_.cuts.push_back(*cuts_[p]);
    }
  }

  /// Makes one square of two and takes back the cuts between them.
  void unite(std::vector<int>& square, int a, int b) {
    std::replace(square.begin(), square.end(), std::max(a, b), std::min(a, b));
    for (size_t p = 0; p < cuts_.size(); ++p) {
      if (!cuts_[p] || square[plan_.passages[p].a] != square[plan_.passages[p].b]) continue;
      for (const Cut::End& e : {cuts_[p]->left, cuts_[p]->right}) std::erase(used_[e.loop], e.column);
      cuts_[p].reset();
    }
  }

 private:
  bool taken(const Cut::End& e) const {
    const size_t n = t_.ribs[e.loop].size();
    return std::any_of(used_[e.loop].begin(), used_[e.loop].end(), [&](size_t other) {
      const size_t off = (e.column + n - other) % n;
      return std::min(off, n - off) < apart;
    });
  }

  std::optional<Cut> across(size_t passage) const {
    const Drift& d = workings_.drifts()[passage];
    for (double share : {0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74}) {
      const auto k = static_cast<size_t>(share * static_cast<double>(d.line.size() - 1));
      if (k < 1 || k + 1 >= d.line.size()) continue;
      const Vec2 along = (d.line[k + 1] - d.line[k - 1]).normalized(), to_left(-along.y(), along.x());
      const auto left = columns_.nearest(d.line[k] + d.left[k] * to_left);
      const auto right = columns_.nearest(d.line[k] - d.right[k] * to_left);
      if (!left || !right || taken(*left) || taken(*right)) continue;
      if (left->loop == right->loop) {
        const size_t n = t_.ribs[left->loop].size(), off = (left->column + n - right->column) % n;
        if (std::min(off, n - off) < 2 * apart) continue;
      }
      // Straight across: both ribs within half a metre of where they are driven, and nothing between.
      const Vec2 way = columns_.at(*left) - columns_.at(*right);
      if (std::abs(way.dot(along)) > 0.3 + edge_m_ || std::abs(way.norm() - d.left[k] - d.right[k]) > 0.5) continue;
      if (columns_.free(*left, *right)) return Cut{passage, *left, *right};
    }
    return std::nullopt;
  }

  const MinePlan& plan_;
  const Workings& workings_;
  Tiling& t_;
  double edge_m_;
  Columns columns_;
  std::vector<std::vector<size_t>> used_;  // (loops) columns that are a cut's end
  std::vector<std::optional<Cut>> cuts_;   // (passages)
};

// A cut's end on a rib, and the tile whose rim begins or ends there.
struct Mark {
  size_t column;
  int cut;
  bool left;
};

class Walker {
 public:
  Walker(const MinePlan& plan, Tiling& t, const std::vector<int>& tile) : plan_(plan), t_(t), tile_(tile) {
    marks_.resize(t.ribs.size());
    for (size_t c = 0; c < t.cuts.size(); ++c) {
      marks_[t.cuts[c].left.loop].push_back({t.cuts[c].left.column, static_cast<int>(c), true});
      marks_[t.cuts[c].right.loop].push_back({t.cuts[c].right.column, static_cast<int>(c), false});
    }
    for (auto& m : marks_)
      std::sort(m.begin(), m.end(), [](const Mark& a, const Mark& b) { return a.column < b.column; });
  }

  /// Two squares that the ribs show to be one, or nothing: then `rims` holds the rims of every square.
  std::optional<std::pair<int, int>> walk(const std::vector<int>& square_of_loop,
                                          std::map<int, std::vector<std::vector<Run>>>& rims) {
    for (size_t l = 0; l < t_.ribs.size(); ++l) {
      if (marks_[l].empty()) rims[square_of_loop[l]].push_back({{l, 0, t_.ribs[l].size()}});
      for (size_t m = 0; m < marks_[l].size(); ++m) {
        if (done_.contains({l, m})) continue;
        std::vector<Run> rim;
        const int square = begins(marks_[l][m]);
        for (std::pair<size_t, size_t> at{l, m}; !done_.contains(at);) {
          done_[at] = true;
          const Mark& from = marks_[at.first][at.second];
          const size_t next = (at.second + 1) % marks_[at.first].size(), n = t_.ribs[at.first].size();
          const Mark& to = marks_[at.first][next];
          if (ends(to) != square) return std::pair{square, ends(to)};
          const size_t count = (to.column + n - from.column - 1) % n + 2;
          rim.push_back({at.first, from.column, count, to.cut, to.left});
          const Cut& cut = t_.cuts[to.cut];
          const Cut::End& other = to.left ? cut.right : cut.left;
          at = {other.loop, mark_at(other)};
        }
        rims[square].push_back(std::move(rim));
      }
    }
    return std::nullopt;
  }

 private:
  // Along a rib the void is to the left: it leaves a cut's left end towards node a, and its right end towards b.
  int begins(const Mark& m) const { return side(m.cut, m.left); }
  int ends(const Mark& m) const { return side(m.cut, !m.left); }
  int side(int cut, bool a) const {
    const PlanPassage& p = plan_.passages[t_.cuts[cut].passage];
    return tile_[a ? p.a : p.b];
  }
  size_t mark_at(const Cut::End& e) const {
    const auto& m = marks_[e.loop];
    for (size_t k = 0; k < m.size(); ++k)
      if (m[k].column == e.column) return k;
    ADIT_CHECK(false);
  }

  const MinePlan& plan_;
  Tiling& t_;
  const std::vector<int>& tile_;
  std::vector<std::vector<Mark>> marks_;
  std::map<std::pair<size_t, size_t>, bool> done_;
};

// The square of each loop that no cut meets: that of the junction nearest to it along the nearest passage.
std::vector<int> squares_of_loops(const MinePlan& plan, const Workings& workings, const Tiling& t,
                                  const std::vector<int>& tile) {
  std::vector<char> met(t.ribs.size(), 0);
  for (const Cut& c : t.cuts) met[c.left.loop] = met[c.right.loop] = 1;
  std::vector<Frame2> near;
  for (const Drift& d : workings.drifts()) {
    near.emplace_back();
    for (const Vec2& p : d.line) near.back().add(p);
  }
  std::vector<int> square(t.ribs.size(), 0);
  for (size_t l = 0; l < t.ribs.size(); ++l) {
    if (met[l]) continue;
    const Vec2& p = t.ribs[l].front();
    double least = 1e300;
    for (size_t i = 0; i < near.size(); ++i) {
      if (!near[i].meets({p, p}, std::min(least, 30.0))) continue;
      const auto& line = workings.drifts()[i].line;
      for (size_t k = 0; k < line.size(); ++k) {
        const double distance = (line[k] - p).norm();
        if (distance >= least) continue;
        least = distance;
        const PlanPassage& passage = plan.passages[i];
        square[l] = tile[2 * k < line.size() ? passage.a : passage.b];
      }
    }
  }
  return square;
}

std::vector<int> squares(const MinePlan& plan, double tile_m) {
  std::map<std::pair<long, long>, std::vector<size_t>> by_place;
  for (size_t n = 0; n < plan.nodes.size(); ++n) {
    const Vec2& p = plan.nodes[n];
    by_place[tile_m > 0 ? std::pair{std::lround(std::floor(p.x() / tile_m)), std::lround(std::floor(p.y() / tile_m))}
                        : std::pair{0L, 0L}]
        .push_back(n);
  }
  std::vector<int> square(plan.nodes.size());
  int id = 0;
  for (const auto& [place, nodes] : by_place) {
    for (size_t n : nodes) square[n] = id;
    ++id;
  }
  return square;
}

}  // namespace

Tiling tile_plan(const MinePlan& plan, const Workings& workings, const std::vector<Loop>& ribs, double tile_m,
                 double edge_m) {
  Tiling t;
  for (const Loop& loop : ribs) t.ribs.push_back(spaced(loop, edge_m));
  std::vector<int> square = squares(plan, tile_m);
  std::map<int, std::vector<std::vector<Run>>> rims;
  Cutter cutter(plan, workings, t, edge_m);
  for (;;) {
    cutter.cut(square);
    rims.clear();
    const auto one = Walker(plan, t, square).walk(squares_of_loops(plan, workings, t, square), rims);
    if (!one) break;
    cutter.unite(square, one->first, one->second);
  }
  std::map<int, size_t> index;
  for (auto& [id, own] : rims) {
    index[id] = t.tiles.size();
    Tile tile;
    for (const auto& rim : own)
      for (const Run& run : rim)
        for (size_t k = 0; k < run.count; ++k)
          tile.frame.add(t.ribs[run.loop][(run.first + k) % t.ribs[run.loop].size()]);
    tile.frame.low.array() -= roughness_m;
    tile.frame.high.array() += roughness_m;
    tile.rims = std::move(own);
    t.tiles.push_back(std::move(tile));
  }
  for (size_t p = 0; p < plan.passages.size(); ++p) {
    const int a = square[plan.passages[p].a], b = square[plan.passages[p].b];
    ADIT_CHECK(index.contains(a) && index.contains(b));
    t.tiles_of.emplace_back(index[a], index[b]);
    t.tiles[index[a]].passages.push_back(p);
  }
  return t;
}

}  // namespace adit
