// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/furniture.h"

#include "base/rng.h"
#include "worlds/fittings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double junction_m = 1.5;  // kept clear about a junction beyond half its width
constexpr double gauge_m = 1.067;

enum What : std::uint64_t { posts = 1, crossbars, cribs, bolts, track, belts, pipes, cables, blocks, pools, stones };

// A passage's centre line by its length.
class Way {
 public:
  Way(const Drift& d, double clear_a_m, double clear_b_m) : line_(d.line), from_m(clear_a_m) {
    at_.push_back(0.0);
    for (size_t i = 1; i < line_.size(); ++i) at_.push_back(at_.back() + (line_[i] - line_[i - 1]).norm());
    to_m = at_.back() - clear_b_m;
  }
  double length_m() const { return at_.back(); }
  Spot at(double s) const {
    const auto next = std::upper_bound(at_.begin(), at_.end(), s);
    const size_t k = std::clamp<size_t>(static_cast<size_t>(next - at_.begin()), 1, line_.size() - 1);
    const double t = std::clamp((s - at_[k - 1]) / (at_[k] - at_[k - 1]), 0.0, 1.0);
    const size_t a = k >= 2 ? k - 2 : 0, b = std::min(k + 1, line_.size() - 1);
    return {line_[k - 1] + t * (line_[k] - line_[k - 1]), (line_[b] - line_[a]).normalized()};
  }

 private:
  const std::vector<Vec2>& line_;
  std::vector<double> at_;

 public:
  double from_m, to_m;  // where things may stand
};

double yaw_of(const Vec2& v) {
  return std::atan2(v.y(), v.x());
}

class Furnisher {
 public:
  Furnisher(const FurniturePlan& plan, Space& space)
      : plan_(plan), s_(plan.settings.furniture), space_(space), degree_(plan.plan.nodes.size(), 0) {
    for (const PlanPassage& p : plan.plan.passages) ++degree_[p.a], ++degree_[p.b];
    widest_.assign(degree_.size(), 0.0);
    for (const PlanPassage& p : plan.plan.passages)
      for (int n : {p.a, p.b}) widest_[n] = std::max(widest_[n], p.width_m);
  }

  void furnish(const std::vector<size_t>& passages) {
    for (size_t p : passages) {
      passage_ = p;
      const Way way = way_of(p);
      for (const Blocker& b : plan_.decay.blockers)
        if (b.passage == p) add_blocker(b, way);
      if (way.to_m - way.from_m < 2) continue;
      if (has(posts, s_.post_share))
        add_posts(way);
      else if (has(crossbars, s_.crossbar_share / std::max(1e-9, 1 - s_.post_share)))
        add_crossbars(way);
      add_cribs(way);
      add_blocks(way);
    }
    add_stones();
    for (size_t p : passages) {  // water keeps off what stands in it; track under water is not seen, and left out
      passage_ = p;
      add_pools(way_of(p));
    }
    for (size_t p : passages) {
      passage_ = p;
      const Way way = way_of(p);
      if (way.to_m - way.from_m < 2) continue;
      if (has(track, s_.track_share)) add_track(way);
      if (has(belts, s_.belt_share)) add_belt(way);
      if (has(bolts, s_.bolt_share)) add_bolts(way);
      if (has(pipes, s_.pipe_share)) add_line(way, pipes);
      if (has(cables, s_.cable_share)) add_line(way, cables);
    }
  }

 private:
  double lot(What what, std::uint64_t k) const {
    return uniform(plan_.seed, Draw::world_furniture, static_cast<std::uint64_t>(what) << 40 | passage_, k);
  }
  double lot(What what, std::uint64_t k, double low, double high) const { return low + (high - low) * lot(what, k); }
  bool has(What what, double share) const { return lot(what, 0) < share; }
  bool put(Label label, Bodies bodies, double yaw, bool blocks = false) {
    return space_.put(label, static_cast<int>(passage_), std::move(bodies), yaw, blocks);
  }

  Way way_of(size_t p) const {
    const PlanPassage& passage = plan_.plan.passages[p];
    const auto clear = [&](int node) { return degree_[node] > 1 ? 0.5 * widest_[node] + junction_m : 0.3; };
    return {plan_.drifts[p], clear(passage.a), clear(passage.b)};
  }
  double lane() const { return 0.5 * s_.lane_m; }

