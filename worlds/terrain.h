// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/waves.h"
#include "worlds/worlds.h"

#include <cstdint>
#include <vector>

namespace adit {

/// Floor and roof of a mine over its plan, and what the rock is like. Smooth parts: the seam's plane with rolls, the
/// mined height. Rough parts: self-affine.
class Terrain {
 public:
  Terrain(const WorldSettings& settings, const Vec2& middle, std::uint64_t seed);

  double floor_z(const Vec2& p) const;  // with roughness
  double roof_z(const Vec2& p) const;
  double seam_z(const Vec2& p) const;    // the floor without roughness
  double height_m(const Vec2& p) const;  // without roughness
  /// How far a rib's rock stands back, > 0 into the rock.
  double rib_offset_m(const Vec3& p) const { return rib_(p); }
  float reflectivity(const Vec3& p) const;

 private:
  struct Roll {
    Vec2 k;
    double phase;
  };
  double mean_height_, roll_amplitude_, mean_reflectivity_;
  Vec2 middle_, grade_;
  std::vector<Roll> rolls_;
  Waves height_, floor_, roof_, rib_, patches_;
};

}  // namespace adit
