// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace adit {

/// Text of a data file that is part of the program, by its path in the source tree ("sim/vehicles/cart.toml"); "" if
/// none.
std::string_view bundled(const std::string& path);
/// Names (no folder, no ending) of the bundled files of a folder, sorted.
std::vector<std::string> bundled_names(const std::string& folder);

}  // namespace adit
