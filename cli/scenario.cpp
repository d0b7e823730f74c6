// SPDX-License-Identifier: BSD-3-Clause
#include "cli/scenario.h"

#include <filesystem>

namespace adit {

Fields fields(Scenario& s) {
  Fields all{{"name", &s.name, "how outputs call the run"},
             {"about", &s.about, "one sentence"},
             {"seed", &s.seed, "of all chance; another seed is another mine, drive and noise", 0, 2147483647},
             {"vehicle", &s.vehicle, "bundled under sim/vehicles, or a TOML file"}};
  append(all, "world", fields(s.world));
  append(all, "route", fields(s.route));
  append(all, "drive", fields(s.drive));
  append(all, "sensors", fields(s.sensors));
  append(all, "map", fields(s.map));
  append(all, "map.external", fields(s.external));
  append(all, "score", fields(s.score));
  append(all, "report", fields(s.report));
  return all;
}

Scenario load_scenario(const std::string& name_or_file, const std::vector<std::string>& assignments) {
  const Document file = Document::find("cli/scenarios", name_or_file);
  Scenario s;
  s.name = std::filesystem::path(name_or_file).stem().string();
  std::string version;
  Fields known = fields(s);
  known.push_back({"version", &version, "of the adit that wrote the file"});
  file.read(known);
  for (const std::string& a : assignments) set_field(fields(s), a);
  return s;
}

std::string resolved_toml(const Scenario& s) {
  Scenario copy = s;
  std::string version = ADIT_VERSION;
  Fields all = fields(copy);
  all.insert(all.begin(), {"version", &version, ""});
  return to_toml(all);
}

}  // namespace adit
