// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"
#include "sim/vehicle.h"

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

namespace adit {

/// The floor of a mine as a height over the plan: its faces by the squares of a grid.
class Floor {
 public:
  /// @param mesh  faces labelled floor count, all of them where there are no labels; kept by reference
  explicit Floor(const Mesh& mesh);
  /// The highest floor at a point in plan; none where there is no floor.
  std::optional<double> height_m(const Vec2& p_W) const;

 private:
  const Mesh& mesh_;
  Vec2 low_ = Vec2::Zero();
  double cell_m_ = 1;
  long nx_ = 0, ny_ = 0;
  std::vector<std::uint32_t> begin_, face_;  // faces of square i: face_[begin_[i]] to face_[begin_[i + 1] - 1]
};

/// Height of the ground that a wheel of some radius stands on, at a point in plan; none where there is no floor.
using GroundHeight = std::function<std::optional<double>(const Vec2& p_W, double radius_m)>;
GroundHeight height_of(const Floor& floor);

/// Where a vehicle's wheels stand on the ground, B's origin at p_W: pitch and roll by the heights under the wheels.
/// @throws Error where there is no floor under a wheel or a corner of the solid hull: the place is rock or outside
Pose stand_on(const GroundHeight& ground, const Vehicle& vehicle, const Vec2& p_W, double yaw_rad);

}  // namespace adit
