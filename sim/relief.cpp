// SPDX-License-Identifier: BSD-3-Clause
#include "sim/relief.h"

#include "base/error.h"
#include "base/rng.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace adit {
namespace {

// Old haulage track, half buried: gauge 42 in.
constexpr double tie_gap_m = 0.6, tie_half_width_m = 0.04, tie_half_length_m = 0.85, tie_m = 0.04, flank_m = 0.17;
constexpr double tie_tilt = 1.6;                            // spread between a sleeper's ends, of its height
constexpr double settled_m = 1.5, cross_level_max = 0.105;  // over which the bed settled; slope across
constexpr double gauge_m = 1.067, rail_half_width_m = 0.03, rail_m = 0.03, rail_flank_m = 0.08;
constexpr double planked_m = 2.5, ramp_m = 1.5;  // from a junction, and then up to the full height
constexpr double blend_m = 0.6;                  // towards a passage that has something else
constexpr double half_width_m = 6;               // beyond that from its centre line nothing of a passage lies
// Broken rock: heaps and hollows, and stones on them.
constexpr double heap_m = 0.75, heap_height_m = 0.058;  // size of the grid, spread of the heights
constexpr double stone_gap_m = 0.35, stone_m = 0.035,
                 stone_share = 0.6;  // grid, greatest height, share of squares with one

constexpr double tile_m = 1, step_m = 0.025;
constexpr long steps = 40;  // of a tile
constexpr size_t slots = 256;

// 1 within the half width, 0 beyond the flank, smooth between.
double plateau(double offset, double half_width, double flank) {
  const double s = std::clamp((std::abs(offset) - half_width) / flank, 0.0, 1.0);
  return 0.5 + 0.5 * std::cos(std::numbers::pi * s);
}

double drawn(std::uint64_t seed, std::uint64_t what, std::int64_t x, std::int64_t y) {
  const auto place = (static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(y) & 0xffffffffu);
  return uniform(seed, Draw::ground_relief, place, what);
}

// Smooth through independent values on a square grid: sd 1 or somewhat less.
double heaps(const Vec2& p, std::uint64_t seed) {
  const Vec2 at = p / heap_m;
  const double x0 = std::floor(at.x()), y0 = std::floor(at.y());
  double sum = 0;
  for (int j = -1; j <= 2; ++j)
    for (int i = -1; i <= 2; ++i) {
      const double dx = at.x() - x0 - i, dy = at.y() - y0 - j, r = std::sqrt(dx * dx + dy * dy) / 1.6;
      if (r >= 1) continue;
      const double u = drawn(seed, 0, static_cast<std::int64_t>(x0) + i, static_cast<std::int64_t>(y0) + j);
      sum += std::sqrt(12.0) * (u - 0.5) * (1 - r * r) * (1 - r * r);
    }
  return sum;
}

double stones(const Vec2& p, std::uint64_t seed) {
  const double x0 = std::floor(p.x() / stone_gap_m), y0 = std::floor(p.y() / stone_gap_m);
  double highest = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) {
      const auto x = static_cast<std::int64_t>(x0) + i, y = static_cast<std::int64_t>(y0) + j;
      if (drawn(seed, 1, x, y) > stone_share) continue;
      const double u = drawn(seed, 2, x, y);
      const double height = stone_m * (0.2 + 0.8 * u * u), radius = 0.09 + 2 * height;
      const Vec2 middle((static_cast<double>(x) + drawn(seed, 3, x, y)) * stone_gap_m,
                        (static_cast<double>(y) + drawn(seed, 4, x, y)) * stone_gap_m);
      const double r = (p - middle).norm() / radius;
      if (r < 1) highest = std::max(highest, height * (1 - r * r));
    }
  return highest;
}

// A piece of a passage's centre line and how far it lies from the passage's ends.
struct Piece {
  Vec2 a, b;
  double at_m, length_m;  // of a along the passage; of the whole passage
  size_t passage;
};

