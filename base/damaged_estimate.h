// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"

#include <string>
#include <vector>

namespace adit {

/// What can be read of a map's folder, file by file, where load_estimate would refuse the whole.
/// @param damaged  gets a sentence for each file that is missing, foreign or does not fit the others
Estimate load_what_is_whole(const std::string& dir, std::vector<std::string>& damaged);

}  // namespace adit
