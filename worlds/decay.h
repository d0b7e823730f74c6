// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/outline.h"
#include "worlds/plan.h"

#include <cstdint>
#include <vector>

namespace adit {

/// A place where the roof came down.
struct Fall {
  Vec2 middle = Vec2::Zero(), along = Vec2::UnitX();
  double half_along_m, half_across_m;  // of the ellipse (of a skin fall: the rectangle) within which rock is gone
  double height_m;                     // of the cavity
  double wall;                         // tangent of its sides' slope
  double bed_m;                        // height of its steps; 0: a dome
  bool skin;                           // a slab, no cavity
  double heap_m;                       // height of the rubble at its ridge, were there no roof; 0: cleared away
  double repose;                       // tangent of the rubble's slope
  int passage;                         // in which, or one of those at the junction

  double cavity_m(const Vec2& p, double depth_m) const;
  double rubble_m(const Vec2& p) const;  // without its stones
  double reach_m() const;                // from the middle
  /// Whether what stood or hung there came down with the roof, or lies under rubble that was not loaded out.
  bool buried(const Vec2& p) const;
  Label hollow() const { return skin ? Label::scar : Label::cavity; }
};

/// A fall with the numbers, among the mine's objects, of its rubble (-1: loaded out, none) and of what it left of the roof.
struct NumberedFall {
  Fall fall;
  int rubble, hollow;
};

/// Something across a passage that no vehicle gets past.
struct Blocker {
  Label label;  // stopping, car, beam
  size_t passage;
  double share;  // of the passage's length, where it stands
};

struct Decay {
  std::vector<Fall> falls;
  std::vector<Blocker> blockers;
  std::vector<char> blocked;  // (passages) by rubble
};

/// The settings with everything that they leave to world.condition filled in.
WorldSettings in_condition(const WorldSettings& settings);

/// What has come down and what stands across. Unless world.decay.may_cut, nothing blocks a passage whose loss would leave
/// a mine without a loop.
Decay draw_decay(const WorldSettings& settings, const MinePlan& plan, const Workings& workings, std::uint64_t seed);

/// Height of the stones on a heap: steps between blocks of some decimetres.
double stones_m(const Vec2& p, std::uint64_t seed);

}  // namespace adit
