// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/world.h"
#include "sim/ground.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// What lies on a mine's floor, finer than its mesh: the wheels meet it, the lasers do not see it.
enum class FloorKind { smooth, track, rubble };  // as Drive::ground numbers them

/// Where a ball is nearest to the ground.
struct Touch {
  Vec3 p_W, normal_W;  // on the ground; out of it
  double distance_m;   // between the ball and the ground, < 0 where they overlap
};

/// The ground under the wheels: the mesh's floor with what lies on it, as heights on a grid of 2.5 cm. Only the grid
/// about the places asked for last is kept, 1.7 MB at most, whatever the size of the mine.
///   track    sleepers and rails along the passages' centre lines, half buried; none at junctions, which are planked
///   rubble   heaps of broken rock and stones everywhere
/// Where passages differ, each point has what the nearest passage has, which thins out towards junctions and towards
/// passages that have something else.
/// It is a function of world, kinds and seed alone.
class Relief {
 public:
  /// @param world  and floor are kept by reference
  Relief(const World& world, const Floor& floor, FloorKind kind, std::uint64_t seed);
  /// @param kinds  (passages)
  Relief(const World& world, const Floor& floor, std::vector<FloorKind> kinds, std::uint64_t seed);

  /// Height of the ground at a point in plan; none where there is no floor.
  std::optional<double> height_m(const Vec2& p_W) const;
  /// Height of the lowest point of a ball that rests on the ground with its middle above a point in plan.
  std::optional<double> rest_height_m(const Vec2& p_W, double radius_m) const;
  /// Where a ball is nearest to the ground before and behind its middle, nearer than margin_m; at most two places.
  /// @param ahead  unit vector in plan
  std::vector<Touch> touches(const Vec3& middle_W, double radius_m, const Vec2& ahead, double margin_m) const;

 private:
  struct Tile {
    bool made = false;
    long x = 0, y = 0;
    std::vector<float> height_m;  // NaN: no floor
  };
  const Tile& tile(long x, long y) const;
  void make(Tile& tile) const;
  float sample(const Vec2& p_W) const;

  const World& world_;
  const Floor& floor_;
  FloorKind kind_;
  std::vector<FloorKind> kinds_;  // (passages) where they differ; else empty
  std::uint64_t seed_;
  mutable std::vector<Tile> tiles_;  // of the places asked for last
};

/// Passages drawn to have track or rubble, up to those shares of the passages' length; the others are smooth. (passages)
std::vector<FloorKind> draw_floor_kinds(const World& world, double track_share, double rubble_share,
                                        std::uint64_t seed);

/// How high sleepers and rails of a straight track stand above its bed.
/// @param along_m  from the track's begin; @param left_m of its middle; @param track  number of the track
double track_height_m(double along_m, double left_m, std::uint64_t seed, std::uint64_t track);
/// How high rubble lies at a point in plan.
double rubble_height_m(const Vec2& p_W, std::uint64_t seed);

}  // namespace adit
