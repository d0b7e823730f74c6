// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"

#include <string>
#include <vector>

namespace adit {

// Bags of ROS 1, format 2.0, and the messages of a laser log in them.
// Source: wiki.ros.org/Bags/Format/2.0; sensor_msgs, nav_msgs, tf2_msgs of ROS 1.

/// What a bag holds of a laser log.
struct BagLog {
  Log log;                         // a laser for each topic of sensor_msgs/LaserScan, named by it
  Trajectory path;                 // of /truth/odom, or of the first topic of nav_msgs/Odometry; empty without
  std::vector<std::string> notes;  // what was guessed, left out or cut short
};

/// Reads a bag, indexed or not, its chunks plain, bz2 or lz4. Mounts are those of tf_static (or the first tf) from the
/// topmost frame that stands still to the laser's. Ranges outside of a message's limits are no echo above and unreadable
/// below. A device is taken for an LMS 200 of the raster that its messages tell. Of a bag whose end is cut off what is
/// there is read and a note says so. Not a bag, of another version, without a scan: Error.
BagLog read_bag(const std::string& file);

/// Writes plain chunks: /<laser>/scan, /tf_static from base_link to each laser (for a mount that nods /tf at every
/// scan), and with `truth` the true path, 30 Hz, as /truth/odom (world to base_link) and as /tf from world to
/// truth/base_link, a frame of its own so that nobody's map is led by it.
void write_bag(const std::string& file, const Log& log, const Truth* truth = nullptr);

}  // namespace adit