  // How many of a density stand here: the whole part, and one more by chance.
  int count(What what, double per_100m, const Way& way) const {
    const double expected = std::max(0.0, per_100m) * way.length_m() / 100;
    return static_cast<int>(expected + lot(what, 0));
  }

  // Rows along both ribs.
  void add_posts(const Way& way) {
    std::uint64_t k = 1;
    for (double s = way.from_m; s < way.to_m; s += s_.post_spacing_m, k += 8) {
      for (int side = 0; side < 2; ++side) {
        const std::uint64_t j = k + 4 * static_cast<std::uint64_t>(side);
        const Spot spot = way.at(s + lot(posts, j, -0.1, 0.1));
        const double sign = side ? -1 : 1, radius = lot(posts, j + 1, 0.075, 0.1);
        const double off = free_m(space_, spot, sign, {0.1, 0.3, 0.5, 0.7, 0.9}) - lot(posts, j + 2, 0.28, 0.5);
        if (off - radius < lane() || !std::isfinite(off)) continue;
        put(Label::post, post(space_, spot.beside(sign * off), spot.along, radius), yaw_of(spot.along));
      }
    }
  }

  void add_crossbars(const Way& way) {
    std::uint64_t k = 1;
    for (double s = way.from_m + 0.3; s < way.to_m - 0.2; s += s_.crossbar_spacing_m, ++k) {
      const Spot spot = way.at(s + lot(crossbars, k, -0.08, 0.08));
      const std::vector<double> shares{0.08, 0.3, 0.5, 0.7, 0.85, 0.97};
      const double left = free_m(space_, spot, 1, shares) - 0.12, right = -free_m(space_, spot, -1, shares) + 0.12;
      if (std::min(left, -right) - 0.3 < lane() || !(left - right < 30)) continue;
      put(Label::crossbar, crossbar(space_, spot, right, left), yaw_of(spot.left()));
    }
  }

  void add_cribs(const Way& way) {
    const int n = count(cribs, s_.cribs_per_100m, way);
    for (int i = 0; i < n; ++i) {
      const std::uint64_t k = 1 + 8 * static_cast<std::uint64_t>(i);
      const Spot spot = way.at(lot(cribs, k, way.from_m + 0.5, way.to_m - 0.5));
      const double side = lot(cribs, k + 1, 0.75, 0.9), sign = lot(cribs, k + 2) < 0.5 ? -1 : 1;
      const double off = free_m(space_, spot, sign, {0.3, 0.5, 0.7, 0.9}) - 0.06 - 0.5 * side;
      if (off - 0.5 * side < lane() || !std::isfinite(off)) continue;
      const double turn = lot(cribs, k + 3, -0.12, 0.12);
      const Vec2 along = Eigen::Rotation2Dd(turn) * spot.along;
      put(Label::crib, crib(space_, spot.beside(sign * off), along, side), yaw_of(along));
    }
  }

  void add_bolts(const Way& way) {
    const double width = plan_.plan.passages[passage_].width_m;
    const int rows = std::max(1, static_cast<int>((width - 0.6) / s_.bolt_spacing_m) + 1);
    std::uint64_t k = 1;
    for (double s = way.from_m; s < way.to_m; s += s_.bolt_spacing_m)
      for (int r = 0; r < rows; ++r, k += 2) {
        const Spot spot = way.at(s + lot(bolts, k, -0.08, 0.08));
        const Vec2 p = spot.beside((r - 0.5 * (rows - 1)) * s_.bolt_spacing_m + lot(bolts, k + 1, -0.08, 0.08));
        put(Label::bolt, bolt(space_, p, spot.along), yaw_of(spot.along));
      }
  }

  // Ties, then rails over the highest of them.
  void add_track(const Way& way) {
    constexpr double length = 3, gap = 0.6;
    const auto pieces = static_cast<int>((way.to_m - way.from_m) / length);
    for (int i = 0; i < pieces; ++i) {
      const double begin = way.from_m + i * length;
      const Spot from = way.at(begin + 0.01), to = way.at(begin + length - 0.01);
      std::vector<std::pair<double, double>> tops;  // along, height
      for (int j = 0; j < 5; ++j) {
        const std::uint64_t k = 1 + 16 * static_cast<std::uint64_t>(i) + 2 * static_cast<std::uint64_t>(j);
        const double s = begin + gap * (j + 0.5) + lot(track, k, -0.05, 0.05);
        Spot spot = way.at(s);
        spot.along = Eigen::Rotation2Dd(lot(track, k + 1, -0.05, 0.05)) * spot.along;
        double top = 0;
        if (put(Label::tie, tie(space_, spot, 0.85, &top), yaw_of(spot.left()))) tops.emplace_back(s - begin, top);
      }
      if (tops.size() < 2) continue;
      for (double side : {-0.5, 0.5}) add_rail(from.beside(side * gauge_m), to.beside(side * gauge_m), tops, length);
    }
  }

