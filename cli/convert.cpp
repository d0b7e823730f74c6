// SPDX-License-Identifier: BSD-3-Clause
#include "cli/convert.h"

#include "base/bag.h"
#include "base/carmen.h"
#include "base/cloud.h"
#include "base/error.h"
#include "base/h5.h"
#include "base/mine_export.h"
#include "base/parts.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>

namespace adit {
namespace {

namespace fs = std::filesystem;

enum class Format { h5, flaser, robotlaser, bag, tum, ply, pcd, folder };

Format format_of(const std::string& name) {
  const std::string ending = fs::path(name).extension().string();
  if (ending == ".h5") return Format::h5;
  if (ending == ".log") return Format::flaser;
  if (ending == ".clf") return Format::robotlaser;
  if (ending == ".bag") return Format::bag;
  if (ending == ".tum") return Format::tum;
  if (ending == ".ply") return Format::ply;
  if (ending == ".pcd") return Format::pcd;
  if (ending.empty()) return Format::folder;
  throw Error(name + ": '" + ending +
              "' is no format that adit knows; it knows .h5, .log and .clf (CARMEN), .bag (ROS 1), " +
              ".tum, .ply, .pcd, and a folder (SemanticKITTI)");
}

// What a file holds; each format has a part of it.
struct Content {
  std::optional<Log> log;
  std::optional<Truth> truth;
  std::optional<Trajectory> path;
  std::optional<PointCloud> points;
  std::vector<std::string> notes;  // what was left out of it
};

Content read_h5(const std::string& file, std::string truth_file) {
  Content c;
  if (const H5Reader in(file); in.has_attribute("/", "format") && in.text("/", "format") == "adit truth") {
    c.truth = load_truth(file);
  } else {
    c.log = load_log(file);
    if (truth_file.empty() && fs::exists(fs::path(file).parent_path() / "truth.h5"))
      truth_file = (fs::path(file).parent_path() / "truth.h5").string();
    if (!truth_file.empty()) c.truth = load_truth(truth_file);
  }
  if (c.truth) c.path = c.truth->drive.path;
  return c;
}

Content read_content(const std::string& file, const std::string& truth_file) {
  Content c;
  switch (format_of(file)) {
    case Format::h5:
      return read_h5(file, truth_file);
    case Format::flaser:
    case Format::robotlaser: {
      CarmenLog carmen = read_carmen(file);
      c.log = std::move(carmen.log);
      if (!carmen.true_path.empty()) c.path = std::move(carmen.true_path);
      c.notes = std::move(carmen.notes);
      return c;
    }
    case Format::bag: {
      BagLog bag = read_bag(file);
      c.log = std::move(bag.log);
      if (!bag.path.empty()) c.path = std::move(bag.path);
      c.notes = std::move(bag.notes);
      return c;
    }
    case Format::tum:
      c.path = read_tum(file);
      return c;
    case Format::ply:
      c.points = read_points(file);
      return c;
    case Format::pcd:
      c.points = read_pcd(file);
      return c;
    case Format::folder:
      throw Error(file + ": holds no log-NNNN.h5 of a drive; other folders are written, not read; name a file");
  }
  return c;
}

template <class T>
const T& needed(const std::optional<T>& part, const std::string& what, const std::string& from, const std::string& to) {
  if (!part) throw Error(to + ": needs " + what + ", and " + from + " has none");
  return *part;
}

void write_content(const Content& c, const std::string& from, const std::string& to, size_t every) {
  const auto log = [&]() -> const Log& { return needed(c.log, "scans", from, to); };
  const auto truth = [&]() -> const Truth& {
    return needed(c.truth, "the truth (truth.h5 beside it, or --truth)", from, to);
  };
  const auto points = [&] { return c.points ? *c.points : true_cloud(log(), truth(), every).points; };
  switch (format_of(to)) {
    case Format::h5:
      return save_log(to, log());
    case Format::flaser:
      return write_carmen(to, log(), CarmenStyle::flaser, c.truth ? &*c.truth : nullptr);
    case Format::robotlaser:
      return write_carmen(to, log(), CarmenStyle::robotlaser, c.truth ? &*c.truth : nullptr);
    case Format::bag:
      return write_bag(to, log(), c.truth ? &*c.truth : nullptr);
    case Format::tum:
      return write_tum(to, needed(c.path, "a path", from, to));
    case Format::ply:
      return write_points(to, points());
    case Format::pcd:
      return write_pcd(to, points());
    case Format::folder:
      write_kitti(to, log(), truth());
  }
}

// A folder of parts that a killed drive left: the log, and the truth beside it.
int join_command(const std::string& from, const std::string& to, Console& console) {
  if (format_of(to) != Format::h5) throw Error(to + ": parts are joined to a file.h5; convert that");
  const Parts parts = find_parts(from);
  for (const std::string& note : parts.notes) console.note(note);
  const std::string truth = (fs::path(to).parent_path() / "truth.h5").string();
  if (truth == to) throw Error(to + ": is where the truth goes; give the log another name, such as log.h5");
  nlohmann::ordered_json written{{"from", from}, {"to", to}, {"parts", parts.logs.size()}, {"notes", parts.notes}};
  if (!parts.truths.empty()) {
    join_truths(truth, parts.truths);
    console.result("written: " + truth);
    written["truth"] = truth;
  }
  join_logs(to, parts.logs);
  console.result("written: " + to + ", of " + std::to_string(parts.logs.size()) + " parts");
  console.json(written.dump());
  return 0;
}

bool is_world(const std::string& name) {
  return fs::exists(name + "/truth.json") && fs::exists(name + "/mine.ply");
}

// A mine's folder, in the formats of other programs.
int world_convert(const std::string& from, const std::string& to, Console& console) {
  constexpr double per_m2 = 200;  // of a cloud: a point in 7 cm
  const std::string ending = fs::path(to).extension().string();
  if (!ending.empty() && ending != ".obj" && ending != ".sdf" && ending != ".json" && ending != ".ply")
    throw Error(to +
                ": of a mine adit writes .obj, .sdf (Gazebo), .json (instances), .ply (labelled cloud) and a folder "
                "(SemanticKITTI)");
  const World world = load_world(from);
  if (ending == ".obj")
    write_obj(to, world);
  else if (ending == ".sdf")
    write_sdf(to, world);
  else if (ending == ".json")
    write_instances(to, world);
  else if (ending == ".ply")
    write_labelled_ply(to, surface_cloud(world, per_m2));
  else
    write_kitti_frame(to, surface_cloud(world, per_m2));
  console.result("written: " + to);
  console.json(nlohmann::ordered_json{{"from", from}, {"to", to}}.dump());
  return 0;
}

}  // namespace

Log load_any_log(const std::string& file, Console& console) {
  const std::string ending = fs::path(file).extension().string();
  if (ending != ".log" && ending != ".clf" && ending != ".bag") return load_log(file);
  Content c = read_content(file, "");
  for (const std::string& note : c.notes) console.note(note);
  return std::move(*c.log);
}

void write_any_log(const std::string& file, const Log& log) {
  Content c;
  c.log = log;
  write_content(c, "a log alone", file, 1);
}

int convert_command(const std::string& from, const std::string& to, const std::string& truth_file, int every,
                    Console& console) {
  if (is_world(from)) return world_convert(from, to, console);
  format_of(to);  // a bad name is said before a long read
  if (is_parts(from)) return join_command(from, to, console);
  const Content content = read_content(from, truth_file);
  for (const std::string& note : content.notes) console.note(note);
  write_content(content, from, to, static_cast<size_t>(every));
  console.result("written: " + to);
  console.json(nlohmann::ordered_json{{"from", from}, {"to", to}, {"notes", content.notes}}.dump());
  return 0;
}

}  // namespace adit
