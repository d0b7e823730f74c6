// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/furnisher.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

Loop Furnisher::block_outline(const Vec2& p, double radius, What what, std::uint64_t k) const {
  const int sides = 5 + static_cast<int>(lot(what, k) * 3);
  Loop loop;
  const double turn = 2 * pi * lot(what, k + 1), stretch = lot(what, k + 2, 0.6, 1.0);
  for (int i = 0; i < sides; ++i) {  // on an ellipse: convex
    const double a = 2 * pi * (i + 0.6 * lot(what, k + 3 + static_cast<std::uint64_t>(i))) / sides;
    loop.push_back(p + Eigen::Rotation2Dd(turn) * Vec2(radius * std::cos(a), stretch * radius * std::sin(a)));
  }
  return loop;
}

bool Furnisher::put_block(const Vec2& p, double size, What what, std::uint64_t k) {
  const Loop outline = block_outline(p, 0.5 * size, what, k);
  const double high = size * lot(what, k + 12, 0.25, 0.6);
  const Vec2 lean(lot(what, k + 13, -0.3, 0.3), lot(what, k + 14, -0.3, 0.3));
  return put(Label::block, loose_block(space_, outline, high + 0.25 * size, lean), 0);
}

double Furnisher::block_size(What what, std::uint64_t k) const {
  const double z = std::sqrt(-2 * std::log(1 - lot(what, k))) * std::cos(2 * pi * lot(what, k + 1));
  return std::min(1.5, 0.25 * std::exp(0.6 * z));
}

void Furnisher::add_blocks(const Way& way) {
  const int n = count(blocks, s_.blocks_per_100m, way);
  ask(Label::block, n);
  for (int i = 0; i < n; ++i) {
    const std::uint64_t k = 1 + 32 * static_cast<std::uint64_t>(i);
    const double s = lot(blocks, k, way.from_m, way.to_m);
    const Spot spot = way.at(s);
    const double sign = lot(blocks, k + 1) < 0.5 ? -1 : 1, size = block_size(blocks, k + 2);
    const double room = free_m(space_, spot, sign, {0.05, 0.2}) - 0.5 * size - 0.05, least = lane(way, s) + 0.5 * size;
    if (!(room > least) || room > 10) continue;
    put_block(spot.beside(sign * (least + lot(blocks, k + 4) * (room - least))), size, blocks, k + 6);
  }
}

// On the heaps of falls, and what slabs broke into: under them, but not in the lane of a passage that is open.
void Furnisher::add_stones() {
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
      if (heap || off_lanes(p) > 0.5 * size) ask(Label::block), put_block(p, size, stones, k + 6);
    }
  }
}

// From the lanes of passages that are not blocked.
double Furnisher::off_lanes(const Vec2& p) const {
  double least = 1e9;
  for (size_t i = 0; i < plan_.drifts.size(); ++i) {
    if (plan_.decay.blocked[i]) continue;
    const Way way = way_of(i);
    const auto& line = plan_.drifts[i].line;
    double s = 0;
    for (size_t k = 0; k < line.size(); ++k) {
      if (k > 0) s += (line[k] - line[k - 1]).norm();
      least = std::min(least, (line[k] - p).norm() - 0.25 - lane(way, s));
    }
  }
  return least;
}

// From the floor at one rib across to where it rests against the other.
void Furnisher::add_beam(const Spot& spot) {
  ask(Label::beam);
  const double sign = lot(stones, 2) < 0.5 ? -1 : 1, skew = lot(stones, 3, -1.5, 1.5), up = lot(stones, 4, 0.3, 0.9);
  const double one = free_m(space_, spot, sign, {0.1, 0.3}) - 0.35,
               other = free_m(space_, spot, -sign, {0.3, 0.5}) - 0.35;
  if (!(one > 0.5) || !(other > 0.5) || one + other > 20) return;
  const Vec2 foot = spot.beside(sign * one) - skew * spot.along, head = spot.beside(-sign * other) + skew * spot.along;
  const auto low = space_.level(foot), high = space_.level(head);
  if (!low || !high) return;
  for (double lift : {0.14, 0.2, 0.28, 0.38})
    if (put(Label::beam,
            fallen_beam({foot.x(), foot.y(), low->floor_z + lift}, {head.x(), head.y(), high->floor_z + lift + up}),
            yaw_of(head - foot), true))
      return;
}

void Furnisher::add_pools(const Way& way) {
  const int n = count(pools, s_.pools_per_100m, way);
  ask(Label::water, n);
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
void Furnisher::add_pool(const Vec2& lowest, double depth) {
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

}  // namespace adit
