// SPDX-License-Identifier: BSD-3-Clause
#include "cli/commands.h"

#include "base/bundled.h"
#include "base/damaged_estimate.h"
#include "base/error.h"
#include "base/files.h"
#include "cli/convert.h"
#include "cli/scenario.h"
#include "cli/scores.h"
#include "cli/set_command.h"
#include "cli/stages.h"
#include "cli/study_file.h"
#include "cli/suite.h"
#include "eval/compare.h"
#include "eval/compare_page.h"
#include "eval/explain.h"
#include "eval/render.h"
#include "mapper/certificate.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

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

ordered_json json_of_file(const std::string& file) {
  return ordered_json::parse(read_text(file));
}

// A run folder as `adit compare` sees it; without a score.json the run failed.
ScoredRun scored_run(const std::string& out) {
  if (!fs::exists(out + "/scenario.toml"))
    throw Error(out + ": no scenario.toml in it; it must be the folder of a run");
  ScoredRun run;
  run.folder = out;
  Scenario s = load_scenario(out + "/scenario.toml");
  run.seed = s.seed;
  s.seed = 0;
  run.settings = resolved_toml(s);
  if (fs::exists(out + "/score.json")) run.score = read_score(out + "/score.json");
  return run;
}

void print_graph(const SolvedGraph& g, Console& console) {
  const Certificate& c = g.certificate;
  console.result(std::to_string(g.graph.node.size()) + " nodes, " + std::to_string(g.graph.edge.size()) +
                 " edges, from the " + g.start + " start: chi2 " + std::to_string(g.chi2) + " after " +
                 std::to_string(g.iterations) + " iterations" + (g.converged ? "" : ", not converged"));
  console.result("isotropic objective " + std::to_string(c.objective) + ", " + verdict(c));
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
  std::vector<std::string> missing;

  ReportInput input() const {
    return {world, recording.log, recording.truth, estimate, score, resolved_toml(scenario), scenario.name, missing};
  }
};

// The score's pictures need more than score.json keeps: it is computed again. Of a map that has lost files the numbers
// are still those of score.json, which was made of the whole.
void score_again(RunFolder& run, const std::string& file, bool whole) {
  run.score = score_map(run.world, run.recording.truth, run.recording.log.rig, run.estimate, run.scenario.score);
  if (whole) return;
  run.missing.push_back("the score of the whole map: pictures and worst places are of what is left of it");
  if (!fs::exists(file)) return;
  run.score.metrics = read_score(file).metrics;
  run.missing.back() += "; the numbers are those of score.json";
}

// What of a run's folder is there and can be read; `missing` says what is not.
RunFolder load_run(const std::string& out, const Common& common) {
  if (!fs::is_directory(out)) throw Error(out + ": no such folder; it must be the folder of a run");
  RunFolder run;
  run.scenario = scenario_in(out, common);
  int parts = 0;
  const auto load = [&](const std::string& what, const std::string& file, const auto& read) {
    if (!fs::exists(out + "/" + file)) {
      run.missing.push_back(what + ": there is no " + file);
      return;
    }
    try {
      read(out + "/" + file);
      ++parts;
    } catch (const Error& e) {
      run.missing.push_back(what + ": " + e.what());
    }
  };
  load("the mine", "world", [&](const std::string& dir) { run.world = load_world(dir); });
  load("the recording", "recording/log.h5", [&](const std::string& file) { run.recording.log = load_log(file); });
  load("the truth", "recording/truth.h5", [&](const std::string& file) { run.recording.truth = load_truth(file); });
  std::vector<std::string> damaged;
  load("the map", "map", [&](const std::string& dir) { run.estimate = load_what_is_whole(dir, damaged); });
  for (const std::string& file : damaged) run.missing.push_back("of the map: " + file);
  if (parts == 4 && !run.estimate.path.empty()) {
    load("the score", "world", [&](const std::string&) { score_again(run, out + "/score.json", damaged.empty()); });
    return run;
  }
  load("the score", "score.json", [&](const std::string& file) { run.score = read_score(file); });
  if (parts == 0) throw Error(out + ": it holds nothing of a run (" + run.missing.front() + ")");
  return run;
}

}  // namespace

