// SPDX-License-Identifier: BSD-3-Clause
// Where water would stand in a space.
#include "worlds/contact.h"
#include "worlds/space.h"

#include <algorithm>
#include <cmath>

namespace adit {

void Space::find_neighbours() const {
  if (!next_.empty()) return;
  next_.assign(levels_, {-1, -1, -1});
  rim_.assign(rock_.vertex.size(), 0);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sides;  // lower and higher name; 3 k + c
  for (std::uint32_t k = 0; k < levels_; ++k)
    for (int c = 0; c < 3; ++c) {
      const std::uint64_t a = name(k, c), b = name(k, (c + 1) % 3);
      sides.emplace_back(std::min(a, b) << 32 | std::max(a, b), 3 * k + static_cast<std::uint32_t>(c));
    }
  std::sort(sides.begin(), sides.end());
  for (size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].first != sides[i + 1].first) continue;
    const std::uint32_t a = sides[i].second, b = sides[i + 1].second;
    next_[a / 3][a % 3] = static_cast<std::int32_t>(b / 3);
    next_[b / 3][b % 3] = static_cast<std::int32_t>(a / 3);
  }
  for (std::uint32_t k = 0; k < levels_; ++k)
    for (int c = 0; c < 3; ++c)
      if (next_[k][c] < 0) rim_[name(k, c)] = rim_[name(k, (c + 1) % 3)] = 1;
}

bool Space::stands_in(const std::array<Vec2, 3>& t, double below_z) const {
  Box3 own;
  for (const Vec2& p : t) own.add({p.x(), p.y(), 0});
  const auto from = cell_of(own.low.head<2>()), to = cell_of(own.high.head<2>());
  for (long y = from.second; y <= to.second; ++y)
    for (long x = from.first; x <= to.first; ++x) {
      const auto found = placed_at_.find({x, y});
      if (found == placed_at_.end()) continue;
      for (std::uint32_t i : found->second) {
        const Placed& other = placed_[i];
        if (other.low.z() > below_z + 0.01 || (other.low.head<2>().array() > own.high.head<2>().array()).any() ||
            (other.high.head<2>().array() < own.low.head<2>().array()).any())
          continue;
        for (const auto& f : other.body.face)
          if (near_in_plan(t, {other.body.vertex[f[0]].head<2>(), other.body.vertex[f[1]].head<2>(),
                               other.body.vertex[f[2]].head<2>()}))
            return true;
      }
    }
  return false;
}

// Of the triangles marked those joined to one by sides, without points at which the sheet only touches itself.
void Space::keep_sheet(std::vector<char>& wet, std::uint32_t from) const {
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<char> reached(levels_, 0);
    std::vector<std::uint32_t> front;
    if (wet[from]) front.push_back(from), reached[from] = 1;
    std::map<std::uint32_t, int> rims;  // sides of the rim at each vertex
    std::vector<std::uint32_t> sheet;
    while (!front.empty()) {
      const std::uint32_t k = front.back();
      front.pop_back();
      sheet.push_back(k);
      for (int c = 0; c < 3; ++c) {
        const std::int32_t n = next_[k][c];
        if (n < 0 || !wet[n]) {
          ++rims[name(k, c)];
          ++rims[name(k, (c + 1) % 3)];
        } else if (!reached[n]) {
          reached[n] = 1;
          front.push_back(static_cast<std::uint32_t>(n));
        }
      }
    }
    wet = std::move(reached);
    for (std::uint32_t k : sheet)
      for (int c = 0; c < 3; ++c) {
        const auto at = rims.find(name(k, c));
        if (at == rims.end() || at->second <= 2) continue;
        changed = true;
        wet[k] = 0;
      }
    if (!changed || wet[from]) continue;
    const auto left = std::find_if(sheet.begin(), sheet.end(), [&](std::uint32_t k) { return wet[k] != 0; });
    if (left == sheet.end()) return;
    from = *left;
  }
}

std::optional<Basin> Space::basin(const Vec2& lowest, double depth_m, double reach_m) const {
  constexpr double thin_m = 0.012;
  find_neighbours();
  const auto here = level(lowest);
  if (!here) return std::nullopt;
  Basin basin{{}, here->floor_z + depth_m};
  std::uint32_t seed = 0;
  double nearest = 1e300;
  const auto middle = [&](std::uint32_t k) -> Vec2 { return (corner(k, 0).p + corner(k, 1).p + corner(k, 2).p) / 3; };
  std::vector<char> wet(levels_, 0), asked(levels_, 0);
  const auto holds = [&](std::uint32_t k) {
    std::array<Vec2, 3> plan;
    for (int c = 0; c < 3; ++c) {
      const LevelPoint v = corner(k, c);
      if (v.floor_z > basin.level_z - thin_m || v.roof_z < basin.level_z + 0.1 || on_rim(k, c)) return false;
      plan[c] = v.p;
    }
    return !stands_in(plan, basin.level_z);
  };
  std::vector<std::uint32_t> front;
  const Vec2 about = Vec2::Constant(1.0);
  plan_.for_near(lowest - about, lowest + about, [&](std::uint32_t k) {
    const double d = (middle(k) - lowest).norm();
    if (d < nearest && holds(k)) nearest = d, seed = k;
  });
  if (nearest > 1.5) return std::nullopt;
  front.push_back(seed);
  asked[seed] = wet[seed] = 1;
  size_t n = 1;
  while (!front.empty()) {
    const std::uint32_t k = front.back();
    front.pop_back();
    if ((middle(k) - lowest).norm() > reach_m) return std::nullopt;
    for (std::int32_t next : next_[k]) {
      if (next < 0 || asked[next]) continue;
      asked[next] = 1;
      if (!holds(static_cast<std::uint32_t>(next))) continue;
      wet[next] = 1;
      ++n;
      front.push_back(static_cast<std::uint32_t>(next));
    }
  }
  if (n < 12) return std::nullopt;
  keep_sheet(wet, seed);
  std::map<std::uint32_t, std::uint32_t> index;
  for (std::uint32_t k = 0; k < levels_; ++k) {
    if (!wet[k]) continue;
    basin.patch.piece.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const auto [found, fresh] = index.emplace(name(k, c), static_cast<std::uint32_t>(basin.patch.vertex.size()));
      if (fresh) basin.patch.vertex.push_back(corner(k, c));
      basin.patch.piece.back().push_back(found->second);
    }
  }
  if (basin.patch.piece.size() < 12) return std::nullopt;
  return basin;
}

}  // namespace adit
