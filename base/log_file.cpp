// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/recording.h"
#include "base/rig_file.h"

#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr std::int32_t no_echo = -1, unreadable = -2;

// Besides no_echo and unreadable.
constexpr std::pair<const char*, Code> code_names[] = {{"weak", Code::weak},
                                                       {"beyond", Code::beyond},
                                                       {"dazzled", Code::dazzled},
                                                       {"overflow", Code::overflow},
                                                       {"channel", Code::channel}};

// Whole millimetres where the laser tells whole millimetres, else micrometres: finer than a float at 8 m.
double unit_mm(const LaserModel& laser) {
  const double step_mm = laser.resolution_m * 1e3;
  return step_mm > 0.5 && std::abs(step_mm - std::round(step_mm)) < 1e-9 ? 1.0 : 1e-3;
}

std::int32_t to_stored(float range_m, Code code, double unit_mm) {
  if (code != Code::range) return -static_cast<std::int32_t>(code);
  if (std::isnan(range_m)) return unreadable;
  const double steps = std::round(static_cast<double>(range_m) * 1e3 / unit_mm);
  if (!(steps < std::numeric_limits<std::int32_t>::max())) return no_echo;
  return static_cast<std::int32_t>(std::max(steps, 0.0));
}

Code code_of(std::int32_t value) {
  if (value >= 0) return Code::range;
  return value >= -static_cast<std::int32_t>(Code::channel) ? static_cast<Code>(-value) : Code::unreadable;
}

float from_stored(std::int32_t value, double unit_mm) {
  const Code code = code_of(value);
  if (code == Code::no_echo || code == Code::weak || code == Code::beyond)
    return std::numeric_limits<float>::infinity();
  if (code != Code::range) return std::numeric_limits<float>::quiet_NaN();
  return static_cast<float>(value * unit_mm * 1e-3);
}

// What the numbers in ranges_mm mean.
void explain_ranges(H5Writer& out, const std::string& at, double unit_mm) {
  out.number(at + "/ranges_mm", "unit_mm", unit_mm);
  out.integer(at + "/ranges_mm", "no_echo", no_echo);
  out.integer(at + "/ranges_mm", "unreadable", unreadable);
  for (const auto& [name, code] : code_names) out.integer(at + "/ranges_mm", name, -static_cast<std::int64_t>(code));
}

void save_scans(H5Writer& out, const Mount& mount, const Scans& scans) {
  const std::string at = "/scans/" + mount.name;
  const double unit = unit_mm(mount.laser);
  std::vector<std::int32_t> ranges(scans.range_m.size());
  for (size_t i = 0; i < ranges.size(); ++i)
    ranges[i] = to_stored(scans.range_m[i], scans.code.empty() ? Code::range : scans.code[i], unit);
  out.group(at);
  out.array<double>(at + "/stamp_s", scans.stamp_s, {scans.size()});
  out.array<std::int32_t>(at + "/ranges_mm", ranges, {scans.size(), static_cast<std::uint64_t>(scans.beams)});
  if (!scans.tilt_rad.empty()) out.array<double>(at + "/tilt", scans.tilt_rad, {scans.size()});
  explain_ranges(out, at, unit);
}

Scans load_scans(const H5Reader& in, const Mount& mount) {
  const std::string at = "/scans/" + mount.name;
  Scans scans;
  scans.beams = mount.laser.beams;
  const Shape size = in.shape(at + "/stamp_s");
  if (size.size() != 1) throw Error(in.file() + ": " + at + "/stamp_s must have one dimension");
  scans.stamp_s = in.array<double>(at + "/stamp_s", size);
  for (size_t i = 1; i < scans.size(); ++i)
    if (!(scans.stamp_s[i] > scans.stamp_s[i - 1]))
      throw Error(in.file() + ": " + at + "/stamp_s must increase; row " + std::to_string(i) + " does not");
  const double unit = in.number(at + "/ranges_mm", "unit_mm");
  if (!(unit > 0)) throw Error(in.file() + ": attribute 'unit_mm' at " + at + "/ranges_mm must be greater than 0");
  const auto stored = in.array<std::int32_t>(at + "/ranges_mm", {size[0], static_cast<std::uint64_t>(scans.beams)});
  scans.range_m.resize(stored.size());
  for (size_t i = 0; i < stored.size(); ++i) scans.range_m[i] = from_stored(stored[i], unit);
  if (in.has_attribute(at + "/ranges_mm", "dazzled")) {
    scans.code.resize(stored.size());
    for (size_t i = 0; i < stored.size(); ++i) scans.code[i] = code_of(stored[i]);
  }
  if (has_array(in, at, "tilt")) scans.tilt_rad = in.array<double>(at + "/tilt", size);
  return scans;
}

void write_file(const std::string& file, const Rig& rig, Packing packing, const std::function<void(H5Writer&)>& scans) {
  check_names(rig, file);
  write_whole(file, [&](const std::string& temporary) {
    H5Writer out(temporary, file, packing);
    begin_file(out, "adit log");
    save_rig(out, rig);
    out.group("/scans");
    scans(out);
    out.close();
  });
}

}  // namespace

void save_log(const std::string& file, const Log& log, Packing packing) {
  ADIT_CHECK(log.scans.size() == log.rig.mounts.size());
  write_file(file, log.rig, packing, [&](H5Writer& out) {
    for (size_t i = 0; i < log.scans.size(); ++i) save_scans(out, log.rig.mounts[i], log.scans[i]);
  });
}

void join_logs(const std::string& file, const std::vector<std::string>& pieces) {
  Pieces from(pieces);
  ADIT_CHECK(from.size() > 0);
  const Rig rig = load_rig(from.at(0));
  write_file(file, rig, Packing::small, [&](H5Writer& out) {
    for (const Mount& mount : rig.mounts) {
      const std::string at = "/scans/" + mount.name;
      out.group(at);
      from.join<double>(out, at, "stamp_s");
      from.join<std::int32_t>(out, at, "ranges_mm");
      if (from.has(at, "tilt")) from.join<double>(out, at, "tilt");
      explain_ranges(out, at, unit_mm(mount.laser));
    }
  });
}

Log load_log(const std::string& file) {
  const H5Reader in(file);
  expect_format(in, "adit log");
  Log log;
  log.rig = load_rig(in);
  for (const Mount& mount : log.rig.mounts) log.scans.push_back(load_scans(in, mount));
  return log;
}

}  // namespace adit
