// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"
#include "eval/picture.h"

#include <string>
#include <vector>

namespace adit {

struct MineView {
  std::string name;  // of the file: "plan", "interior-1", "interior-2"
  Picture picture;
};

/// Pictures of a mine before anything is driven in it: its plan with junctions, and what a lamp shows from two places in
/// passages far from each other, looking along the longest free sight. None of a world without passages.
/// @param width_px  even, of each
std::vector<MineView> mine_views(const World& world, int width_px = 1200);

}  // namespace adit
