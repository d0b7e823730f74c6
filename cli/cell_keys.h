// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/scenario.h"

#include <string>

namespace adit {

/// A scenario without what no score depends on.
Scenario bare(Scenario scenario);

/// What a cell and the things that it is made from are called: those with the same key are the same, made once.
/// Each is a digest of the settings and of the text of all files that they name.
struct CellKeys {
  std::string world, drive, recording, yardstick, map, cell;
};
CellKeys keys_of(const Scenario& scenario);

}  // namespace adit
