// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "worlds/decay.h"
#include "worlds/lattice.h"
#include "worlds/waves.h"
#include "worlds/worlds.h"

#include <cstdint>
#include <vector>

namespace adit {

/// What a place of the rock's surface is.
struct Rock {
  Material material;
  float reflectivity, wetness;
};

/// Floor and roof of a mine over its plan, and what the rock is like. Smooth parts: the seam's plane with rolls, the
/// mined height. Rough parts: self-affine.
class Terrain {
 public:
  /// @param depth  signed distance from the ribs in plan, negative in the void; must outlive the terrain
  /// @param falls  those that may reach into what the terrain is asked for
  Terrain(const WorldSettings& settings, const Vec2& middle, const Lattice& depth, std::uint64_t seed,
          std::vector<NumberedFall> falls = {});

  double floor_z(const Vec2& p) const;  // with roughness
  double roof_z(const Vec2& p) const;
  double seam_z(const Vec2& p) const;    // the floor without roughness
  double height_m(const Vec2& p) const;  // without roughness
  /// What lies on the floor there: floor, rubble, talus or sludge; of rubble its number, else -1.
  std::pair<Label, int> ground(const Vec2& p) const;
  /// What is overhead there: roof, a cavity or a scar; of these their number, else -1.
  std::pair<Label, int> ceiling(const Vec2& p) const;
  /// How high the rubble of a fall lies there; its number.
  double rubble_m(const Vec2& p, int* number = nullptr) const;
  /// How far the roof has come down there; the number of what is left of it, and its label.
  double hollow_m(const Vec2& p, int* number = nullptr, Label* label = nullptr) const;
  /// How far a rib's rock stands back, > 0 into the rock.
  /// @param normal  in plan, unit, into the rock
  double rib_offset_m(const Vec3& p, const Vec2& normal) const;
  /// How far the rib has spalled at mid height beyond that, >= 0.
  double slough_m(const Vec2& p) const;
  Rock rock(const Vec3& p, Label label) const;

 private:
  struct Roll {
    Vec2 k;
    double phase;
  };
  double across(const Vec2& p) const;  // 0 at the ribs, 1 in the middle of a passage
  double cleat_offset_m(const Vec2& p, const Vec2& normal) const;
  double talus_m(const Vec2& p) const;

  double mean_height_, roll_amplitude_, mean_reflectivity_;
  WearSettings wear_;
  RockSettings rock_settings_;
  double slough_below_, dust_below_;  // the field's value below which a place is spalled, dusted
  std::array<double, 3> wet_below_;   // floor, ribs, roof
  const Lattice& depth_;
  Vec2 middle_, grade_;
  std::vector<Roll> rolls_;
  Waves height_, floor_, roof_, rib_, patches_, slough_, sag_, bedding_, dust_, water_, cleat_, sludge_;
  double talus_most_m_, sludge_share_, sludge_below_;
  std::vector<NumberedFall> falls_;
  std::uint64_t seed_;
};

}  // namespace adit
