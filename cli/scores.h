// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/console.h"
#include "eval/score.h"

#include <string>
#include <vector>

namespace adit {

/// The metrics that a person looks at first.
const std::vector<std::string>& headline_metrics();
/// Their values, as far as a score has them, one a line.
void print_scores(const Score& score, Console& console);

}  // namespace adit
