// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "cli/external.h"
#include "eval/report.h"
#include "eval/score.h"
#include "mapper/mapper.h"
#include "sensors/sensors.h"
#include "sim/sim.h"
#include "worlds/worlds.h"

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// Everything that a run is made from. The same scenario and seed give the same bytes.
struct Scenario {
  std::string name, about;
  int seed = 1;
  std::string vehicle = "cart";  // bundled under sim/vehicles, or a file
  WorldSettings world;
  RouteSettings route;
  DriveSettings drive;
  SensorSettings sensors;
  MapSettings map;
  ExternalSettings external;
  ScoreSettings score;
  ReportSettings report;
};
Fields fields(Scenario& s);

/// A bundled scenario by name or a file, then the command line's key=value assignments in order. `version` in a
/// resolved scenario is checked to be text and otherwise ignored.
Scenario load_scenario(const std::string& name_or_file, const std::vector<std::string>& assignments = {});
/// The scenario with every value written, as OUT/scenario.toml holds it.
std::string resolved_toml(const Scenario& s);

}  // namespace adit
