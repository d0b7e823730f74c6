// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"

#include <string>

namespace adit {

// CARMEN logs (.log, .clf): text, one message a line, "NAME fields ipc_timestamp host logger_timestamp".
// Source: carmen.sourceforge.net, "Logging Data and Playing It Back".

enum class CarmenStyle { flaser, robotlaser };

/// A CARMEN log, and the poses that came with it, in the plane.
struct CarmenLog {
  Log log;               // lasers "front" (FLASER, ROBOTLASER1) and "rear" (RLASER, ROBOTLASER2), where there are lines
  Trajectory odometry;   // of the robot, by the front laser's lines
  Trajectory true_path;  // TRUEPOS lines; empty without
  std::vector<std::string> notes;  // lines that could not be read, how many and which was the first
};

/// Reads laser lines of either style, TRUEPOS, and PARAM robot_front_laser_max; passes over other lines. Ranges at or
/// beyond the laser's maximum are no echo. Old lines state no field of view: it is 180 deg, with 180 and 360 values
/// (or any even number) the last beam is missing. The device is taken for an LMS 200. Stamps are those of the message
/// (ipc_timestamp), by which published relations name their poses, not the logger's.
/// A line that is cut or not of numbers, of another raster than the laser's first, or with a stamp that does not grow is
/// left out, which a note tells with file and line; where that befalls most lines it is an Error.
CarmenLog read_carmen(const std::string& file);

/// Writes the horizontal laser while its mount is level; others have no place in the format. Poses of the laser lines
/// are the odometry, which a cart without wheel encoders does not have: 0. With `truth` each scan is preceded by its
/// TRUEPOS. No echo and unreadable beams are told as 81.91 m, as an LMS in its default mode does. Error where no laser
/// is horizontal.
void write_carmen(const std::string& file, const Log& log, CarmenStyle style, const Truth* truth = nullptr);

}  // namespace adit
