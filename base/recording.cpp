// SPDX-License-Identifier: BSD-3-Clause
#include "base/recording.h"

#include "base/error.h"
#include "base/files.h"
#include "base/h5.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr int version = 1;  // of the layout that docs/files.md describes
constexpr std::int32_t no_echo = -1, unreadable = -2;

struct LaserNumber {
  const char* key;
  double LaserModel::*value;
};
constexpr LaserNumber laser_numbers[] = {
    {"fov_rad", &LaserModel::fov_rad},
    {"turn_s", &LaserModel::turn_s},
    {"interval_s", &LaserModel::interval_s},
    {"range_max_m", &LaserModel::range_max_m},
    {"resolution_m", &LaserModel::resolution_m},
    {"sigma_m", &LaserModel::sigma_m},
    {"bias_m", &LaserModel::bias_m},
    {"spot_m", &LaserModel::spot_m},
    {"divergence_rad", &LaserModel::divergence_rad},
    {"reflectivity_at_4m", &LaserModel::reflectivity_at_4m},
    {"reflectivity_exponent", &LaserModel::reflectivity_exponent},
};

// Besides no_echo and unreadable.
constexpr std::pair<const char*, Code> code_names[] = {{"weak", Code::weak},
                                                       {"beyond", Code::beyond},
                                                       {"dazzled", Code::dazzled},
                                                       {"overflow", Code::overflow},
                                                       {"channel", Code::channel}};

// Poses are stored as the upper three rows of their matrices.
std::vector<double> flat(std::span<const Pose> poses) {
  std::vector<double> numbers;
  numbers.reserve(poses.size() * 12);
  for (const Pose& X : poses)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) numbers.push_back(X.matrix()(row, column));
  return numbers;
}

std::vector<Pose> poses_of(std::span<const double> numbers) {
  std::vector<Pose> poses(numbers.size() / 12, Pose::Identity());
  for (size_t i = 0; i < poses.size(); ++i)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column) poses[i].matrix()(row, column) = numbers[12 * i + 4 * row + column];
  return poses;
}

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

void check_names(const Rig& rig, const std::string& file) {
  for (const Mount& mount : rig.mounts)
    if (mount.name.empty() || mount.name == "." || mount.name.find('/') != std::string::npos)
      throw Error(file + ": a laser named '" + mount.name + "' cannot be kept; a name needs letters and no '/'");
}

void save_rig(H5Writer& out, const Rig& rig) {
  out.group("/rig");
  out.text("/rig", "name", rig.name);
  for (size_t i = 0; i < rig.mounts.size(); ++i) {
    const Mount& mount = rig.mounts[i];
    const std::string at = "/rig/" + mount.name;
    out.group(at);
    out.integer(at, "index", static_cast<std::int64_t>(i));
    out.text(at, "model", mount.laser.name);
    out.integer(at, "beams", mount.laser.beams);
    out.integer(at, "interlace", mount.laser.interlace);
    for (const LaserNumber& number : laser_numbers) out.number(at, number.key, mount.laser.*number.value);
    out.number(at, "phase_s", mount.phase_s);
    out.array<double>(at + "/X_BS", flat({&mount.X_BS, 1}), {3, 4});
    const LaserModel& m = mount.laser;
    if (m.chart_range_m.empty()) continue;
    out.array<double>(at + "/chart_range_m", m.chart_range_m, {m.chart_range_m.size()});
    out.array<double>(at + "/chart_reflectivity", m.chart_reflectivity, {m.chart_reflectivity.size()});
  }
}

// Arrays that came to the layout later, or that only some recordings have.
bool has(const H5Reader& in, const std::string& group, const std::string& name) {
  const std::vector<std::string> there = in.names(group);
  return std::find(there.begin(), there.end(), name) != there.end();
}

