// SPDX-License-Identifier: BSD-3-Clause
#include "base/rig_text.h"

#include "base/error.h"

#include <algorithm>
#include <numbers>
#include <sstream>
#include <utility>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;

// Key and fault of a mount that cannot be; both empty if it can.
std::pair<std::string, std::string> fault_of(const MountText& m) {
  if (m.name.empty()) return {"name", "is missing: every laser of a rig needs one"};
  if (m.position_m.size() != 3) return {"position_m", "must be three numbers, [x, y, z]"};
  const std::vector<double>& ends = m.tilt_deg;
  if (!ends.empty() &&
      (ends.size() != 2 || !(ends[0] <= 0 && ends[1] >= 0 && ends[0] < ends[1]) || ends[0] < -90 || ends[1] > 90))
    return {"tilt_deg", "must be [from, to] with -90 <= from <= 0 <= to <= 90, from < to; positive looks down"};
  return {};
}

Tilt tilt_of(const MountText& m) {
  if (m.tilt_deg.empty()) return {};
  return {m.tilt_deg[0] * deg, m.tilt_deg[1] * deg, m.tilt_s, m.tilt_when == "standing"};
}

// The words of a change; a value's quotes and brackets hold words together.
std::vector<std::string> words_of(const std::string& change) {
  std::vector<std::string> words(1);
  int open = 0;
  bool quoted = false;
  for (const char c : change) {
    if (c == '"') quoted = !quoted;
    if (!quoted) open += c == '[' ? 1 : c == ']' ? -1 : 0;
    if (c == ' ' && open == 0 && !quoted) {
      if (!words.back().empty()) words.emplace_back();
    } else {
      words.back() += c;
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

void change(RigText& rig, const std::string& text) {
  const std::vector<std::string> words = words_of(text);
  if (words.size() < 2) throw Error("must be \"LASER key=value ...\" or \"LASER off\"");
  auto at = std::find_if(rig.lasers.begin(), rig.lasers.end(), [&](const MountText& m) { return m.name == words[0]; });
  if (words.size() == 2 && words[1] == "off") {
    if (at == rig.lasers.end()) throw Error("the rig '" + rig.name + "' has no laser '" + words[0] + "'");
    rig.lasers.erase(at);
    return;
  }
  MountText changed = at == rig.lasers.end() ? MountText{} : *at;
  changed.name = words[0];
  if (changed.position_m.size() != 3) throw Error("'position_m' of '" + words[0] + "' is not three numbers");
  Fields keys = fields(changed);
  for (int k = 0; k < 3; ++k)
    keys.push_back({std::string(1, "xyz"[k]) + "_m", &changed.position_m[static_cast<size_t>(k)], ""});
  for (size_t i = 1; i < words.size(); ++i) set_field(keys, words[i]);
  if (changed.name != words[0]) throw Error("a laser cannot be given another name");
  if (const auto [key, what] = fault_of(changed); !key.empty()) throw Error("'" + key + "' " + what);
  if (at == rig.lasers.end())
    rig.lasers.push_back(changed);
  else
    *at = changed;
}

}  // namespace

Fields fields(MountText& m) {
  return {{"name", &m.name, "unique in the rig"},
          {"model", &m.model, "a bundled laser or a file"},
          {"mode", &m.mode, "range mode of the model"},
          {"raster", &m.raster, "sector and step of the model"},
          {"sensitivity", &m.sensitivity, "of the model: low, medium or high of an outdoor one"},
          {"position_m", &m.position_m, "x, y, z of the mirror in the body frame"},
          {"yaw_deg", &m.yaw_deg, "turn about z, first", -360, 360},
          {"pitch_deg", &m.pitch_deg, "then about y; positive looks down", -360, 360},
          {"roll_deg", &m.roll_deg, "then about x", -360, 360},
          {"tilt_deg", &m.tilt_deg, "the mount nods between these two, positive down"},
          {"tilt_s", &m.tilt_s, "there and back", 0.1, 1000},
          {"tilt_when", &m.tilt_when, "while it nods, or at all times", {"standing", "always"}}};
}

RigText read_rig(const std::string& name_or_file) {
  const Document file = Document::find("sensors/rigs", name_or_file);
  RigText rig;
  file.read({{"name", &rig.name, "how reports call it"}}, {"laser"});
  if (rig.name.empty()) rig.name = name_or_file;
  for (const Document& table : file.tables("laser")) {
    MountText mount;
    table.read(fields(mount));
    if (const auto [key, what] = fault_of(mount); !key.empty()) table.fail(key, what);
    for (const MountText& other : rig.lasers)
      if (other.name == mount.name) table.fail("name", "is '" + mount.name + "' a second time in this rig");
    rig.lasers.push_back(std::move(mount));
  }
  if (rig.lasers.empty()) throw Error(file.name() + ": no [[laser]] in this rig; it needs one at least");
  return rig;
}

void change_rig(RigText& rig, const std::vector<std::string>& changes) {
  for (const std::string& text : changes) {
    try {
      change(rig, text);
    } catch (const Error& e) {
      throw Error("sensors.mounts: \"" + text + "\": " + e.what());
    }
  }
}

namespace {

/// What the sheet of a mount's laser says; an Error names the rig that asks for it.
LaserModel laser_of(const RigText& text, const MountText& m, int baud, const LaserChoice& choice) {
  try {
    return load_laser(m.model, baud, choice);
  } catch (const Error& e) {
    throw Error("rig '" + text.name + "', laser '" + m.name + "': " + e.what(), e.fault());
  }
}

}  // namespace

Rig rig_of(const RigText& text, int baud, const LaserChoice& choice) {
  if (text.lasers.empty()) throw Error("the rig '" + text.name + "' has no laser left; it needs one at least");
  Rig rig{text.name, {}};
  for (const MountText& m : text.lasers) {
    const auto own = [](const std::string& all, const std::string& mounts) { return all.empty() ? mounts : all; };
    rig.mounts.push_back({.name = m.name,
                          .laser = laser_of(text, m, baud,
                                            {own(choice.mode, m.mode), own(choice.raster, m.raster),
                                             own(choice.sensitivity, m.sensitivity)}),
                          .X_BS = pose_of({m.position_m[0], m.position_m[1], m.position_m[2]}, m.yaw_deg * deg,
                                          m.pitch_deg * deg, m.roll_deg * deg),
                          .tilt = tilt_of(m)});
  }
  return rig;
}

std::string to_toml(const RigText& rig) {
  RigText copy = rig;
  std::string text = to_toml({{"name", &copy.name, ""}});
  for (MountText& m : copy.lasers) {
    Fields kept;
    for (const Field& f : fields(m)) {
      const bool tilt = f.key.starts_with("tilt"),
                 word = f.key == "mode" || f.key == "raster" || f.key == "sensitivity";
      const bool absent = (tilt && m.tilt_deg.empty()) || (word && std::get<std::string*>(f.value)->empty());
      if (!absent) kept.push_back(f);
    }
    text += "\n[[laser]]\n" + to_toml(kept);
  }
  return text;
}

Rig load_rig(const std::string& name_or_file, int baud, const LaserChoice& choice) {
  return rig_of(read_rig(name_or_file), baud, choice);
}

}  // namespace adit