int run_command(const std::string& scenario, const Common& common, Console& console) {
  const Scenario s = scenario_of(scenario, common);
  load_vehicle(s.vehicle);
  load_rig(s.sensors);
  Stages stages(out_of(common, s.name), console);
  const World world = stages.world(s);
  Recording recording;
  const Stages::Driven driven = stages.drive(s, world, &recording);
  const std::optional<Estimate> estimate = stages.map(s, recording.log);
  if (!estimate) {
    stages.save_timing();
    return 1;
  }
  const Score score = stages.score(s.score, world, recording.truth, recording.log.rig, *estimate);
  stages.report(s, world, recording, *estimate, score);
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
  if (s.world.tile_m > 0)
    stages.world_in_parts(s);
  else
    stages.pictures(stages.world(s));
  stages.save_timing();
  console.result("mine: " + stages.out() + "/world");
  if (console.wants_json())
    console.json(
        ordered_json{{"out", stages.out()}, {"truth", json_of_file(stages.out() + "/world/truth.json")}}.dump());
  return 0;
}

int check_command(const std::string& given, Console& console) {
  const bool folder = fs::is_directory(given);
  World world;
  if (folder)
    world = load_world(given);
  else
    world.mesh = read_mesh(given);
  const WorldCheck check = check_world(world);
  const std::vector<std::string> faults = folder ? check_truth(world) : std::vector<std::string>{};
  const bool ok = check.ok() && faults.empty();
  console.result(given + ": " +
                 (ok           ? "sound"
                  : check.ok() ? "the mesh is sound, the truth does not fit it"
                               : check.what()));
  for (const std::string& fault : faults) console.result("  " + fault);
  if (console.wants_json())
    console.json(ordered_json{
        {"ok", ok},
        {"faces", world.mesh.face.size()},
        {"closed", check.closed},
        {"open_edges", check.open_edges},
        {"oriented", check.oriented},
        {"self_intersections", check.self_intersections},
        {"degenerate_faces", check.degenerate_faces},
        {"pinched_vertices", check.pinched_vertices},
        {"unlabelled", check.unlabelled},
        {"volume_m3", check.volume_m3},
        {"truth",
         faults}}.dump());
  return ok ? 0 : 1;
}

int drive_command(const std::string& scenario, const std::string& world_dir, const Common& common, Console& console) {
  const Scenario s = scenario_of(scenario, common);
  load_vehicle(s.vehicle);
  load_rig(s.sensors);
  Stages stages(out_of(common, s.name), console);
  const World world = world_dir.empty() ? stages.world(s) : load_world(world_dir);
  const Stages::Driven driven = stages.drive(s, world, nullptr);
  stages.save_timing();
  console.result("recording: " + stages.out() + "/recording");
  if (console.wants_json()) {
    const Drive& d = driven.drive;
    console.json(ordered_json{
        {"out", stages.out()}, {"end", drive_end_name(d.end)}, {"cause", d.cause}, {"driven_m", d.driven_m}}
                     .dump());
  }
  return driven.exit_code;
}

int map_command(const std::string& recording, const Common& common, Console& console) {
  Scenario s;
  for (const std::string& a : common.assignments) set_field(fields(s), a);
  Stages stages(out_of(common, fs::path(recording).stem().string()), console);
  bool mapped = true;
  if (const std::string ending = fs::path(recording).extension().string(); ending == ".g2o" || ending == ".graph")
    print_graph(stages.map(s.map, read_g2o(recording)), console);
  else
    mapped = stages.map(s, load_any_log(recording, console)).has_value();
  stages.save_timing();
  if (!mapped) return 1;
  console.result("map: " + stages.out() + "/map");
  if (console.wants_json())
    console.json(ordered_json{{"out", stages.out()}, {"map", json_of_file(stages.out() + "/map/map.json")}}.dump());
  return 0;
}

int compare_command(const std::vector<std::string>& outs, const Common& common, Console& console) {
  std::vector<ScoredRun> runs;
  for (const std::string& out : outs) runs.push_back(scored_run(out));
  const Comparison comparison = compare_runs(runs, headline_metrics());
  console.result(comparison_table(comparison, headline_metrics()));
  const std::string file = (common.out.empty() ? "." : common.out) + "/comparison.json";
  write_comparison(file, comparison);
  console.result("comparison: " + file);
  if (console.wants_json()) console.json(json_of_file(file).dump());
  return 0;
}

