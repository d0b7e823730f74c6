// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/commands.h"

#include <string>

namespace adit {

/// `adit study STUDY [--shard I/N]`: runs a study's cells and, without a shard, says what they tell; `adit study merge OUT`
/// says it of cells that shards have made. 1 where cells are still missing.
int study_command(const std::string& study, const std::string& merged, const std::string& shard, const Common& common,
                  Console& console);

}  // namespace adit
