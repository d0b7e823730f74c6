// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/estimate.h"
#include "base/progress.h"
#include "base/recording.h"

#include <optional>
#include <string>
#include <vector>

namespace adit {

/// A mapper that somebody else wrote. Keys below [map.external].
struct ExternalSettings {
  std::vector<std::string> command;  // empty: adit's own mapper
  std::string name;                  // how scores call it; empty: the command's first word
  std::string laser;                 // whose path it tells; empty: the body's
  double limit_s = 3600, limit_gib = 8, limit_out_gib = 4;
};
Fields fields(ExternalSettings& settings);

/// What became of it.
struct ExternalRun {
  std::optional<Estimate> estimate;  // none: it failed
  std::string failure;               // why, with its exit status, limit or signal and its last words
  double seconds, peak_gib;
};

/// Runs the command without a shell, its words being taken as they are but for placeholders: {out}, the folder for its
/// results (cli/parts.h names the files); {log.h5}, {log.clf}, ... the log in the format of that ending, without the
/// truth; {seed}. A word that names a file from where adit was called goes on naming it, for the working folder
/// is DIR/work. stdin is empty; stdout and stderr go to DIR/log.txt. It and all that it
/// started are ended when it runs too long, takes too much memory or fills DIR beyond the limit.
/// @param dir  emptied first; afterwards it holds log.txt, out/ and work/
/// @throws Error for a placeholder that is none, a log that cannot be written so, a command that cannot be started
ExternalRun run_external(const ExternalSettings& settings, const Log& log, int seed, const std::string& dir,
                         const Progress& progress = {});

}  // namespace adit
