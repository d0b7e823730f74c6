// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/progress.h"
#include "cli/suite.h"
#include "eval/history.h"
#include "eval/trend_page.h"

#include <string>
#include <vector>

namespace adit {

/// Shows the night's regressions, the first of each scenario and method: the worst seed's map of tonight beside that of
/// the last night that was well, in the view in which such a metric is seen, and the whole report of tonight's run.
/// Pictures go to OUT/trend, reports to OUT/reports.
/// @param cells  folder of tonight's cells, with their maps
std::vector<BeforeAfter> show_regressions(const std::string& out, const std::string& cells, const Verdict& verdict,
                                          const std::vector<SuiteCell>& suite, const Progress& progress);

/// Keeps the maps of a night that was well, for the pictures of one that is not: OUT/baseline/SCENARIO.METHOD.SEED, and
/// lets the maps of other builds go.
void keep_maps(const std::string& out, const std::string& cells, const Night& night,
               const std::vector<SuiteCell>& suite);

}  // namespace adit
