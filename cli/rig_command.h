// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/commands.h"

#include <string>

namespace adit {

/// Pictures of a rig on its vehicle (--set vehicle=NAME) in a plain passage: DIR/corner.png, side.png, front.png,
/// above.png.
int rig_command(const std::string& rig, const Common& common, Console& console);

}  // namespace adit
