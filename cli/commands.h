// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/console.h"

#include <string>
#include <vector>

namespace adit {

/// What every command understands.
struct Common {
  std::string out;                       // -o
  int seed = -1;                         // --seed, -1: the scenario's
  std::vector<std::string> assignments;  // --set
};

// Each command returns the exit code; bad input is thrown as Error.
int run_command(const std::string& scenario, const Common& common, Console& console);
int world_command(const std::string& scenario, const Common& common, Console& console);
int check_command(const std::string& mesh_file, Console& console);
int drive_command(const std::string& scenario, const std::string& world_dir, const Common& common, Console& console);
int map_command(const std::string& recording, const Common& common, Console& console);
int score_command(const std::string& world_dir, const std::string& truth_file, const std::string& map_dir,
                  const Common& common, Console& console);
int report_command(const std::vector<std::string>& outs, const Common& common, Console& console);
int render_command(const std::string& out, const std::string& view, const Common& common, Console& console);
int list_command(const std::string& what, Console& console);
int help_command(const std::string& topic, Console& console);

}  // namespace adit