std::vector<Piece> pieces_near(const World& world, const Vec2& middle, double reach_m) {
  std::vector<Piece> near;
  for (size_t i = 0; i < world.passages.size(); ++i) {
    const Passage& passage = world.passages[i];
    double at = 0;
    for (size_t k = 1; k < passage.centre_line.size(); ++k) {
      const Vec2 a = passage.centre_line[k - 1].head<2>(), b = passage.centre_line[k].head<2>();
      const double length = (b - a).norm();
      if ((0.5 * (a + b) - middle).norm() < reach_m + 0.5 * length) near.push_back({a, b, at, passage.length_m, i});
      at += length;
    }
  }
  return near;
}

// 0 near the passage's ends, where it is planked or cleared, 1 away from them.
double share_at(const Piece& s, double along_m) {
  return std::clamp((std::min(along_m, s.length_m - along_m) - planked_m) / ramp_m, 0.0, 1.0);
}

double track_on(const std::vector<Piece>& near, const Vec2& p, std::uint64_t seed) {
  double highest = 0;
  for (size_t k = 0; k < near.size();) {
    // By the nearest of a passage's pieces: on the outer side of a bend a point lies beside none of them.
    const size_t passage = near[k].passage;
    double least = half_width_m, share = 0, along = 0, left = 0;
    for (; k < near.size() && near[k].passage == passage; ++k) {
      const Piece& s = near[k];
      const Vec2 d = s.b - s.a, from_a = p - s.a;
      const double length = d.norm();
      if (length == 0) continue;
      const double t = std::clamp(d.dot(from_a) / length, 0.0, length);
      const double side = (d.x() * from_a.y() - d.y() * from_a.x()) / length;
      const bool beside = t > 0 && t < length;
      const double distance = beside ? std::abs(side) : (from_a - t / length * d).norm();
      if (distance >= least) continue;
      least = distance;
      along = s.at_m + t;
      left = std::copysign(distance, side);
      share = share_at(s, along);
    }
    if (share > 0) highest = std::max(highest, share * track_height_m(along, left, seed, passage));
  }
  return highest;
}

struct Nearest {
  double distance_m = std::numeric_limits<double>::infinity();
  const Piece* piece = nullptr;
  double along_m = 0;
};

// What lies where passages differ.
double mixed_on(const std::vector<Piece>& near, const std::vector<FloorKind>& kinds, const Vec2& p,
                std::uint64_t seed) {
  Nearest nearest[3];  // of each kind
  for (const Piece& s : near) {
    const Vec2 d = s.b - s.a;
    const double length = d.norm();
    if (length == 0) continue;
    const double t = std::clamp(d.dot(p - s.a) / length, 0.0, length);
    const double distance = (p - s.a - t / length * d).norm();
    Nearest& best = nearest[static_cast<size_t>(kinds[s.passage])];
    if (distance < best.distance_m) best = {distance, &s, s.at_m + t};
  }
  const auto [smooth, track, rubble] = nearest;
  const auto against = [](const Nearest& a, const Nearest& b, const Nearest& c) {
    return std::clamp((std::min(b.distance_m, c.distance_m) - a.distance_m) / blend_m, 0.0, 1.0);
  };
  if (track.piece && track.distance_m < std::min(smooth.distance_m, rubble.distance_m)) {
    std::vector<Piece> own;
    for (const Piece& s : near)
      if (kinds[s.passage] == FloorKind::track) own.push_back(s);
    return against(track, smooth, rubble) * track_on(own, p, seed);
  }
  if (rubble.piece && rubble.distance_m < std::min(smooth.distance_m, track.distance_m))
    return against(rubble, smooth, track) * share_at(*rubble.piece, rubble.along_m) * rubble_height_m(p, seed);
  return 0;
}

// Slope across of a bed that has settled unevenly: even values at equal distances, smooth between.
double cross_level(double along_m, std::uint64_t seed, std::uint64_t track) {
  const double at = along_m / settled_m, from = std::floor(at);
  const double s = 0.5 - 0.5 * std::cos(std::numbers::pi * (at - from));
  const auto value = [&](double k) {
    return 2 * drawn(seed, 10, static_cast<std::int64_t>(k) + 1, static_cast<std::int64_t>(track)) - 1;
  };
  return cross_level_max * (value(from) * (1 - s) + value(from + 1) * s) / std::hypot(1 - s, s);
}

}  // namespace