  // A straight bar over all of its ties and the floor, as low as it can lie.
  void add_rail(const Vec2& from, const Vec2& to, const std::vector<std::pair<double, double>>& tops, double length) {
    const auto a = space_.level(from), b = space_.level(to);
    if (!a || !b) return;
    const double slope = (tops.back().second - tops.front().second) / (tops.back().first - tops.front().first);
    double lift = -1e9;
    for (const auto& [s, z] : tops) lift = std::max(lift, z - slope * s);
    for (double share = 0; share <= 1; share += 0.05)
      if (const auto here = space_.level(from + share * (to - from)))
        lift = std::max(lift, here->floor_z - slope * share * length);
    for (double more : {0.004, 0.012, 0.03})
      if (put(Label::rail, rail(from, to, lift + more, lift + more + slope * length), yaw_of(to - from))) return;
  }

  void add_belt(const Way& way) {
    constexpr double length = 3;
    const double sign = lot(belts, 1) < 0.5 ? -1 : 1;
    for (double s = way.from_m + 0.5 * length; s + 0.5 * length < way.to_m; s += length) {
      Spot spot = way.at(s);
      double off = 1e9;
      for (double ds : {-1.4, -0.7, 0.0, 0.7, 1.4})
        off = std::min(off, free_m(space_, way.at(s + ds), sign, {0.35, 0.45}) - 0.72);
      if (off - 0.66 < lane() || !std::isfinite(off)) continue;
      spot.p = spot.beside(sign * std::min(off, lane() + 0.75));
      put(Label::belt, belt(space_, spot, length), yaw_of(spot.along));
    }
  }

  // Along a rib, hung from it: as near to it as its humps let it.
  void add_line(const Way& way, What what) {
    const bool pipe = what == pipes;
    const double sign = lot(what, 1) < 0.5 ? -1 : 1,
                 radius = pipe ? lot(what, 2, 0.04, 0.12) : lot(what, 2, 0.02, 0.035);
    const double share = pipe ? lot(what, 3, 0.55, 0.75) : 0.88;
    constexpr double step = 0.5;
    const auto n = static_cast<int>((way.to_m - way.from_m) / step);
    std::vector<double> room(static_cast<size_t>(std::max(0, n)) + 1);
    for (int i = 0; i <= n; ++i)
      room[i] = free_m(space_, way.at(way.from_m + i * step), sign, {share - 0.06, share, share + 0.05});
    const auto least = [&](int i) {
      double r = 1e9;
      for (int j = std::max(0, i - 2); j <= std::min(n, i + 2); ++j) r = std::min(r, room[j]);
      return r;
    };
    const auto point = [&](int i) -> std::optional<Vec3> {
      double off = 0;
      for (int j = i - 1; j <= i + 1; ++j) off += least(std::clamp(j, 0, n)) / 3;
      off -= radius + 0.05;
      const Spot spot = way.at(way.from_m + i * step);
      const Vec2 p = spot.beside(sign * off);
      const auto here = space_.level(spot.p);
      if (!here || off < lane() || off > 6) return std::nullopt;
      double z = here->floor_z + share * (here->roof_z - here->floor_z);
      if (!pipe) z -= 0.12 * std::sin(pi * std::fmod(i * step, 3.0) / 3.0);
      return Vec3(p.x(), p.y(), z);
    };
    constexpr int pieces = 6;  // of a length
    for (int i = 0; i + pieces <= n; i += pieces) {
      std::vector<Vec3> line;
      for (int j = i; j <= i + pieces; ++j)
        if (const auto p = point(j)) line.push_back(*p);
      if (line.size() != pieces + 1) continue;
      line.front() += 0.004 * (line[1] - line[0]).normalized();
      line.back() -= 0.004 * (line[pieces] - line[pieces - 1]).normalized();
      Bodies bodies{tube_along(line, radius, pipe ? 10 : 6)};
      bodies[0].material = pipe ? Material::steel : Material::none;
      put(pipe ? Label::pipe : Label::cable, std::move(bodies), yaw_of((line.back() - line.front()).head<2>()));
    }
  }