Rig load_rig(const H5Reader& in) {
  Rig rig;
  rig.name = in.text("/rig", "name");
  const std::vector<std::string> names = in.names("/rig");
  rig.mounts.resize(names.size());
  std::vector<bool> seen(names.size(), false);
  for (const std::string& name : names) {
    const std::string at = "/rig/" + name;
    const std::int64_t index = in.integer(at, "index");
    if (index < 0 || index >= static_cast<std::int64_t>(names.size()) || seen[index])
      throw Error(in.file() + ": attribute 'index' at " + at + " must number the lasers from 0, each once");
    seen[index] = true;
    Mount& mount = rig.mounts[index];
    mount.name = name;
    mount.laser.name = in.text(at, "model");
    mount.laser.beams = static_cast<int>(in.integer(at, "beams"));
    mount.laser.interlace = static_cast<int>(in.integer(at, "interlace"));
    if (mount.laser.beams < 2 || mount.laser.interlace < 1)
      throw Error(in.file() + ": " + at + " needs beams >= 2 and interlace >= 1");
    for (const LaserNumber& number : laser_numbers) mount.laser.*number.value = in.number(at, number.key);
    mount.phase_s = in.number(at, "phase_s");
    mount.X_BS = poses_of(in.array<double>(at + "/X_BS", {3, 4}))[0];
    if (!has(in, at, "chart_range_m")) continue;
    const Shape points = in.shape(at + "/chart_range_m");
    mount.laser.chart_range_m = in.array<double>(at + "/chart_range_m", points);
    mount.laser.chart_reflectivity = in.array<double>(at + "/chart_reflectivity", points);
  }
  return rig;
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
  out.number(at + "/ranges_mm", "unit_mm", unit);
  out.integer(at + "/ranges_mm", "no_echo", no_echo);
  out.integer(at + "/ranges_mm", "unreadable", unreadable);
  for (const auto& [name, code] : code_names) out.integer(at + "/ranges_mm", name, -static_cast<std::int64_t>(code));
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
  return scans;
}

void save_drive(H5Writer& out, const Drive& drive) {
  out.group("/path");
  out.array<double>("/path/stamp_s", drive.path.stamp_s, {drive.path.size()});
  out.array<double>("/path/X_WB", flat(drive.path.X_WB), {drive.path.size(), 3, 4});
  out.integer("/path", "end", static_cast<std::int64_t>(drive.end));
  out.text("/path", "cause", drive.cause);
  out.number("/path", "driven_m", drive.driven_m);
  out.group("/route");
  std::vector<double> line;
  for (const Vec2& p : drive.route.line) line.insert(line.end(), {p.x(), p.y()});
  const std::vector<std::int32_t> passages(drive.route.passages.begin(), drive.route.passages.end());
  out.array<double>("/route/line", line, {drive.route.line.size(), 2});
  out.array<std::int32_t>("/route/passages", passages, {passages.size()});
  out.number("/route", "length_m", drive.route.length_m);
  if (!drive.route.backwards.empty()) {
    std::vector<std::int32_t> ends;
    for (const Route::Stretch& s : drive.route.backwards) ends.insert(ends.end(), {s.first, s.last});
    out.array<std::int32_t>("/route/backwards", ends, {drive.route.backwards.size(), 2});
  }
  const std::vector<std::int32_t> ground(drive.ground.begin(), drive.ground.end());
  if (!ground.empty()) out.array<std::int32_t>("/route/ground", ground, {ground.size()});
}

Drive load_drive(const H5Reader& in) {
  Drive drive;
  const Shape rows = in.shape("/path/stamp_s"), points = in.shape("/route/line"), count = in.shape("/route/passages");
  if (rows.size() != 1 || points.size() != 2 || count.size() != 1)
    throw Error(in.file() + ": /path/stamp_s, /route/line and /route/passages must have 1, 2 and 1 dimensions");
  drive.path.stamp_s = in.array<double>("/path/stamp_s", rows);
  drive.path.X_WB = poses_of(in.array<double>("/path/X_WB", {rows[0], 3, 4}));
  const std::int64_t end = in.integer("/path", "end");
  if (end < 0 || end > static_cast<std::int64_t>(DriveEnd::blocked))
    throw Error(in.file() + ": attribute 'end' at /path must be one of 0 to 4");
  drive.end = static_cast<DriveEnd>(end);
  drive.cause = in.text("/path", "cause");
  drive.driven_m = in.number("/path", "driven_m");
  const std::vector<double> line = in.array<double>("/route/line", {points[0], 2});
  for (size_t i = 0; i < line.size(); i += 2) drive.route.line.emplace_back(line[i], line[i + 1]);
  const auto passages = in.array<std::int32_t>("/route/passages", count);
  drive.route.passages.assign(passages.begin(), passages.end());
  drive.route.length_m = in.number("/route", "length_m");
  for (const std::string& name : in.names("/route")) {
    const Shape shape = in.shape("/route/" + name);
    if (name == "backwards" && shape.size() == 2) {
      const auto ends = in.array<std::int32_t>("/route/backwards", {shape[0], 2});
      for (size_t i = 0; i < ends.size(); i += 2) drive.route.backwards.push_back({ends[i], ends[i + 1]});
    } else if (name == "ground" && shape.size() == 1) {
      const auto ground = in.array<std::int32_t>("/route/ground", shape);
      drive.ground.assign(ground.begin(), ground.end());
    }
  }
  return drive;
}

