// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "cli/commands.h"

#include <string>
#include <vector>

namespace adit {

/// A set of mines: one scenario, keys of it drawn anew for each mine.
struct MineSet {
  std::string name, about;
  std::string scenario = "mini";
  int mines = 10;
  int seed = 1;                   // of the first mine; the next has the next
  std::string until = "world";    // world | drive: what is made of each
  std::vector<std::string> vary;  // "KEY uniform LOW HIGH", "KEY normal MEAN SD LOW HIGH", "KEY integer LOW HIGH",
                                  // "KEY choice A B ..."
  std::vector<std::string> set;   // key=value, for all of them
  std::vector<double> split{0.7, 0.15, 0.15};  // train, val, test
  std::string licence = "CC-BY-4.0";
};
Fields fields(MineSet& set);

/// Whether a scenario's name is that of a file of a set: it has the key 'mines' or 'vary'.
bool is_set(const std::string& name);

/// Makes the mines of a set that OUT does not hold yet: OUT/mine-NNNN, manifest.csv, manifest.json, README.md (the data set
/// card). Mines of one plan are in one part of the split. Exit code 1: some could not be made.
int set_command(const std::string& file, const Common& common, Console& console);

}  // namespace adit