  Loop block_outline(const Vec2& p, double radius, What what, std::uint64_t k) const {
    const int sides = 5 + static_cast<int>(lot(what, k) * 3);
    Loop loop;
    const double turn = 2 * pi * lot(what, k + 1), stretch = lot(what, k + 2, 0.6, 1.0);
    for (int i = 0; i < sides; ++i) {  // on an ellipse: convex
      const double a = 2 * pi * (i + 0.6 * lot(what, k + 3 + static_cast<std::uint64_t>(i))) / sides;
      loop.push_back(p + Eigen::Rotation2Dd(turn) * Vec2(radius * std::cos(a), stretch * radius * std::sin(a)));
    }
    return loop;
  }

  bool put_block(const Vec2& p, double size, What what, std::uint64_t k) {
    const Loop outline = block_outline(p, 0.5 * size, what, k);
    const double high = size * lot(what, k + 12, 0.25, 0.6);
    const Vec2 lean(lot(what, k + 13, -0.3, 0.3), lot(what, k + 14, -0.3, 0.3));
    return put(Label::block, loose_block(space_, outline, high + 0.25 * size, lean), 0);
  }

  double block_size(What what, std::uint64_t k) const {
    const double z = std::sqrt(-2 * std::log(1 - lot(what, k))) * std::cos(2 * pi * lot(what, k + 1));
    return std::min(1.5, 0.25 * std::exp(0.6 * z));
  }

  void add_blocks(const Way& way) {
    const int n = count(blocks, s_.blocks_per_100m, way);
    for (int i = 0; i < n; ++i) {
      const std::uint64_t k = 1 + 32 * static_cast<std::uint64_t>(i);
      const Spot spot = way.at(lot(blocks, k, way.from_m, way.to_m));
      const double sign = lot(blocks, k + 1) < 0.5 ? -1 : 1, size = block_size(blocks, k + 2);
      const double room = free_m(space_, spot, sign, {0.05, 0.2}) - 0.5 * size - 0.05, least = lane() + 0.5 * size;
      if (!(room > least) || room > 10) continue;
      put_block(spot.beside(sign * (least + lot(blocks, k + 4) * (room - least))), size, blocks, k + 6);
    }
  }

  // On the heaps of falls, and what slabs broke into: under them, but not in the lane of a passage that is open.
  void add_stones() {
    for (size_t f = 0; f < plan_.decay.falls.size(); ++f) {
      const Fall& fall = plan_.decay.falls[f];
      passage_ = static_cast<size_t>(fall.passage);
      const bool heap = fall.heap_m > 0;
      const int n = heap ? 25 : fall.skin ? 6 : 4;
      for (int i = 0; i < n; ++i) {
        const std::uint64_t k = (static_cast<std::uint64_t>(f) + 1) << 16 | static_cast<std::uint64_t>(32 * i);
        const double size = block_size(stones, k), u = lot(stones, k + 2, -1, 1), v = lot(stones, k + 3, -1, 1);
        const Vec2 across(-fall.along.y(), fall.along.x());
        const double wide = heap ? 1.6 * fall.half_across_m : fall.half_across_m + 0.5;
        const Vec2 p = fall.middle + u * fall.half_along_m * fall.along + v * wide * across;
        if (heap || to_lane(p) > lane() + 0.5 * size) put_block(p, size, stones, k + 6);
      }
    }
  }

  // Distance from the nearest centre line that is not blocked.
  double to_lane(const Vec2& p) const {
    double least = 1e9;
    for (size_t i = 0; i < plan_.drifts.size(); ++i) {
      if (plan_.decay.blocked[i]) continue;
      const auto& line = plan_.drifts[i].line;
      for (const Vec2& q : line) least = std::min(least, (q - p).norm() - 0.25);
    }
    return least;
  }

