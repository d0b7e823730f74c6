// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cli/console.h"
#include "cli/estimate_parts.h"

#include <string>
#include <vector>

namespace adit {

/// What every command understands.
struct Common {
  std::string out;                       // -o
  int seed = -1;                         // --seed, -1: the scenario's
  std::vector<std::string> assignments;  // --set
};

/// What `adit score` is to judge, and against what; empty: not given.
struct ScoreInput {
  std::string world, truth;  // folder of the mine, truth.h5
  std::string map;           // a folder as `adit map` writes it, or any of:
  EstimateParts parts;
  std::string relations;  // instead of world and truth, for a real log
  std::string evo;        // archive of the path's errors that evo_res opens
  std::string explain;    // a metric's name, instead of all
};

/// Where `adit render` is to look from: three numbers each, or none.
struct ViewWords {
  std::vector<double> eye, target;
  double fov_deg = 60;
};

// Each command returns the exit code; bad input is thrown as Error.
int run_command(const std::string& scenario, const Common& common, Console& console);
int world_command(const std::string& scenario, const Common& common, Console& console);
int check_command(const std::string& mesh_file, Console& console);
int drive_command(const std::string& scenario, const std::string& world_dir, const Common& common, Console& console);
int map_command(const std::string& recording, const Common& common, Console& console);
int score_command(const ScoreInput& input, const Common& common, Console& console);
int compare_command(const std::vector<std::string>& outs, const Common& common, Console& console);
int report_command(const std::vector<std::string>& outs, const Common& common, Console& console);
int render_command(const std::string& out, const std::string& view, const ViewWords& words, const Common& common,
                   Console& console);
int list_command(const std::string& what, Console& console);
int help_command(const std::string& topic, Console& console);

}  // namespace adit