double track_height_m(double along_m, double left_m, std::uint64_t seed, std::uint64_t track) {
  const double rail = rail_m * plateau(std::abs(left_m) - gauge_m / 2, rail_half_width_m, rail_flank_m);
  double tie = 0;
  const double nearest = std::round(along_m / tie_gap_m);
  for (const double k : {nearest - 1, nearest, nearest + 1}) {
    const auto id = static_cast<std::int64_t>(k) + 1;
    const auto u = [&](std::uint64_t what) { return drawn(seed, what, id, static_cast<std::int64_t>(track)); };
    // Each lies somewhat askew and sunk on one side.
    const double offset = along_m - k * tie_gap_m - 0.08 * (u(5) - 0.5) - 0.06 * (u(6) - 0.5) * left_m;
    const double height = tie_m * (0.65 + 0.5 * u(7) + tie_tilt * (u(8) - 0.5) * left_m / tie_half_length_m);
    tie = std::max(tie, std::max(0.0, height) * plateau(offset, tie_half_width_m, flank_m) *
                            plateau(left_m, tie_half_length_m, flank_m));
  }
  return std::max(tie, rail) + cross_level(along_m, seed, track) * left_m * plateau(left_m, tie_half_length_m, flank_m);
}

double rubble_height_m(const Vec2& p_W, std::uint64_t seed) {
  return std::max(0.0, heap_height_m * (1 + heaps(p_W, seed))) + stones(p_W, seed);
}

Relief::Relief(const World& world, const Floor& floor, FloorKind kind, std::uint64_t seed)
    : world_(world), floor_(floor), kind_(kind), seed_(seed), tiles_(slots) {}

Relief::Relief(const World& world, const Floor& floor, std::vector<FloorKind> kinds, std::uint64_t seed)
    : Relief(world, floor, FloorKind::smooth, seed) {
  kinds_ = std::move(kinds);
  ADIT_CHECK(kinds_.size() == world.passages.size());
}

std::vector<FloorKind> draw_floor_kinds(const World& world, double track_share, double rubble_share,
                                        std::uint64_t seed) {
  const size_t n = world.passages.size();
  std::vector<size_t> order(n);
  std::iota(order.begin(), order.end(), size_t{0});
  const auto lot = [&](size_t i) { return drawn(seed, 9, static_cast<std::int64_t>(i), 0); };
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return lot(a) < lot(b); });
  double all = 0, before = 0;
  for (const Passage& passage : world.passages) all += passage.length_m;
  std::vector<FloorKind> kinds(n, FloorKind::smooth);
  for (const size_t i : order) {  // by where its middle falls
    const double at = (before + 0.5 * world.passages[i].length_m) / all;
    before += world.passages[i].length_m;
    kinds[i] = at < track_share                  ? FloorKind::track
               : at < track_share + rubble_share ? FloorKind::rubble
                                                 : FloorKind::smooth;
  }
  return kinds;
}

void Relief::make(Tile& tile) const {
  const Vec2 low(static_cast<double>(tile.x) * tile_m, static_cast<double>(tile.y) * tile_m);
  std::vector<Piece> near;
  const Vec2 middle = low + Vec2::Constant(tile_m / 2);
  if (kind_ == FloorKind::track) near = pieces_near(world_, middle, tile_m + 1);
  if (!kinds_.empty()) near = pieces_near(world_, middle, tile_m + half_width_m);
  tile.height_m.assign((steps + 1) * (steps + 1), std::numeric_limits<float>::quiet_NaN());
  for (long j = 0; j <= steps; ++j)
    for (long i = 0; i <= steps; ++i) {
      const Vec2 p = low + step_m * Vec2(static_cast<double>(i), static_cast<double>(j));
      const std::optional<double> z = floor_.height_m(p);
      if (!z) continue;
      const double lies = !kinds_.empty()              ? mixed_on(near, kinds_, p, seed_)
                          : kind_ == FloorKind::track  ? track_on(near, p, seed_)
                          : kind_ == FloorKind::rubble ? rubble_height_m(p, seed_)
                                                       : 0;
      tile.height_m[static_cast<size_t>(j * (steps + 1) + i)] = static_cast<float>(*z + lies);
    }
  tile.made = true;
}

