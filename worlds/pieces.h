// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"
#include "worlds/decay.h"
#include "worlds/shell.h"

#include <utility>
#include <vector>

namespace adit {

/// Rubble, cavities and scars, as objects whose sizes are to follow, and the falls with their numbers among them.
std::pair<std::vector<MineObject>, std::vector<NumberedFall>> pieces_of(const std::vector<Fall>& falls);

/// Those that may reach into a frame.
std::vector<NumberedFall> falls_in(const std::vector<NumberedFall>& falls, const Frame2& frame);

/// An object grows by what of it lies in another tile.
void grow(MineObject& object, const Shell::Piece& more);

}  // namespace adit
