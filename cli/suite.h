// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/scenario.h"
#include "eval/verdict.h"

#include <string>
#include <vector>

namespace adit {

/// Scenarios x seeds x methods, and what is watched of them. docs/nightly.md has the keys of the file.
struct Suite {
  std::string name, about;
  int first_seed = 1, seeds = 16;  // of every scenario that says nothing else
  bool pictures = false;           // keep maps, to show a regression before and after
  SuiteRules rules;
  struct Part {
    std::string name, scenario;     // as the history calls it; bundled, or a file
    int first_seed = 0, seeds = 0;  // 0: as the suite says
    std::vector<std::string> set;   // "key=value" of the scenario
  };
  std::vector<Part> scenario;
  struct Method {
    std::string name;
    std::vector<std::string> set;
  };
  std::vector<Method> method;  // at least one
};

/// The keys of a suite outside of its tables.
Fields suite_fields(Suite& suite);

/// A bundled suite or a file.
/// @throws Error naming file, line and key: scenarios that there are not, metrics that nothing measures, settings that do
/// not fit
Suite load_suite(const std::string& name_or_file);

/// One run of a suite.
struct SuiteCell {
  std::string scenario, method;
  Scenario run;
};
/// All of them, each with the command line's assignments on top.
std::vector<SuiteCell> cells_of(const Suite& suite, const std::vector<std::string>& assignments);
/// What numbers are only comparable under: the evaluator's version, and the [score] settings where they are not the
/// defaults.
std::string evaluator_of(const std::vector<SuiteCell>& cells);

}  // namespace adit
