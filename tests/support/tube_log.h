// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "base/recording.h"
#include "base/rig.h"

#include <cstdint>

namespace adit {

/// How a mesh is bent: rolls of metres over tens of metres and a roughness of centimetres over decimetres. Smooth
/// fields of sines, so that a mesh stays closed and a path can follow the rolls.
struct Ground {
  double roll_m = 0;   // amplitude of each of three long waves, 20 to 45 m, in z alone
  double rough_m = 0;  // sd of the roughness, in x, y and z alike; waves of 0.5 to 2 m
  std::uint64_t seed = 1;

  double height_m(const Vec2& p) const;  // of the rolls
  Vec3 moved(const Vec3& p) const;
};

/// The mesh with every vertex moved by the ground; needs edges well below the roughness' waves.
Mesh bent(Mesh mesh, const Ground& ground);

/// How the cart moves along a line.
struct Ride {
  double speed_mps = 0.7;
  double pitch_deg = 0, roll_deg = 0, heave_m = 0;  // sd of the shaking, about 1.2, 0.9 and 1 Hz
  double stop_s = 0;                                // stands this long in the middle
};

/// A straight line along x.
std::vector<Vec2> straight_line(double from_x, double to_x);
/// The centre line of ring_world(outer, width): `rounds` times counter-clockwise from the middle of the lower side,
/// corners rounded with radius_m.
std::vector<Vec2> ring_line(double outer_m, double width_m, double radius_m, double rounds);

/// X_WB at 100 Hz on the line, heading along it, at the height of the rolls and pitched and rolled as they are, plus
/// shaking.
Trajectory ride_along(const std::vector<Vec2>& line, const Ground& ground, const Ride& ride);

/// What the rig records on that path: exact ranges by casting rays, plus normal noise; scans of the lasers not in step.
Log tube_log(const Mesh& mesh, const Rig& rig, const Trajectory& X_WB, double noise_m, std::uint64_t seed);

}  // namespace adit
