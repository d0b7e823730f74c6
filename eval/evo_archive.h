// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/score.h"

#include <string>

namespace adit {

/// The errors of a path under se3 as the archive that `evo_ape ... -a --save_results` writes and `evo_res` opens: a zip
/// of info.json, stats.json and error_array, timestamps, seconds_from_start, distances_from_start as .npy. Stored, not
/// compressed; the same bytes for the same score.
/// @throws Error for a score without a path
void write_evo_archive(const std::string& file, const Score& score);

}  // namespace adit