  void add_blocker(const Blocker& b, const Way& way) {
    const double s = b.share * way.length_m();
    const Spot spot = way.at(s);
    if (b.label == Label::stopping) add_stopping(spot);
    if (b.label == Label::car) add_car(way, s);
    if (b.label == Label::beam) add_beam(spot);
  }

  void add_stopping(const Spot& spot) {
    const double door = lot(stones, 1, -0.5, 0.5);
    for (double rib_gap : {0.006, 0.02, 0.05, 0.1}) {
      StoppingBodies bodies = stopping(space_, spot, door, rib_gap);
      if (bodies.wall.empty()) continue;
      if (!put(Label::stopping, std::move(bodies.wall), yaw_of(spot.left()), true)) continue;
      put(Label::door, std::move(bodies.door), yaw_of(spot.left()));
      return;
    }
  }

  void add_car(const Way& way, double s) {
    const Spot spot = way.at(s);
    double high = -1e9;
    for (double x : {-0.55, 0.0, 0.55})
      for (double y : {-0.535, 0.535})
        if (const auto here = space_.level(spot.beside(y) + x * spot.along)) high = std::max(high, here->floor_z);
    const auto back = space_.level(spot.p - spot.along), front = space_.level(spot.p + spot.along);
    if (!back || !front) return;
    const double pitch = std::atan2(front->floor_z - back->floor_z, 2);
    for (double lift : {0.01, 0.03, 0.06, 0.1})
      if (put(Label::car, car(spot, high + lift, pitch), yaw_of(spot.along), true)) return;
  }

  // From the floor at one rib across to where it rests against the other.
  void add_beam(const Spot& spot) {
    const double sign = lot(stones, 2) < 0.5 ? -1 : 1, skew = lot(stones, 3, -1.5, 1.5), up = lot(stones, 4, 0.3, 0.9);
    const double one = free_m(space_, spot, sign, {0.1, 0.3}) - 0.35,
                 other = free_m(space_, spot, -sign, {0.3, 0.5}) - 0.35;
    if (!(one > 0.5) || !(other > 0.5) || one + other > 20) return;
    const Vec2 foot = spot.beside(sign * one) - skew * spot.along,
               head = spot.beside(-sign * other) + skew * spot.along;
    const auto low = space_.level(foot), high = space_.level(head);
    if (!low || !high) return;
    for (double lift : {0.14, 0.2, 0.28, 0.38})
      if (put(Label::beam,
              fallen_beam({foot.x(), foot.y(), low->floor_z + lift}, {head.x(), head.y(), high->floor_z + lift + up}),
              yaw_of(head - foot), true))
        return;
  }

  void add_pools(const Way& way) {
    const int n = count(pools, s_.pools_per_100m, way);
    for (int i = 0; i < n; ++i) {
      const std::uint64_t k = 1 + 4 * static_cast<std::uint64_t>(i);
      // The lowest of some places: water stands in swags.
      Vec2 lowest = Vec2::Zero();
      double z = 1e300;
      for (int j = 0; j < 4; ++j) {
        const double s = way.length_m() * (j + lot(pools, k)) / 4;
        const auto here = space_.level(way.at(s).p);
        if (here && here->floor_z < z) z = here->floor_z, lowest = here->p;
      }
      if (z < 1e300) add_pool(lowest, s_.pool_depth_m * lot(pools, k + 1, 0.4, 1.0));
    }
  }

  // The highest level at which the water about a place stays within reach of it.
  void add_pool(const Vec2& lowest, double depth) {
    for (int halved = 0; halved < 6; ++halved, depth *= 0.7) {
      const auto patch = space_.basin(lowest, depth, s_.pool_reach_m);
      if (!patch) continue;
      const double z = patch->level_z;
      auto body = column(
          patch->patch, [](const LevelPoint& v) { return v.floor_z + Space::gap_m; },
          [z](const LevelPoint&) { return z; });
      if (!body) continue;
      body->material = Material::water;
      Bodies bodies{std::move(*body)};
      if (put(Label::water, std::move(bodies), 0)) return;
    }
  }

  const FurniturePlan& plan_;
  const FurnitureSettings& s_;
  Space& space_;
  std::vector<int> degree_;
  std::vector<double> widest_;
  size_t passage_ = 0;
};

}  // namespace

void furnish(const FurniturePlan& plan, const std::vector<size_t>& passages, Space& space) {
  Furnisher(plan, space).furnish(passages);
}

}  // namespace adit