namespace {

// Where the page of a run lies as seen from a folder; "" where there is none.
std::string link_to(const std::string& run, const std::string& from) {
  const fs::path page = fs::path(run) / "report/index.html";
  return fs::exists(page) ? fs::proximate(page, from).generic_string() : "";
}

// Several runs on one page.
int report_side_by_side(const std::vector<std::string>& outs, const Common& common, Console& console) {
  SideBySide all;
  for (const std::string& out : outs) all.runs.push_back(scored_run(out));
  all.comparison = compare_runs(all.runs, headline_metrics());
  all.headline = headline_metrics();
  const std::vector<size_t> shown = shown_runs(all.runs, all.comparison);
  for (size_t g = 0; g < shown.size(); ++g) {
    console.progress()("report: plans", static_cast<double>(g), static_cast<double>(shown.size()));
    Plate plate;
    PathErrors path;
    if (shown[g] < outs.size()) {
      const RunFolder run = load_run(outs[shown[g]], {"", -1, common.assignments});
      ReportSettings settings = run.scenario.report;
      settings.range_m = common_range_m(all.runs);
      plate = plan_plate(run.input(), settings);
      path = path_errors(run.score, all.runs[shown[g]].seed);
    } else {
      plate.figure.missing = "none of its runs was scored";
    }
    all.plans.push_back(std::move(plate));
    all.paths.push_back(std::move(path));
  }
  const std::string dir = common.out.empty() ? "comparison" : common.out, file = dir + "/index.html";
  std::vector<std::string> links;
  for (const std::string& out : outs) links.push_back(link_to(out, dir));
  write_text(file, comparison_html(all, links));
  console.result("report: " + file);
  console.json(ordered_json{{"pages", {file}}}.dump());
  return 0;
}

std::optional<Viewpoint> viewpoint_of(const ViewWords& words) {
  if (words.eye.empty() && words.target.empty()) return {};
  if (words.eye.size() != 3 || words.target.size() != 3)
    throw Error("a viewpoint needs both --eye X,Y,Z and --target X,Y,Z, three numbers each, in metres");
  return Viewpoint{Vec3(words.eye[0], words.eye[1], words.eye[2]),
                   Vec3(words.target[0], words.target[1], words.target[2]), words.fov_deg * std::acos(-1.0) / 180};
}

}  // namespace

int report_command(const std::vector<std::string>& outs, const Common& common, Console& console) {
  if (outs.size() > 1) return report_side_by_side(outs, common, console);
  const RunFolder run = load_run(outs[0], common);
  const std::string dir = common.out.empty() ? outs[0] + "/report" : common.out, file = dir + "/index.html";
  write_report(dir, run.input(), run.scenario.report, console.progress());
  for (const std::string& m : run.missing) console.result("missing: " + m);
  console.result("report: " + file);
  console.json(ordered_json{{"pages", {file}}, {"missing", run.missing}}.dump());
  return 0;
}

int render_command(const std::string& out, const std::string& view, const ViewWords& words, const Common& common,
                   Console& console) {
  const std::optional<Viewpoint> viewpoint = viewpoint_of(words);
  const RunFolder run = load_run(out, {"", -1, common.assignments});
  const std::string file = common.out.empty() ? view + ".png" : common.out;
  write_text(file, render_png(view, run.input(), run.scenario.report, viewpoint));
  console.result("picture: " + file);
  console.json(ordered_json{{"picture", file}}.dump());
  return 0;
}

int list_command(const std::string& what, Console& console) {
  const std::vector<std::pair<std::string, std::string>> folders{
      {"scenarios", "cli/scenarios"}, {"suites", "cli/suites"}, {"studies", "cli/studies"},
      {"vehicles", "sim/vehicles"},   {"rigs", "sensors/rigs"}, {"lasers", "sensors/lasers"}};
  ordered_json all = ordered_json::object();
  for (const auto& [kind, folder] : folders)
    if (what.empty() || what == kind) all[kind] = bundled_names(folder);
  if (what.empty() || what == "views") all["views"] = view_names();
  if (what.empty() || what == "metrics") all["metrics"] = defined_metrics();
  if (all.empty())
    throw Error("list " + what + ": there are scenarios, suites, studies, vehicles, rigs, lasers, views and metrics");
  for (const auto& [kind, names] : all.items()) {
    console.result(kind);
    for (const auto& name : names) {
      std::string line = "  " + name.get<std::string>();
      if (kind == "scenarios")
        line += std::string(std::max<size_t>(1, 20 - line.size()), ' ') + load_scenario(name).about;
      if (kind == "studies") line += std::string(std::max<size_t>(1, 20 - line.size()), ' ') + load_study(name).about;
      console.result(line);
    }
  }
  console.json(all.dump());
  return 0;
}

int help_command(const std::string& topic, Console& console) {
  Scenario s;
  MineSet set;
  Study study;
  Suite suite;
  const std::map<std::string, Fields> topics = {
      {"scenario", fields(s)}, {"set", fields(set)}, {"study", study_fields(study)}, {"suite", suite_fields(suite)}};
  const auto of_topic = topics.find(topic);
  if (of_topic == topics.end()) throw Error("help " + topic + ": the topics are: scenario, set, study, suite");
  for (const Field& f : of_topic->second) {
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
