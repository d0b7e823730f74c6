// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/rig_text.h"
#include "cli/scenario.h"
#include "eval/placement.h"
#include "eval/study.h"

#include <functional>
#include <string>
#include <vector>

namespace adit {

/// One thing that a study varies. Tables [[factor]].
struct Factor {
  std::string key;                  // of the scenario, or rig.LASER.KEY of a mount (x_m, pitch_deg, model, ...);
                                    // set: each value is a list of key=value of the scenario
  std::string name;                 // how results call it; empty: the key
  std::vector<std::string> values;  // TOML each; or a range:
  double from = 0, to = 0;
  int steps = 0;                    // of the range in a grid, both ends included
  bool log = false, whole = false;  // steps of equal ratio; whole numbers
  std::vector<std::string> labels;  // of the values; empty: the values
};

/// What a laser costs. Tables [[device]].
struct Device {
  std::string model;
  double price = 0, mass_kg = 0;
};

/// Where lasers could go: candidates on the vehicle's hull. Table [mounts]; count 0: none are looked for.
struct MountSearch {
  int count = 0;                   // of lasers that are placed
  std::vector<std::string> fixed;  // of the rig: stay where they are; the others go
  std::vector<std::string> models{"lms200"};
  std::vector<std::string> orientations;  // "[yaw, pitch, roll]" deg each
  double spacing_m = 0.3, clearance_m = 0.1, apart_m = 0.15;
  int most = 400;  // candidates; beyond: an error
  int best = 4,
      spread = 4;  // placements that go on to full runs: the best, and as many evenly over all that were scored
};

/// A study as its TOML states it (docs/studies.md).
struct Study {
  std::string name, about;
  std::string scenario = "mini";
  std::vector<std::string> set;  // key=value
  std::vector<int> seeds{1, 2, 3};
  std::vector<std::string> objectives{"map.se3.p95_m", "volume.error_percent"};
  std::string sample = "grid";  // of the factors: grid, sobol or latin
  int samples = 16;             // of sobol and latin
  int sample_seed = 1;
  double price_max = 0, mass_max_kg = 0, clearance_m = 0;  // 0: no limit
  int cells_max = 10000;
  int at_once = 0;
  bool full = true;  // the whole pipeline after the fast score
  bool keep_maps = false, keep_recordings = false;
  std::vector<Factor> factor;
  std::vector<Device> device;
  MountSearch mounts;
  FastSettings fast;
};

/// All settings but mounts.orientations and the tables [[factor]] and [[device]].
Fields study_fields(Study& study);

/// A bundled study by name, or a TOML file, then key=value assignments to its scenario; seed >= 0 stands for its seeds.
/// Errors name file, line and key.
Study load_study(const std::string& name_or_file, const std::vector<std::string>& assignments = {}, int seed = -1);
/// The study with every value written; load_study gives the same again.
std::string to_toml(const Study& study);

/// A level of every factor, and the changes that it stands for.
struct DesignPoint {
  std::vector<std::string> level;
  std::vector<std::string> changes;  // "key=value" of the scenario
  std::vector<std::string> mounts;   // of sensors.mounts
};
/// How many points the factors span, before anything is made.
double design_size(const Study& study);
/// The points in their order. @pre design_size is small enough to be held
std::vector<DesignPoint> design_of(const Study& study);
/// The run that a point asks for.
Scenario scenario_at(const Study& study, const DesignPoint& point, int seed);

/// n points of a Sobol sequence in [0, 1)^dimensions (Joe and Kuo, SIAM J. Sci. Comput. 30, 2008), its digits shifted by
/// the seed. Error beyond 16 dimensions.
std::vector<std::vector<double>> sobol(size_t n, size_t dimensions, int seed);
/// n points of a Latin hypercube: of each dimension's n strata each holds one.
std::vector<std::vector<double>> latin_hypercube(size_t n, size_t dimensions, int seed);

/// What all lasers of a rig cost. Error for a model without a [[device]] where the study limits or judges it.
Device cost_of(const Study& study, const RigText& rig);
/// Why a rig may not be built under the study's limits; empty if it may.
std::string excluded(const Study& study, const RigText& rig, const Hull& hull);
/// The mounts to choose from. Error where there are none or too many.
std::vector<Candidate> candidates_of(const Study& study, const Hull& hull);

}  // namespace adit