void save_scan_truth(H5Writer& out, const Mount& mount, const ScanTruth& truth) {
  const std::string at = "/scans/" + mount.name;
  const Shape shape{truth.stamp_s.size(), static_cast<std::uint64_t>(mount.laser.beams)};
  out.group(at);
  out.array<double>(at + "/stamp_s", truth.stamp_s, {truth.stamp_s.size()});
  out.array<float>(at + "/range_m", truth.range_m, shape);
  out.array<std::uint8_t>(at + "/label", truth.label, shape);
  out.array<std::int32_t>(at + "/part", truth.part, shape);
  out.array<float>(at + "/incidence", truth.incidence_rad, shape);
  out.array<std::int32_t>(at + "/face", truth.face, shape);
  if (!truth.surfaces.empty()) out.array<std::uint8_t>(at + "/surfaces", truth.surfaces, shape);
  if (!truth.fault.empty()) out.array<std::uint8_t>(at + "/fault", truth.fault, shape);
}

ScanTruth load_scan_truth(const H5Reader& in, const Mount& mount) {
  const std::string at = "/scans/" + mount.name;
  const Shape rows = in.shape(at + "/stamp_s");
  if (rows.size() != 1) throw Error(in.file() + ": " + at + "/stamp_s must have one dimension");
  const Shape size{rows[0], static_cast<std::uint64_t>(mount.laser.beams)};
  ScanTruth truth;
  truth.stamp_s = in.array<double>(at + "/stamp_s", rows);
  truth.range_m = in.array<float>(at + "/range_m", size);
  truth.label = in.array<std::uint8_t>(at + "/label", size);
  truth.part = in.array<std::int32_t>(at + "/part", size);
  truth.incidence_rad = in.array<float>(at + "/incidence", size);
  truth.face = in.array<std::int32_t>(at + "/face", size);
  if (has(in, at, "surfaces")) truth.surfaces = in.array<std::uint8_t>(at + "/surfaces", size);
  if (has(in, at, "fault")) truth.fault = in.array<std::uint8_t>(at + "/fault", size);
  return truth;
}

void begin(H5Writer& out, const std::string& format) {
  out.text("/", "format", format);
  out.integer("/", "version", version);
}

void expect(const H5Reader& in, const std::string& format) {
  if (!in.has_attribute("/", "format")) throw Error(in.file() + ": is an HDF5 file, but not an " + format);
  const std::string found = in.text("/", "format");
  if (found != format) throw Error(in.file() + ": is an " + found + ", an " + format + " is needed");
  const std::int64_t written = in.integer("/", "version");
  if (written != version)
    throw Error(in.file() + ": has layout version " + std::to_string(written) + ", this program reads version " +
                std::to_string(version));
}

}  // namespace

void save_log(const std::string& file, const Log& log) {
  ADIT_CHECK(log.scans.size() == log.rig.mounts.size());
  check_names(log.rig, file);
  write_whole(file, [&](const std::string& temporary) {
    H5Writer out(temporary, file);
    begin(out, "adit log");
    save_rig(out, log.rig);
    out.group("/scans");
    for (size_t i = 0; i < log.scans.size(); ++i) save_scans(out, log.rig.mounts[i], log.scans[i]);
    out.close();
  });
}

Log load_log(const std::string& file) {
  const H5Reader in(file);
  expect(in, "adit log");
  Log log;
  log.rig = load_rig(in);
  for (const Mount& mount : log.rig.mounts) log.scans.push_back(load_scans(in, mount));
  return log;
}

void save_truth(const std::string& file, const Truth& truth) {
  ADIT_CHECK(truth.scans.size() == truth.rig.mounts.size());
  check_names(truth.rig, file);
  write_whole(file, [&](const std::string& temporary) {
    H5Writer out(temporary, file);
    begin(out, "adit truth");
    out.text("/", "world", truth.world);
    save_drive(out, truth.drive);
    save_rig(out, truth.rig);
    out.group("/scans");
    for (size_t i = 0; i < truth.scans.size(); ++i) save_scan_truth(out, truth.rig.mounts[i], truth.scans[i]);
    out.close();
  });
}

Truth load_truth(const std::string& file) {
  const H5Reader in(file);
  expect(in, "adit truth");
  Truth truth;
  truth.world = in.text("/", "world");
  truth.drive = load_drive(in);
  truth.rig = load_rig(in);
  for (const Mount& mount : truth.rig.mounts) truth.scans.push_back(load_scan_truth(in, mount));
  return truth;
}

}  // namespace adit
