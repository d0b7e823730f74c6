// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rays/caster.h"
#include "sensors/fan.h"
#include "sensors/motion.h"

#include <span>
#include <vector>

namespace adit {

/// Directions by their numbers.
struct Directions {
  std::vector<double> x, y, z;
  void resize(size_t n) { x.resize(n), y.resize(n), z.resize(n); }
};

/// Where the beams of a scan stand in a table: scans that see the same rock stand beam by beam beside each other, so that
/// their rays are traced together.
struct Places {
  size_t first = 0, step = 1;

  size_t operator[](size_t beam) const { return first + beam * step; }
};

/// Sends the beams of a mount's fan out from where the mount is when each of them leaves.
class Aim {
 public:
  Aim(const MountFan& fan, const Vec3& p_BS, int interlace);

  size_t beams() const { return order_.size(); }
  /// The rays in W of a scan that begins at time_s, one a beam, into their places of `rays`.
  /// @param error_rad  (beams) by which each beam's direction errs to its left in the scan plane
  /// @param left       or null: the direction in the scan plane to the left of each beam, at the same places
  void rays(double time_s, std::span<const double> error_rad, Motion& motion, RayColumns<double>& rays,
            const Places& places, Directions* left) const;

 private:
  struct Batch;
  void turn(Batch& batch, std::span<const double> error_rad, size_t begin, size_t n) const;
  void carry(Batch& batch, const Stretch& stretch, double time_s, size_t begin, size_t n, bool with_left) const;

  // Beams in the order in which they leave: each turn of the mirror fires every so-manieth of them.
  std::vector<size_t> order_;     // beam
  std::vector<double> offset_s_;  // after the scan's begin
  std::vector<double> along_[3], left_[3];
  Vec3 p_BS_;
};

}  // namespace adit
