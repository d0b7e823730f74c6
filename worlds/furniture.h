// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/decay.h"
#include "worlds/outline.h"
#include "worlds/plan.h"
#include "worlds/space.h"

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace adit {

/// What furniture is placed by: a mine's layout, its settings with nothing left to the condition, its chance.
struct FurniturePlan {
  const WorldSettings& settings;
  const MinePlan& plan;
  const std::vector<Drift>& drifts;
  const Decay& decay;
  std::uint64_t seed;
};

/// How many things chance asked for: of a passage, with a label.
using Asked = std::map<std::pair<size_t, Label>, int>;

/// Fits out the part of a mine that a space shows: of the passages named, what lies wholly in it. What has no room is left
/// out. Every thing has its own random address, so that tiles do not matter but for what stands across their cuts.
/// @return  what was asked for in the passages named, wherever in the mine it lies
Asked furnish(const FurniturePlan& plan, const std::vector<size_t>& passages, Space& space);

}  // namespace adit
