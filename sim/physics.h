// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"
#include "sim/relief.h"
#include "sim/vehicle.h"

#include <memory>
#include <optional>
#include <vector>

namespace adit {

/// What hands or motors do to a vehicle during one step.
struct Effort {
  double force_N = 0;                  // along B's x, at the handle
  double moment_Nm = 0;                // about B's z
  double left_mps = 0, right_mps = 0;  // speeds of the driven wheels' treads that their motors strive for
  bool brake = false;                  // all wheels but castors are held
};

/// A block that nothing holds: it lies in the mine, and a vehicle may push it.
struct Loose {
  Vec3 size_m;
  double mass_kg = 0;
  Pose X_WL = Pose::Identity();  // of its middle
  double friction = 0.6;
};

/// Where a vehicle is and how it moves.
struct Motion {
  Pose X_WB = Pose::Identity();
  Vec3 v_W = Vec3::Zero();  // of B's origin
  Vec3 omega_W = Vec3::Zero();
};

/// A vehicle on its wheels in a mine: rigid frame, sprung tyres, friction, gravity 9.81 m/s2 along -z. The sole owner
/// of Bullet.
///
/// A wheel is a ball on a hinge (fixed, driven) or in a socket (castor). Only those contacts of a ball count that the surface
/// itself has, not those that Bullet finds with the edges between faces of one plane: rolling is smooth on a fine mesh.
/// Every contact is found anew in each step, so the future depends on the bodies' states alone.
class Physics {
 public:
  /// @param rock    the mine in W; kept by reference, must outlive this
  /// @param relief  what the wheels meet in place of the faces labelled floor; none: those faces
  Physics(const Mesh& rock, const Vehicle& vehicle, const Pose& X_WB, double step_s, const Relief* relief = nullptr,
          const std::vector<Loose>& loose = {});
  ~Physics();
  Physics(const Physics&) = delete;
  Physics& operator=(const Physics&) = delete;

  void step(const Effort& effort);
  Motion motion() const;
  Motion loose_motion(size_t k) const;
  /// Stops all motion where it is.
  void rest();
  /// Kinetic and potential energy (zero at z = 0) of all bodies, without what the tyres store.
  double energy_J() const;
  /// A face of the rock that the solid hull touches, the deepest one.
  std::optional<size_t> touched_face() const;
  /// A face too steep to roll up that a wheel touches, the deepest one.
  std::optional<size_t> face_at_wheel() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
