// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"
#include "cli/commands.h"

#include <string>

namespace adit {

/// The log in a file of any format that holds one: .h5 of ours, .log and .clf of CARMEN, .bag of ROS 1. What could not
/// be read of it is said.
Log load_any_log(const std::string& file, Console& console);

/// A log alone, in the format that the name says. Error for a format that needs the truth.
void write_any_log(const std::string& file, const Log& log);

/// Writes what `from` holds in the format that the name of `to` says; docs/sensors.md has the table.
/// @param truth_file  of the recording; empty: truth.h5 beside `from`, where there is one
/// @param every       of clouds: every so many scans
int convert_command(const std::string& from, const std::string& to, const std::string& truth_file, int every,
                    Console& console);

}  // namespace adit
