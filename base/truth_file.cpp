// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/recording.h"
#include "base/rig_file.h"

namespace adit {
namespace {

// All but the poses.
void explain_drive(H5Writer& out, const Drive& drive) {
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
  if (end < 0 || end > static_cast<std::int64_t>(DriveEnd::underway))
    throw Error(in.file() + ": attribute 'end' at /path must be one of 0 to 5");
  drive.end = static_cast<DriveEnd>(end);
  drive.cause = in.text("/path", "cause");
  drive.driven_m = in.number("/path", "driven_m");
  const std::vector<double> line = in.array<double>("/route/line", {points[0], 2});
  for (size_t i = 0; i < line.size(); i += 2) drive.route.line.emplace_back(line[i], line[i + 1]);
  const auto passages = in.array<std::int32_t>("/route/passages", count);
  drive.route.passages.assign(passages.begin(), passages.end());
  drive.route.length_m = in.number("/route", "length_m");
  if (has_array(in, "/route", "backwards")) {
    const auto ends = in.array<std::int32_t>("/route/backwards", {in.shape("/route/backwards").at(0), 2});
    for (size_t i = 0; i < ends.size(); i += 2) drive.route.backwards.push_back({ends[i], ends[i + 1]});
  }
  if (has_array(in, "/route", "ground")) {
    const auto ground = in.array<std::int32_t>("/route/ground", {in.shape("/route/ground").at(0)});
    drive.ground.assign(ground.begin(), ground.end());
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
  if (!truth.passage.empty()) out.array<std::int32_t>(at + "/passage", truth.passage, shape);
  if (!truth.surfaces.empty()) out.array<std::uint8_t>(at + "/surfaces", truth.surfaces, shape);
  if (!truth.fault.empty()) out.array<std::uint8_t>(at + "/fault", truth.fault, shape);
  if (!truth.tilt_rad.empty()) out.array<double>(at + "/tilt", truth.tilt_rad, {truth.stamp_s.size()});
}

void join_scan_truth(H5Writer& out, Pieces& from, const Mount& mount) {
  const std::string at = "/scans/" + mount.name;
  out.group(at);
  from.join<double>(out, at, "stamp_s");
  from.join<float>(out, at, "range_m");
  from.join<std::uint8_t>(out, at, "label");
  from.join<std::int32_t>(out, at, "part");
  from.join<float>(out, at, "incidence");
  from.join<std::int32_t>(out, at, "face");
  const auto there = [&](const char* name) { return from.has(at, name); };
  if (there("passage")) from.join<std::int32_t>(out, at, "passage");
  if (there("surfaces")) from.join<std::uint8_t>(out, at, "surfaces");
  if (there("fault")) from.join<std::uint8_t>(out, at, "fault");
  if (there("tilt")) from.join<double>(out, at, "tilt");
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
  if (has_array(in, at, "passage")) truth.passage = in.array<std::int32_t>(at + "/passage", size);
  if (has_array(in, at, "surfaces")) truth.surfaces = in.array<std::uint8_t>(at + "/surfaces", size);
  if (has_array(in, at, "fault")) truth.fault = in.array<std::uint8_t>(at + "/fault", size);
  if (has_array(in, at, "tilt")) truth.tilt_rad = in.array<double>(at + "/tilt", rows);
  return truth;
}

void write_file(const std::string& file, const Truth& truth, Packing packing,
                const std::function<void(H5Writer&)>& poses, const std::function<void(H5Writer&)>& scans) {
  check_names(truth.rig, file);
  write_whole(file, [&](const std::string& temporary) {
    H5Writer out(temporary, file, packing);
    begin_file(out, "adit truth");
    out.text("/", "world", truth.world);
    out.group("/path");
    poses(out);
    explain_drive(out, truth.drive);
    save_rig(out, truth.rig);
    out.group("/scans");
    scans(out);
    out.close();
  });
}

// All but the scans.
Truth load_head(const H5Reader& in) {
  expect_format(in, "adit truth");
  Truth truth;
  truth.world = in.text("/", "world");
  truth.drive = load_drive(in);
  truth.rig = load_rig(in);
  return truth;
}

}  // namespace

void save_truth(const std::string& file, const Truth& truth, Packing packing) {
  ADIT_CHECK(truth.scans.size() == truth.rig.mounts.size());
  const Trajectory& path = truth.drive.path;
  write_file(
      file, truth, packing,
      [&](H5Writer& out) {
        out.array<double>("/path/stamp_s", path.stamp_s, {path.size()});
        out.array<double>("/path/X_WB", flat(path.X_WB), {path.size(), 3, 4});
      },
      [&](H5Writer& out) {
        for (size_t i = 0; i < truth.scans.size(); ++i) save_scan_truth(out, truth.rig.mounts[i], truth.scans[i]);
      });
}

void join_truths(const std::string& file, const std::vector<std::string>& pieces) {
  Pieces from(pieces);
  ADIT_CHECK(from.size() > 0);
  Truth head = load_head(from.at(0));
  head.drive = load_drive(from.at(from.size() - 1));  // how it ended
  write_file(
      file, head, Packing::small,
      [&](H5Writer& out) {
        from.join<double>(out, "/path", "stamp_s");
        from.join<double>(out, "/path", "X_WB");
      },
      [&](H5Writer& out) {
        for (const Mount& mount : head.rig.mounts) join_scan_truth(out, from, mount);
      });
}

Truth load_truth(const std::string& file) {
  const H5Reader in(file);
  Truth truth = load_head(in);
  for (const Mount& mount : truth.rig.mounts) truth.scans.push_back(load_scan_truth(in, mount));
  return truth;
}

}  // namespace adit
