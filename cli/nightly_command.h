// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/commands.h"

#include <string>

namespace adit {

/// What `adit nightly` is asked; empty: not given.
struct NightlyInput {
  std::string suite, history, baseline, commit, branch, shard, accept;
};

/// Makes a suite's runs, holds them against the history, adds the night to it and writes OUT/verdict.json, verdict.md,
/// junit.xml and trend/index.html. 0: nothing is worse; 1: something is; 3: not comparable.
int nightly_command(const NightlyInput& input, const Common& common, Console& console);

}  // namespace adit
