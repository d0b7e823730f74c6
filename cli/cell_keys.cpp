// SPDX-License-Identifier: BSD-3-Clause
#include "cli/cell_keys.h"

#include "base/error.h"
#include "base/files.h"
#include "base/rig_text.h"
#include "cli/cells.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;

// What a setting that may name a file refers to: its text, empty for a bundled name or a file that is not there.
std::string text_behind(const std::string& name) {
  std::error_code failed;
  return name.find_first_of("/.") != std::string::npos && fs::is_regular_file(name, failed) ? read_text(name) : "";
}

std::string world_key(const Scenario& s) {
  Scenario only;
  only.world = s.world, only.seed = s.seed;
  return digest(resolved_toml(only) + text_behind(s.world.plan));
}
std::string drive_key(const Scenario& s) {
  Scenario only;
  only.world = s.world, only.seed = s.seed, only.route = s.route, only.drive = s.drive, only.vehicle = s.vehicle;
  return digest(resolved_toml(only) + text_behind(s.world.plan) + text_behind(s.vehicle) +
                text_behind(s.drive.commands));
}
// The sheets of the lasers that a rig names; none of a rig that cannot be read, whose cells fail.
std::string sheets_of(const SensorSettings& sensors) {
  RigText rig;
  try {
    rig = read_rig(sensors.rig);
    change_rig(rig, sensors.mounts);
  } catch (const Error& e) {
    if (e.fault() == Fault::file) throw;
    return "";
  }
  std::string text;
  for (const MountText& m : rig.lasers) text += text_behind(m.model);
  return text;
}

std::string recording_key(const Scenario& s) {
  Scenario only = bare(s);
  only.map = {}, only.external = {}, only.score = {};
  return digest(resolved_toml(only) + text_behind(s.sensors.rig) + sheets_of(s.sensors) + drive_key(s));
}

// What judges its maps, and what makes one.
std::string yardstick_key(const Scenario& s, const std::string& recording) {
  Scenario only;
  only.score = s.score;
  return digest(resolved_toml(only) + recording);
}
std::string map_key(const Scenario& s, const std::string& recording) {
  Scenario only;
  only.seed = s.seed, only.map = s.map, only.external = s.external;
  return digest(resolved_toml(only) + recording);
}

}  // namespace

// FNV-1a, its bits mixed at the end.
std::string digest(const std::string& text) {
  std::uint64_t h = 0xcbf29ce484222325;
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9;
  h = (h ^ (h >> 27)) * 0x94d049bb133111eb;
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(h ^ (h >> 31)));
  return hex;
}

Scenario bare(Scenario s) {
  s.name = s.about = "";
  s.report = {};
  return s;
}

CellKeys keys_of(const Scenario& s) {
  const std::string recording = recording_key(s);
  return {world_key(s),
          drive_key(s),
          recording,
          yardstick_key(s, recording),
          map_key(s, recording),
          digest(resolved_toml(bare(s)) + recording)};
}

std::string cell_name(const Scenario& scenario) {
  return keys_of(scenario).cell;
}

}  // namespace adit
