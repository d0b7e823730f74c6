// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/drive.h"
#include "base/progress.h"
#include "base/world.h"
#include "sim/vehicle.h"

#include <cstdint>
#include <functional>
#include <string>

namespace adit {

/// How a person pushes: walking speed, stops, gait, wobble; how a robot drives; what the ground is like; and how finely
/// the motion is computed.
struct DriveSettings {
  double speed_mps = 0.7, speed_sd_mps = 0.15;       // slow variation, over some 10 s
  double stop_gap_min_m = 30, stop_gap_max_m = 100;  // way between two stops
  double stop_min_s = 5, stop_max_s = 60;
  double lead_in_s = 3;      // stands before it starts and after it has arrived
  double gait_ripple = 0.1;  // of the speed
  double gait_hz = 1.8;
  double wobble_deg = 2;  // of the heading
  double wobble_min_hz = 0.5, wobble_max_hz = 1;
  double turn_max_deg_s = 35;     // slows down in bends to keep to it
  double robot_speed_mps = 0.15;  // of a vehicle that is not pushed
  double scan_every_m = 0;        // it stops so often for a scan; 0: never
  double scan_stop_s = 15;        // and stands so long
  std::string ground = "smooth";  // what lies on the mesh's floor: smooth (nothing) | track | rubble | mixed
  double track_share = 0.3, rubble_share = 0.2;  // of the passages' length, where mixed
  std::string commands;                          // CSV file of what a joystick asked for; empty: along the route
  int step_hz = 240;                             // of the physics
  int sample_hz = 120;                           // of the path; divides step_hz
};
Fields fields(DriveSettings& settings);
/// @throws Error  where settings exclude one another
void check(const DriveSettings& settings);

/// Drives a vehicle along a route, or by recorded commands from the route's first point.
/// @param world    mesh closed, floor labelled; what is not floor or roof is rock to bump into as well
/// @param route    at least two points and 1 m; the drive starts at rest on its first point, heading along it
/// @return         the true path: B's pose from t = 0 s on, sample_hz times a second, up to the route's end, the last
///                 command, or where the drive ended early. Being stuck, blocked, tipped over and falling are values:
///                 end, and cause with place and time
/// @throws Error   where the vehicle cannot stand at the start (no floor, rock in the way), where a passage of the
///                 route is narrower than the vehicle, where the route runs through rock, where settings exclude one
///                 another, where the file of commands cannot be read
/// The same arguments give the same bits; nothing depends on threads, addresses or earlier drives.
/// The defaults are guesses at how a person pushes, held against the published path of the Bruceton cart (0.145 m per
/// scan).
Drive drive(const World& world, const Route& route, const Vehicle& vehicle, const DriveSettings& settings,
            std::uint64_t seed, const Progress& progress = {});

/// The same without the whole path in memory.
/// @param take  is given each stretch of the drive as soon as it is driven; put one behind the other they are the drive;
///              all but the last are `underway`
/// @return      the drive with the last minute or two of its path
Drive drive(const World& world, const Route& route, const Vehicle& vehicle, const DriveSettings& settings,
            std::uint64_t seed, const std::function<void(Drive&&)>& take, const Progress& progress = {});

}  // namespace adit
