// SPDX-License-Identifier: BSD-3-Clause
#include "cli/stages.h"

#include "base/error.h"
#include "base/files.h"
#include "base/parts.h"
#include "base/relay.h"
#include "base/world_writer.h"
#include "cli/peak_memory.h"
#include "eval/mine_views.h"
#include "eval/trouble.h"

#include <nlohmann/json.hpp>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

namespace adit {
namespace {

namespace fs = std::filesystem;

std::string with_unit(double value, const char* unit, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f %s", digits, value, unit);
  return text;
}

}  // namespace

Stages::Stages(std::string out, Console& console) : out_(std::move(out)), console_(console) {}

void Stages::timed(const std::string& stage, const std::function<void()>& work) {
  console_.note(stage);
  restart_peak();
  const auto began = std::chrono::steady_clock::now();
  work();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  times_.push_back({stage, seconds, peak_gib()});
}

void Stages::forget(const std::vector<std::string>& later) const {
  for (const std::string& part : later) {
    std::error_code failed;
    fs::remove_all(fs::path(out_) / part, failed);
    if (failed)
      throw Error(out_ + "/" + part + ": cannot remove what an earlier run made: " + failed.message(), Fault::file);
  }
}

namespace {

void demand_sound(std::int64_t seed, const WorldCheck& check, const std::vector<std::string>& faults) {
  if (!check.ok()) throw Error("the mine of seed " + std::to_string(seed) + " is broken: " + check.what(), Fault::bug);
  if (!faults.empty())
    throw Error("the truth of seed " + std::to_string(seed) + " does not fit its mesh: " + faults.front(), Fault::bug);
}

std::string summary(const World& world, size_t triangles) {
  return "  " + std::to_string(triangles) + " triangles, " + std::to_string(world.pillars.size()) + " pillars, " +
         std::to_string(world.numbers.loops) + " loops, void of " + with_unit(world.numbers.volume_m3, "m3", 1);
}

void note_left_out(const World& world, Console& console) {
  std::string list;
  for (const auto& [label, n] : world.left_out)
    list += (list.empty() ? "" : ", ") + std::to_string(n) + " " + label_name(label);
  if (!list.empty()) console.note("  asked for, and had no room or lay under a fall: " + list);
}

}  // namespace

World sound_world(const Scenario& s, const Progress& progress) {
  World world = make_world(s.world, static_cast<std::uint64_t>(s.seed), progress);
  world.name = s.name;
  demand_sound(s.seed, check_world(world), check_truth(world));
  return world;
}

World Stages::world(const Scenario& s) {
  World world;
  timed("world", [&] {
    world = sound_world(s, console_.progress());
    plan_route(world, s.route,
               static_cast<std::uint64_t>(s.seed));  // a route that cannot be is said before files change
    write_text(out_ + "/scenario.toml", resolved_toml(s));
    save_world(out_ + "/world", world);
    save_plan(out_ + "/world", world);
    forget({"recording", "map", "external", "score.json", "report"});
  });
  console_.note(summary(world, world.mesh.face.size()));
  note_left_out(world, console_);
  return world;
}

void Stages::world_in_parts(const Scenario& s) {
  World world;
  Mesh largest;  // of the parts: the one that is looked into
  size_t triangles = 0;
  timed("world", [&] {
    WorldWriter writer(out_ + "/world");
    PartsCheck check;
    const auto take = [&](MinePart&& part) {
      check.add(part);
      writer.add(part.mesh, part.vertex_id);
      triangles += part.mesh.face.size();
      if (part.mesh.face.size() > largest.face.size()) largest = std::move(part.mesh);
    };
    world = make_parts(s.world, static_cast<std::uint64_t>(s.seed), take, console_.progress());
    world.name = s.name;
    demand_sound(s.seed, check.finish(), check_truth(world, check.tally()));
    write_text(out_ + "/scenario.toml", resolved_toml(s));
    writer.close(world);
    forget({"recording", "map", "score.json", "report"});
  });
  timed("plan", [&] { save_plan(out_ + "/world", world); });
  console_.note(summary(world, triangles));
  note_left_out(world, console_);
  world.mesh = std::move(largest);
  pictures(world);
}

void Stages::pictures(const World& world) {
  timed("pictures", [&] {
    for (const MineView& view : mine_views(world)) write_png(out_ + "/world/" + view.name + ".png", view.picture);
  });
}

Stages::Driven Stages::drive(const Scenario& s, const World& world, Recording* keep) {
  Driven driven{};
  timed("drive", [&] {
    const Vehicle vehicle = load_vehicle(s.vehicle);
    const Rig rig = load_rig(s.sensors);
    driven.drive = stream(s, world, rig, vehicle, keep);
    driven.exit_code = driven.drive.end == DriveEnd::finished ? 0 : 1;
    forget({"recording/trouble.png", "map", "external", "score.json", "report"});
    if (driven.exit_code != 0)
      write_png(out_ + "/recording/trouble.png", trouble_picture(world, driven.drive, vehicle.hull));
  });
  const Drive& d = driven.drive;
  const double minutes = d.path.empty() ? 0 : d.path.stamp_s.back() / 60;
  console_.note("  drove " + with_unit(d.driven_m, "m", 0) + " of " + with_unit(d.route.length_m, "m", 0) + " in " +
                with_unit(minutes, "min", 1));
  if (driven.exit_code != 0)
    console_.note("  the drive ended early (" + drive_end_name(d.end) + "): " + d.cause + "; see " + out_ +
                  "/recording/trouble.png");
  return driven;
}

// The vehicle drives on a thread of its own while what its lasers saw is told to OUT/recording/parts, and from there to
// log.h5 and truth.h5.
Drive Stages::stream(const Scenario& s, const World& world, const Rig& rig, const Vehicle& vehicle, Recording* keep) {
  constexpr double part_s = 60;
  const auto seed = static_cast<std::uint64_t>(s.seed);
  const Route route = plan_route(world, s.route, seed);
  const std::string dir = out_ + "/recording/parts";
  remove_parts(dir);  // of a drive that was killed
  std::vector<std::string> logs, truths;
  Recorder recorder(world, rig, vehicle.hull, s.sensors, seed, part_s, [&](Recording&& piece) {
    const size_t n = logs.size();
    save_part(dir, n, piece.log, piece.truth);
    logs.push_back(part_log(dir, n));
    truths.push_back(part_truth(dir, n));
    if (!keep) return;
    if (n == 0)
      *keep = std::move(piece);
    else
      append(*keep, piece);
  });
  Drive driven;
  relay<Drive>(
      12,
      [&](const std::function<void(Drive &&)>& give) {
        driven = adit::drive(world, route, vehicle, s.drive, seed, give, console_.progress());
      },
      [&](Drive&& stretch) { recorder.add(stretch); });
  write_text(out_ + "/scenario.toml", resolved_toml(s));
  join_truths(out_ + "/recording/truth.h5", truths);
  join_logs(out_ + "/recording/log.h5", logs);
  remove_parts(dir);
  return driven;
}

std::optional<Estimate> Stages::map(const Scenario& s, const Log& log) {
  std::optional<Estimate> estimate;
  std::string failure;
  timed("map", [&] {
    if (s.external.command.empty()) {
      estimate = make_map(log, s.map, console_.progress());
      forget({"external", "score.json", "report"});
    } else {
      ExternalRun run = run_external(s.external, log, s.seed, out_ + "/external", console_.progress());
      estimate = std::move(run.estimate);
      failure = std::move(run.failure);
      forget({"map", "score.json", "report"});
    }
    if (!estimate) return;
    save_estimate(out_ + "/map", *estimate);
    estimate = load_estimate(out_ + "/map");  // judged as its files tell it, so that they can be judged again
  });
  if (!estimate) console_.note("  the mapper '" + s.external.command[0] + "' failed: " + failure);
  if (estimate)
    for (const std::string& n : estimate->notes) console_.note("  " + n);
  return estimate;
}

SolvedGraph Stages::map(const MapSettings& settings, const GraphFile& graph) {
  SolvedGraph solved;
  timed("map", [&] {
    solved = solve_graph(graph, settings.graph, console_.progress());
    save_graph(out_ + "/map", solved);
    forget({"score.json", "report"});
  });
  return solved;
}

Score Stages::score(const ScoreSettings& settings, const World& world, const Truth& truth, const Rig& nominal,
                    const Estimate& estimate) {
  Score score;
  timed("score", [&] {
    score = score_map(world, truth, nominal, estimate, settings, console_.progress());
    write_score(out_ + "/score.json", score);
    forget({"report"});
  });
  return score;
}

void Stages::report(const Scenario& s, const World& world, const Recording& recording, const Estimate& estimate,
                    const Score& score) {
  timed("report", [&] {
    write_report(out_ + "/report", {world, recording.log, recording.truth, estimate, score, resolved_toml(s), s.name},
                 s.report, console_.progress());
  });
}

void Stages::save_timing() const {
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  double total = 0;
  for (const Timed& t : times_) {
    stages[t.stage] = {{"seconds", t.seconds}, {"peak_gib", t.peak_gib}};
    total += t.seconds;
  }
  write_text(out_ + "/timing.json", nlohmann::ordered_json{{"stages", stages}, {"seconds", total}}.dump(2) + "\n");
}

}  // namespace adit
