// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/progress.h"
#include "cli/scenario.h"
#include "eval/score.h"

#include <optional>
#include <string>
#include <vector>

namespace adit {

// A cell is one run among many: a resolved scenario, made as `adit run` makes it but without pictures and page, and kept
// in a folder that bears the hash of its settings. What bears that name is whole: scenario.toml, timing.json, and
// score.json (the same bytes as a run's of the name 'cell') or failure.txt with the reason why there is none.

/// 16 hex digits of a text.
std::string digest(const std::string& text);

/// 16 hex digits from every setting of a scenario that its score can depend on (so not name, about and [report]), from
/// what is in the files that it names, and from adit's version.
std::string cell_name(const Scenario& scenario);

struct CellsSettings {
  std::string dir;  // DIR/NAME for each cell
  bool keep_map = false, keep_recording = false;
  int at_once = 0;            // cells side by side; 0: as many as there are threads
  int shard = 1, shards = 1;  // of the cells, in the order of what they share, only this part
};

/// What became of them.
struct CellsRun {
  size_t asked = 0, there = 0, made = 0, failed = 0;  // of the shard; those that were there before; failed of both
};

/// Makes the cells that are not there yet. Cells of one mine, one drive, one recording or one map make it once, as
/// they do what judges the maps of one recording, and hold it no longer than one of them needs it. Cells run side by
/// side, each loop within them shares the same threads; another one begins only while memory is left for it. A cell that fails (drive ended early, mapper failed, bad settings) is kept
/// with its reason; it never ends the others. The same bytes in any order, on any number of threads, after any number of kills, and
/// where several processes make the same cell.
/// @throws Error (file) where a cell cannot be written: those written before stay
CellsRun run_cells(const std::vector<Scenario>& scenarios, const CellsSettings& settings,
                   const Progress& progress = {});

struct Cell {
  std::string name, failure;  // empty: it has a score
  std::optional<Score> score;
  double seconds = 0;   // of its own; what cells share is counted where it was made
  double peak_gib = 0;  // of the whole process while it was made, whatever ran beside it; 0: an older adit made it
};
/// A cell of DIR; none where it is not made yet.
std::optional<Cell> load_cell(const std::string& dir, const std::string& name);

}  // namespace adit
