// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/estimate.h"
#include "base/progress.h"
#include "base/recording.h"
#include "base/world.h"
#include "eval/score.h"

#include <string>
#include <vector>

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
  std::vector<std::string> missing = {};  // parts that the run's folder lacks, one sentence each
};

/// Where a picture in space is taken from, in W, instead of the place that it has by itself.
struct Viewpoint {
  Vec3 eye, target;
  double fov_rad = 1;
};

struct ReportSettings {
  int width_px = 1200;      // of a full-width picture
  double range_m = 0;       // end of the colour range of signed errors; 0 = chosen by the errors
  int interiors = 3;        // views from the path
  int places = 10;          // worst places with a close-up
  int frames = 12;          // of the animated sequence along the path
  double exaggeration = 2;  // of heights, in the view of the whole mine
};
Fields fields(ReportSettings& settings);

/// DIR/index.html, one file that needs no other, and beside it each picture as PNG. The same bytes for the same input
/// on any number of threads.
void write_report(const std::string& dir, const ReportInput& input, const ReportSettings& settings,
                  const Progress& progress = {});

}  // namespace adit
