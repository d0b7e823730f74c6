// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"

#include <cstddef>
#include <string>
#include <vector>

namespace adit {

// A recording that is being made lies in a folder of parts: log-0000.h5, truth-0000.h5, log-0001.h5, ..., each closed
// before it bears its name, each a whole file of what happened in its minute. A process that is killed leaves them.

std::string part_log(const std::string& dir, size_t n);
std::string part_truth(const std::string& dir, size_t n);

/// Writes part n of a folder: its truth, then its log.
void save_part(const std::string& dir, size_t n, const Log& log, const Truth& truth);

/// What parts there are.
struct Parts {
  std::vector<std::string> logs, truths;  // in order; truths empty where not every log has its own
  std::vector<std::string> notes;         // what is damaged or missing, and left out
};
/// Opens every part and leaves out those that are not whole, or of another rig than the first. Error where none is left.
Parts find_parts(const std::string& dir);
bool is_parts(const std::string& dir);

/// Removes the parts of a folder, and the folder if nothing else is in it.
void remove_parts(const std::string& dir);

}  // namespace adit
