// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/pusher.h"
#include "sim/vehicle.h"

#include <string>
#include <vector>

namespace adit {

/// What somebody at a joystick asked for from an instant on.
struct Command {
  double time_s, speed_mps, turn_rate_rad_s;
};

/// A CSV file with the columns time_s, speed_mps and turn_rate_rad_s in any order; lines that begin with '#' are left
/// out. Errors name file and line: a column or number that is missing, times that do not increase, fewer than two rows.
std::vector<Command> read_commands(const std::string& file);

/// Drives by commands: each holds until the next one, the last one ends the drive. Speeds change no faster than the
/// vehicle or its pusher can; where neither speed nor turn is asked for, the vehicle is held.
class Remote {
 public:
  Remote(std::vector<Command> commands, const Vehicle& vehicle);

  Intent want(double t_s, double step_s);
  bool done(double t_s) const { return t_s >= commands_.back().time_s; }

 private:
  std::vector<Command> commands_;
  double acceleration_mps2_, turn_acceleration_rad_s2_;
  size_t next_ = 0;  // the first command that is still to come
  double speed_mps_ = 0, turn_rad_s_ = 0;
};

}  // namespace adit
