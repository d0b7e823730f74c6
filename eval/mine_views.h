// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"
#include "eval/lamp.h"
#include "eval/picture.h"

#include <optional>
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

/// What a lamp shows of a mine, its rock under dust and water.
Picture look_into(const World& world, const Camera& camera, int width, int height, double lamp_m = 8);
/// Along the longest free sight of a mine's passages; none of a world without passages.
std::optional<Lookout> longest_sight(const World& world);
/// From a passage towards a thing with that label that is seen well from there; none where there is none.
std::optional<Lookout> lookout_to(const World& world, Label label);

}  // namespace adit
