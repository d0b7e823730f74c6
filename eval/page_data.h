// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/exhibit.h"

#include <string>

namespace adit {

/// What the page's script draws from, as JSON that may stand in a page: errors along the path, by label and by distance,
/// the passages, the map and the mine in space, the lasers' beams, the views along the path. What the run lacks is left
/// out.
/// @param wide, narrow  the plans on which the script marks the place that is looked at
std::string page_data(const Exhibit& exhibit, const Figure& wide, const Figure& narrow,
                      const std::vector<AlongFrame>& frames);

}  // namespace adit
