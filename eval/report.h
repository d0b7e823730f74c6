// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/estimate.h"
#include "base/progress.h"
#include "base/recording.h"
#include "base/world.h"
#include "eval/score.h"

#include <string>

namespace adit {

/// What a page tells of: one run. Parts may be empty; the page shows what is there and says what is not.
struct ReportInput {
  const World& world;
  const Log& log;
  const Truth& truth;
  const Estimate& estimate;
  const Score& score;
  std::string scenario_toml;
  std::string name;
};

struct ReportSettings {
  int width_px = 1200;      // of a full-width picture
  double range_m = 0;       // end of the colour range of signed errors; 0 = chosen by the errors
  int interiors = 3;        // views from the path
  int places = 6;           // worst places with a close-up
  double exaggeration = 2;  // of heights, in the view of the whole mine
};
Fields fields(ReportSettings& settings);

/// DIR/index.html, one file that needs no other, and beside it each picture as PNG. The same bytes for the same input
/// on any number of threads.
void write_report(const std::string& dir, const ReportInput& input, const ReportSettings& settings,
                  const Progress& progress = {});

}  // namespace adit
