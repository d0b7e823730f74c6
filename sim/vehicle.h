// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/hull.h"

#include <string>
#include <vector>

namespace adit {

/// A wheel with a tyre that gives way under its load.
struct Wheel {
  enum Kind { fixed, castor };  // rolls along B's x only; rolls in any direction
  std::string name;
  Kind kind = fixed;
  Vec2 position_B = Vec2::Zero();  // of its middle, seen from above
  double radius_m = 0;
  double mass_kg = 0;
  double stiffness_N_m = 0, damping_N_s_m = 0;  // of the tyre
  double friction = 0;                          // against rock
  double bearing_Nm = 0;                        // moment that resists rolling
};

/// A vehicle as its TOML states it.
struct Vehicle {
  std::string name;
  double mass_kg = 0;                         // without wheels
  Vec3 centre_of_mass_B = Vec3::Zero();       // without wheels
  Vec3 inertia_kg_m2 = Vec3::Zero();          // about it, along B's axes
  Vec3 handle_B = Vec3::Zero();               // where it is pushed
  double force_max_N = 0, moment_max_Nm = 0;  // what the pusher can do
  std::vector<Wheel> wheels;
  Hull solid;  // what collides with rock beside the wheels
  Hull hull;   // all that stands in the rays, the pusher included

  double total_mass_kg() const;
  /// Middle of the fixed wheels along x: the point that does not slip sideways.
  double axle_x_m() const;
  /// Extent of the vehicle along y, without the pusher.
  double width_m() const;
};

/// A bundled vehicle by name, or one from a TOML file. Errors name file, line and key: a size or mass that is not
/// positive, a box inside out, fewer than three wheels, none of them fixed, a centre of mass outside of the wheels.
Vehicle load_vehicle(const std::string& name_or_file);

}  // namespace adit
