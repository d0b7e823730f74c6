// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/console.h"

#include <string>

namespace adit {

/// `adit world --stats DIR`: what all mines under a folder measure, taken together.
int stats_command(const std::string& dir, const std::string& out, Console& console);

}  // namespace adit