const Relief::Tile& Relief::tile(long x, long y) const {
  Tile& slot = tiles_[static_cast<size_t>((x & 15) | ((y & 15) << 4))];
  if (slot.made && slot.x == x && slot.y == y) return slot;
  slot.x = x;
  slot.y = y;
  make(slot);
  return slot;
}

// Bilinear; NaN where a corner has no floor.
float Relief::sample(const Vec2& p_W) const {
  const double x = std::floor(p_W.x() / tile_m), y = std::floor(p_W.y() / tile_m);
  const Tile& t = tile(static_cast<long>(x), static_cast<long>(y));
  const double u = (p_W.x() - x * tile_m) / step_m, v = (p_W.y() - y * tile_m) / step_m;
  const long i = std::clamp<long>(static_cast<long>(u), 0, steps - 1),
             j = std::clamp<long>(static_cast<long>(v), 0, steps - 1);
  const float s = static_cast<float>(u - static_cast<double>(i)), r = static_cast<float>(v - static_cast<double>(j));
  const float* h = t.height_m.data() + j * (steps + 1) + i;
  const float low = h[0] + s * (h[1] - h[0]), high = h[steps + 1] + s * (h[steps + 2] - h[steps + 1]);
  return low + r * (high - low);
}

std::optional<double> Relief::height_m(const Vec2& p_W) const {
  const float z = sample(p_W);
  return std::isnan(z) ? std::nullopt : std::optional<double>(z);
}

std::optional<double> Relief::rest_height_m(const Vec2& p_W, double radius_m) const {
  std::optional<double> rest = height_m(p_W);
  if (!rest) return rest;
  constexpr int rings = 6, spokes = 12;
  for (int ring = 1; ring <= rings; ++ring)
    for (int k = 0; k < spokes; ++k) {
      const double r = 0.95 * radius_m * ring / rings, a = 2 * std::numbers::pi * k / spokes;
      const float z = sample(p_W + r * Vec2(std::cos(a), std::sin(a)));
      if (!std::isnan(z)) rest = std::max(*rest, z + std::sqrt(radius_m * radius_m - r * r) - radius_m);
    }
  return rest;
}

std::vector<Touch> Relief::touches(const Vec3& middle_W, double radius_m, const Vec2& ahead, double margin_m) const {
  const Vec2 across(-ahead.y(), ahead.x());
  const auto on = [&](const Vec2& u) -> Vec3 {  // ahead and across
    const Vec2 p = middle_W.head<2>() + u.x() * ahead + u.y() * across;
    return {p.x(), p.y(), static_cast<double>(sample(p))};
  };
  const auto gap2 = [&](const Vec2& u) { return (on(u) - middle_W).squaredNorm(); };
  std::vector<Touch> found;
  for (const double side : {1.0, -1.0}) {
    Vec2 best(0, 0);
    double least = std::numeric_limits<double>::infinity();
    const auto look = [&](const Vec2& u) {
      if (side * u.x() < 0) return;
      const double d = gap2(u);
      if (d < least) least = d, best = u;  // never where there is no floor: d is NaN
    };
    for (const double y : {0.0, -0.3, 0.3})
      for (const double x : {0.0, 0.2, 0.4, 0.6, 0.8}) look(radius_m * Vec2(side * x, y));
    if (!std::isfinite(least)) continue;
    for (double h = 0.1 * radius_m; h > 0.004 * radius_m; h /= 2) {
      const Vec2 from = best;
      for (const Vec2& d : {Vec2(h, 0), Vec2(-h, 0), Vec2(0, h), Vec2(0, -h)}) look(from + d);
    }
    const Vec3 p = on(best), out = middle_W - p;
    const double distance = out.norm() - radius_m;
    if (distance > margin_m || distance < -radius_m) continue;
    found.push_back({p, out.normalized(), distance});
  }
  return found;
}

}  // namespace adit
