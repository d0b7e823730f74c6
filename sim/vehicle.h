// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/hull.h"

#include <string>
#include <vector>

namespace adit {

/// A wheel with a tyre that gives way under its load.
struct Wheel {
  enum Kind { fixed, castor, driven };  // rolls along B's x only; in any direction; along x, by a motor of its own
  std::string name;
  Kind kind = fixed;
  Vec2 position_B = Vec2::Zero();  // of its middle, seen from above
  double radius_m = 0;
  double mass_kg = 0;
  double stiffness_N_m = 0, damping_N_s_m = 0;  // of the tyre
  double friction = 0;                          // against rock
  double bearing_Nm = 0;                        // moment that resists rolling
  double brake_Nm = 80;                         // moment that holds it when the vehicle stands; castors have no brake
};

/// What moves a vehicle: a person at its handle, or motors that turn the wheels of each side at a speed of their own.
enum class Drivetrain { pushed, skid_steer };

/// The motors of a skid-steer.
struct Motors {
  double torque_max_Nm = 0;      // of each wheel
  double speed_max_mps = 0;      // of a wheel's tread
  double acceleration_mps2 = 0;  // of the speed wanted
  double turn_max_rad_s = 0;     // turn rate that is asked of it at most
  double turn_gain = 1;          // difference of the sides' speeds for a turn, against wheels that do not slip
};

/// A vehicle as its TOML states it.
struct Vehicle {
  std::string name;
  Drivetrain drivetrain = Drivetrain::pushed;
  double mass_kg = 0;                         // without wheels
  Vec3 centre_of_mass_B = Vec3::Zero();       // without wheels
  Vec3 inertia_kg_m2 = Vec3::Zero();          // about it, along B's axes
  Vec3 handle_B = Vec3::Zero();               // where it is pushed
  double force_max_N = 0, moment_max_Nm = 0;  // what the pusher can do
  Motors motors;                              // of a skid-steer
  std::vector<Wheel> wheels;
  Hull solid;  // what collides with rock beside the wheels
  Hull hull;   // all that stands in the rays, the pusher included

  double total_mass_kg() const;
  /// Middle of the wheels that are no castors, along x: the point that does not slip sideways.
  double axle_x_m() const;
  /// Between the driven wheels of both sides.
  double track_m() const;
  /// Extent of the vehicle along y, without the pusher.
  double width_m() const;
};

/// A bundled vehicle by name, or one from a TOML file (docs/sim.md). Errors name file, line and key: a size or mass that
/// is not positive, a box inside out, fewer than three wheels, all of them castors, a centre of mass outside of the
/// wheels, wheels or tables that do not go with the kind of drive.
Vehicle load_vehicle(const std::string& name_or_file);

}  // namespace adit
