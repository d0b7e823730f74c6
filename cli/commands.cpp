// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"

#include "base/bundled.h"
#include "base/error.h"
#include "base/files.h"
#include "cli/scenario.h"
#include "cli/stages.h"
#include "eval/render.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace adit {
namespace {

using nlohmann::ordered_json;
namespace fs = std::filesystem;

Scenario scenario_of(const std::string& name, const Common& common) {
  Scenario s = load_scenario(name, common.assignments);
  if (common.seed >= 0) s.seed = common.seed;
  return s;
}

std::string out_of(const Common& common, const std::string& name) {
  return common.out.empty() ? "out/" + name : common.out;
}

// The numbers that a person looks at first.
void print_scores(const Score& score, Console& console) {
  for (const char* name :
       {"trajectory.se3.ate_xy_rmse_m", "trajectory.se3.ate_z_rmse_m", "trajectory.open_loop.se3.ate_xy_rmse_m",
        "closures.loops_closed", "closures.loops_true", "closures.wrong", "map.se3.mae_m", "map.local_5m.mae_m",
        "grid.iou_free", "volume.observable_m3", "volume.mapped_m3", "volume.error_percent"}) {
    const Metric* m = score.find(name);
    if (!m) continue;
    char line[160];
    if (std::isfinite(m->value))
      std::snprintf(line, sizeof line, "  %-42s %12.4g %s", name, m->value, m->unit.c_str());
    else
      std::snprintf(line, sizeof line, "  %-42s %12s", name, "-");
    console.result(line);
  }
}

ordered_json json_of_file(const std::string& file) {
  return ordered_json::parse(read_text(file));
}

// The scenario that a run folder was made from; the defaults where the folder has none.
Scenario scenario_in(const std::string& out, const Common& common) {
  const std::string file = out + "/scenario.toml";
  if (fs::exists(file)) return load_scenario(file, common.assignments);
  Scenario s;
  for (const std::string& a : common.assignments) set_field(fields(s), a);
  s.name = fs::path(out).filename().string();
  return s;
}

struct RunFolder {
  Scenario scenario;
  World world;
  Recording recording;
  Estimate estimate;
  Score score;
};

RunFolder load_run(const std::string& out, const Common& common) {
  if (!fs::is_directory(out)) throw Error(out + ": no such folder; it must be the folder of a run");
  RunFolder run;
  run.scenario = scenario_in(out, common);
  run.world = load_world(out + "/world");
  run.recording.log = load_log(out + "/recording/log.h5");
  run.recording.truth = load_truth(out + "/recording/truth.h5");
  run.estimate = load_estimate(out + "/map");
  // The score's pictures need more than score.json keeps: it is computed again.
  run.score = score_map(run.world, run.recording.truth, run.recording.log.rig, run.estimate, run.scenario.score);
  return run;
}

}  // namespace

int run_command(const std::string& scenario, const Common& common, Console& console) {
  const Scenario s = scenario_of(scenario, common);
  load_vehicle(s.vehicle);
  load_rig(s.sensors.rig, s.sensors.baud);
  Stages stages(out_of(common, s.name), console);
  const World world = stages.world(s);
  const Stages::Driven driven = stages.drive(s, world);
  const Estimate estimate = stages.map(s.map, driven.recording.log);
  const Score score = stages.score(s.score, world, driven.recording.truth, driven.recording.log.rig, estimate);
  stages.report(s, world, driven.recording, estimate, score);
  stages.save_timing();
  console.result(s.name + ", seed " + std::to_string(s.seed));
  print_scores(score, console);
  console.result("report: " + stages.out() + "/report/index.html");
  if (console.wants_json())
    console.json(ordered_json{{"out", stages.out()},
                              {"drive_finished", driven.exit_code == 0},
                              {"score", json_of_file(stages.out() + "/score.json")}}
                     .dump());
  return driven.exit_code;
}

int world_command(const std::string& scenario, const Common& common, Console& console) {
  if (scenario.empty())
    throw Error("world: name a scenario, or a mesh with --check; 'adit list scenarios' shows what is bundled");
  const Scenario s = scenario_of(scenario, common);
  Stages stages(out_of(common, s.name), console);
  const World world = stages.world(s);
  stages.save_timing();
  console.result("mine: " + stages.out() + "/world");
  if (console.wants_json())
    console.json(
        ordered_json{{"out", stages.out()}, {"truth", json_of_file(stages.out() + "/world/truth.json")}}.dump());
  return 0;
}

int check_command(const std::string& mesh_file, Console& console) {
  World world;
  world.mesh = read_mesh(mesh_file);
  const WorldCheck check = check_world(world);
  console.result(mesh_file + ": " + (check.ok() ? "sound" : check.what()));
  if (console.wants_json())
    console.json(ordered_json{{"ok", check.ok()},
                              {"closed", check.closed},
                              {"oriented", check.oriented},
                              {"self_intersections", check.self_intersections},
                              {"degenerate_faces", check.degenerate_faces},
                              {"unlabelled", check.unlabelled},
                              {"volume_m3", check.volume_m3}}
                     .dump());
  return check.ok() ? 0 : 1;
}

