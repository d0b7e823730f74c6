// SPDX-License-Identifier: BSD-3-Clause
#include "eval/passage_map.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace adit {
namespace {

constexpr double cell_m = 4;
constexpr double infinity = std::numeric_limits<double>::infinity();

double distance(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
  return (a + t * d - p).norm();
}

}  // namespace

PassageMap::PassageMap(const World& world) : world_(&world) {
  Vec2 low = Vec2::Constant(infinity), high = -low;
  for (size_t k = 0; k < world.passages.size(); ++k) {
    const auto& line = world.passages[k].centre_line;
    double from_m = 0;
    for (size_t i = 0; i + 1 < line.size(); ++i) {
      const Vec2 a = line[i].head<2>(), b = line[i + 1].head<2>();
      segments_.push_back({a, b, static_cast<int>(k), from_m});
      from_m += (b - a).norm();
      low = low.cwiseMin(a).cwiseMin(b);
      high = high.cwiseMax(a).cwiseMax(b);
    }
    length_m_.push_back(from_m);
  }
  if (segments_.empty()) return;
  origin_ = low - Vec2::Constant(2 * cell_m);
  width_ = static_cast<int>((high.x() - origin_.x()) / cell_m) + 3;
  height_ = static_cast<int>((high.y() - origin_.y()) / cell_m) + 3;
  cells_.resize(static_cast<size_t>(width_) * height_);
  parallel_for(cells_.size(), [&](size_t c) {
    const Vec2 centre =
        origin_ + cell_m * Vec2(static_cast<double>(c % width_) + 0.5, static_cast<double>(c / width_) + 0.5);
    double nearest = infinity;
    for (const Piece& s : segments_) nearest = std::min(nearest, distance(centre, s.a, s.b));
    // A point of the cell is within half a diagonal of its centre.
    for (std::uint32_t s = 0; s < segments_.size(); ++s)
      if (distance(centre, segments_[s].a, segments_[s].b) <= nearest + 1.4143 * cell_m) cells_[c].push_back(s);
  });
}

OnPassage PassageMap::foot(const Piece& piece, const Vec2& p) const {
  const Vec2 d = piece.b - piece.a;
  const double t = d.squaredNorm() > 0 ? std::clamp((p - piece.a).dot(d) / d.squaredNorm(), 0.0, 1.0) : 0;
  return {piece.passage, piece.from_m + t * d.norm(), (piece.a + t * d - p).norm()};
}

OnPassage PassageMap::locate(const Vec2& p) const {
  ADIT_CHECK(!empty());
  OnPassage best{-1, 0, infinity};
  const auto look = [&](const Piece& piece) {
    const OnPassage at = foot(piece, p);
    if (at.distance_m < best.distance_m) best = at;
  };
  const Vec2 c = ((p - origin_) / cell_m).array().floor();
  if (c.minCoeff() >= 0 && c.x() < width_ && c.y() < height_) {
    for (const std::uint32_t s : cells_[static_cast<size_t>(c.y()) * width_ + static_cast<size_t>(c.x())])
      look(segments_[s]);
  } else {
    for (const Piece& piece : segments_) look(piece);
  }
  return best;
}

double PassageMap::to_end(const OnPassage& at, bool end_b) const {
  return end_b ? length_m_[at.passage] - at.along_m : at.along_m;
}

// Dijkstra over the junctions: the passages on the way, each with +1 or -1.
std::vector<std::pair<int, int>> PassageMap::way_between(int from, int to) const {
  const World& w = *world_;
  std::vector<double> cost(w.junctions.size(), infinity);
  std::vector<int> by(w.junctions.size(), -1);
  std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> open;
  cost[from] = 0;
  open.push({0, from});
  while (!open.empty()) {
    const auto [c, j] = open.top();
    open.pop();
    if (c > cost[j]) continue;
    if (j == to) break;
    for (const int k : w.junctions[j].passages) {
      const int other = w.passages[k].a == j ? w.passages[k].b : w.passages[k].a;
      if (c + length_m_[k] < cost[other]) {
        cost[other] = c + length_m_[k];
        by[other] = k;
        open.push({cost[other], other});
      }
    }
  }
  std::vector<std::pair<int, int>> way;
  for (int j = to; j != from && by[j] >= 0;) {
    const Passage& passage = w.passages[by[j]];
    way.push_back({by[j], passage.b == j ? 1 : -1});
    j = passage.b == j ? passage.a : passage.b;
  }
  return way;
}

void PassageMap::add_way(const OnPassage& a, const OnPassage& b, std::vector<double>& chain) const {
  if (a.passage == b.passage) {
    chain[a.passage] += (b.along_m - a.along_m) / length_m_[a.passage];
    return;
  }
  const Passage &from = world_->passages[a.passage], &to = world_->passages[b.passage];
  double best = infinity;
  bool from_b = false, to_b = false;
  // Neighbours first: the junction that both share.
  for (const bool eb : {false, true})
    for (const bool tb : {false, true})
      if ((eb ? from.b : from.a) == (tb ? to.b : to.a) && to_end(a, eb) + to_end(b, tb) < best) {
        best = to_end(a, eb) + to_end(b, tb);
        from_b = eb;
        to_b = tb;
      }
  if (best == infinity) {
    from_b = to_end(a, true) < to_end(a, false);
    to_b = to_end(b, true) < to_end(b, false);
    for (const auto& [passage, sign] : way_between(from_b ? from.b : from.a, to_b ? to.b : to.a))
      chain[passage] += sign;
  }
  chain[a.passage] += from_b ? to_end(a, true) / length_m_[a.passage] : -to_end(a, false) / length_m_[a.passage];
  chain[b.passage] += to_b ? -to_end(b, true) / length_m_[b.passage] : to_end(b, false) / length_m_[b.passage];
}

}  // namespace adit
