// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/world.h"
#include "sim/follower.h"
#include "sim/ground.h"
#include "sim/physics.h"

#include <optional>
#include <string>

namespace adit {

/// Printf into a string.
std::string say(const char* format, ...);

/// Why a drive ended early.
struct Trouble {
  DriveEnd end;
  std::string cause;     // one sentence, with place and time
  bool held_up = false;  // it does not get on: another try may help
};

/// How far a drive has come, at an instant.
struct Headway {
  double t_s = 0;
  double along_m = 0;   // B's origin along the route
  double driven_m = 0;  // of the route
  Guide guide;
  bool by_route = true;  // else by commands
};

/// Notices that a vehicle no longer gets on. All that is constant is kept by reference.
class Watch {
 public:
  Watch(const World& world, const Floor& floor, const Vehicle& vehicle)
      : world_(world), floor_(floor), vehicle_(vehicle) {}

  /// It is not meant to move now.
  void stands(double t_s) { moved_s_ = ahead_s_ = t_s; }
  std::optional<Trouble> look(const Headway& headway, const Motion& motion, const Effort& effort,
                              const Physics& physics);

 private:
  void watch_headway(const Headway& headway, const Motion& motion);
  bool over_floor(const Motion& motion) const;
  std::string place(const Headway& headway, const Motion& motion) const;
  Trouble held_up(const Headway& headway, const Motion& motion, const Effort& effort, const Physics& physics) const;
  std::string face_name(size_t face) const;

  const World& world_;
  const Floor& floor_;
  const Vehicle& vehicle_;
  double best_m_ = 0, ahead_s_ = 0, moved_s_ = 0;
  Vec3 moved_to_ = Vec3::Zero();
  double turned_to_rad_ = 0;
};

}  // namespace adit