int drive_command(const std::string& scenario, const std::string& world_dir, const Common& common, Console& console) {
  const Scenario s = scenario_of(scenario, common);
  load_vehicle(s.vehicle);
  load_rig(s.sensors.rig, s.sensors.baud);
  Stages stages(out_of(common, s.name), console);
  const World world = world_dir.empty() ? stages.world(s) : load_world(world_dir);
  const Stages::Driven driven = stages.drive(s, world);
  stages.save_timing();
  console.result("recording: " + stages.out() + "/recording");
  if (console.wants_json()) {
    const Drive& d = driven.recording.truth.drive;
    console.json(ordered_json{
        {"out", stages.out()}, {"end", drive_end_name(d.end)}, {"cause", d.cause}, {"driven_m", d.driven_m}}
                     .dump());
  }
  return driven.exit_code;
}

int map_command(const std::string& recording, const Common& common, Console& console) {
  Scenario s;
  for (const std::string& a : common.assignments) set_field(fields(s), a);
  const Log log = load_log(recording);
  Stages stages(out_of(common, fs::path(recording).stem().string()), console);
  stages.map(s.map, log);
  stages.save_timing();
  console.result("map: " + stages.out() + "/map");
  if (console.wants_json())
    console.json(ordered_json{{"out", stages.out()}, {"map", json_of_file(stages.out() + "/map/map.json")}}.dump());
  return 0;
}

int score_command(const std::string& world_dir, const std::string& truth_file, const std::string& map_dir,
                  const Common& common, Console& console) {
  Scenario s;
  for (const std::string& a : common.assignments) set_field(fields(s), a);
  const World world = load_world(world_dir);
  const Truth truth = load_truth(truth_file);
  if (truth.world != world_hash(world))
    throw Error(truth_file + ": was recorded in another mine than " + world_dir + " holds; scores would mean nothing",
                Fault::not_comparable);
  const fs::path log = fs::path(truth_file).parent_path() / "log.h5";
  const Rig nominal = fs::exists(log) ? load_log(log.string()).rig : truth.rig;
  const Estimate estimate = load_estimate(map_dir);
  const Score score = score_map(world, truth, nominal, estimate, s.score, console.progress());
  const std::string file =
      common.out.empty() ? (fs::path(map_dir).parent_path() / "score.json").string() : common.out + "/score.json";
  write_score(file, score);
  print_scores(score, console);
  console.result("scores: " + file);
  if (console.wants_json()) console.json(json_of_file(file).dump());
  return 0;
}

int report_command(const std::vector<std::string>& outs, const Common& common, Console& console) {
  ordered_json pages = ordered_json::array();
  for (const std::string& out : outs) {
    const RunFolder run = load_run(out, common);
    const std::string dir = out + "/report";
    write_report(dir,
                 {run.world, run.recording.log, run.recording.truth, run.estimate, run.score,
                  resolved_toml(run.scenario), run.scenario.name},
                 run.scenario.report, console.progress());
    console.result("report: " + dir + "/index.html");
    pages.push_back(dir + "/index.html");
  }
  console.json(ordered_json{{"pages", pages}}.dump());
  return 0;
}

int render_command(const std::string& out, const std::string& view, const Common& common, Console& console) {
  const RunFolder run = load_run(out, {"", -1, common.assignments});
  const std::string file = common.out.empty() ? view + ".png" : common.out;
  const Picture picture = render_view(view,
                                      {run.world, run.recording.log, run.recording.truth, run.estimate, run.score,
                                       resolved_toml(run.scenario), run.scenario.name},
                                      run.scenario.report);
  write_png(file, picture);
  console.result("picture: " + file);
  console.json(ordered_json{{"picture", file}}.dump());
  return 0;
}

int list_command(const std::string& what, Console& console) {
  const std::vector<std::pair<std::string, std::string>> folders{{"scenarios", "cli/scenarios"},
                                                                 {"vehicles", "sim/vehicles"},
                                                                 {"rigs", "sensors/rigs"},
                                                                 {"lasers", "sensors/lasers"}};
  ordered_json all = ordered_json::object();
  for (const auto& [kind, folder] : folders)
    if (what.empty() || what == kind) all[kind] = bundled_names(folder);
  if (what.empty() || what == "views") all["views"] = view_names();
  if (all.empty()) throw Error("list " + what + ": there are scenarios, vehicles, rigs, lasers and views");
  for (const auto& [kind, names] : all.items()) {
    console.result(kind);
    for (const auto& name : names) {
      std::string line = "  " + name.get<std::string>();
      if (kind == "scenarios")
        line += std::string(std::max<size_t>(1, 20 - line.size()), ' ') + load_scenario(name).about;
      console.result(line);
    }
  }
  console.json(all.dump());
  return 0;
}

int help_command(const std::string& topic, Console& console) {
  if (topic != "scenario") throw Error("help " + topic + ": the topics are: scenario");
  Scenario s;
  for (const Field& f : fields(s)) {
    const std::string value = to_toml({f});
    const std::string shown = value.substr(value.find(" = ") + 3);
    std::string line = f.key + " = " + shown.substr(0, shown.find('\n'));
    line += std::string(line.size() < 48 ? 48 - line.size() : 1, ' ') + f.help;
    if (!f.choices.empty()) {
      line += " (";
      for (size_t i = 0; i < f.choices.size(); ++i) line += (i ? " | " : "") + f.choices[i];
      line += ")";
    }
    console.result(line);
  }
  return 0;
}

}  // namespace adit
