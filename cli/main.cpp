// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "cli/commands.h"
#include "cli/convert.h"
#include "cli/nightly_command.h"
#include "cli/rig_command.h"
#include "cli/set_command.h"
#include "cli/stats_command.h"
#include "cli/study_command.h"

#include <CLI/CLI.hpp>

#include <csignal>
#include <cstdio>
#include <exception>
#include <new>
#include <string>
#include <vector>

namespace {

// What the command line said.
struct Words {
  adit::Common common;
  bool quiet = false, json = false;
  int threads = 0, every = 1;
  std::string first, second, world, truth, check, stats, shard;
  adit::ScoreInput score;
  adit::NightlyInput nightly;
  adit::ViewWords view;
  std::vector<std::string> outs;
};

void add_common(CLI::App* command, Words& w, bool seeds) {
  command->add_option("-o,--out", w.common.out, "where the results go");
  if (seeds) command->add_option("--seed", w.common.seed, "of all chance")->check(CLI::Range(0, 2147483647));
  command->add_option("--set", w.common.assignments, "key=value of the scenario, may be repeated")->take_all();
  command->add_option("--threads", w.threads, "0 = all cores")->check(CLI::Range(0, 1024));
  command->add_flag("--quiet", w.quiet, "say nothing but errors");
  command->add_flag("--json", w.json, "one JSON object on stdout, nothing else there");
}

int dispatch(CLI::App& app, const Words& w) {
  using namespace adit;
  Console console(w.quiet, w.json);
  set_threads(w.threads);
  if (app.got_subcommand("run")) return run_command(w.first, w.common, console);
  if (app.got_subcommand("world") && !w.stats.empty()) return stats_command(w.stats, w.common.out, console);
  if (app.got_subcommand("world") && is_set(w.first)) return set_command(w.first, w.common, console);
  if (app.got_subcommand("world"))
    return w.check.empty() ? world_command(w.first, w.common, console) : check_command(w.check, console);
  if (app.got_subcommand("drive")) return drive_command(w.first, w.world, w.common, console);
  if (app.got_subcommand("map")) return map_command(w.first, w.common, console);
  if (app.got_subcommand("score")) return score_command(w.score, w.common, console);
  if (app.got_subcommand("compare")) return compare_command(w.outs, w.common, console);
  if (app.got_subcommand("report")) return report_command(w.outs, w.common, console);
  if (app.got_subcommand("render")) return render_command(w.first, w.second, w.view, w.common, console);
  if (app.got_subcommand("convert")) return convert_command(w.first, w.second, w.truth, w.every, console);
  if (app.got_subcommand("rig")) return rig_command(w.first, w.common, console);
  if (app.got_subcommand("nightly")) return nightly_command(w.nightly, w.common, console);
  if (app.got_subcommand("study")) return study_command(w.first, w.second, w.shard, w.common, console);
  if (app.got_subcommand("list")) return list_command(w.first, console);
  return help_command(w.first, console);
}

void add_score(CLI::App& app, Words& w) {
  CLI::App* score = app.add_subcommand("score", "a map against the truth, ours or anybody's");
  score->add_option("--world", w.score.world, "folder of the mine");
  score->add_option("--truth", w.score.truth,
                    "truth.h5 of the recording; without --world a reference path, as --trajectory");
  score->add_option("--map", w.score.map, "folder of a map as 'adit map' writes it");
  score->add_option("--trajectory", w.score.parts.trajectory, "somebody's path: TUM, 't x y yaw' a line, or KITTI");
  score->add_option("--stamps", w.score.parts.stamps, "of a KITTI path: one a line; else those of the laser's scans");
  score->add_option("--covariance", w.score.parts.covariance, "of its poses: 't' and 6 or 21 numbers a line");
  score->add_option("--laser", w.score.parts.laser,
                    "the path is that of this laser of the rig, not of the vehicle's body");
  score->add_option("--points", w.score.parts.points, "with it, its points: PLY or PCD");
  score->add_option("--grid", w.score.parts.grid, "its occupancy grid: the yaml of ROS map_server");
  score->add_option("--surface", w.score.parts.surface, "its closed surface: PLY or OBJ");
  score->add_option("--volume", w.score.parts.volume_m3, "its own word on the volume, m3")
      ->check(CLI::NonNegativeNumber);
  score->add_option("--relations", w.score.relations, "of a real log: 't1 t2 x y z roll pitch yaw' a line");
  score->add_option("--evo", w.score.evo, "write the path's errors as an archive (zip) that evo_res opens");
  score->add_option("--explain", w.score.explain, "define this metric, as 'adit list metrics' names it");
  add_common(score, w, false);
}

void add_nightly(CLI::App& app, Words& w) {
  CLI::App* nightly = app.add_subcommand("nightly", "scenarios x seeds against history: has accuracy been lost?");
  nightly->add_option("suite", w.nightly.suite, "bundled name or TOML file")->required();
  nightly->add_option("--history", w.nightly.history, "SQLite file; without it only tolerances are judged");
  nightly->add_option("--baseline", w.nightly.baseline, "window, branch:NAME, commit:ID or night:ID");
  nightly->add_option("--commit", w.nightly.commit, "of what is tested; else as CI or git say");
  nightly->add_option("--branch", w.nightly.branch, "of what is tested; else as CI or git say");
  nightly->add_option("--shard", w.nightly.shard,
                      "I/N: only make this part of the runs; the call without it judges all");
  nightly->add_option("--accept", w.nightly.accept, "why the last night is the new baseline; runs nothing");
  add_common(nightly, w, false);
}

void add_commands(CLI::App& app, Words& w) {
  CLI::App* run = app.add_subcommand("run", "the whole job: world, drive, map, score, report");
  run->add_option("scenario", w.first, "bundled name or TOML file")->required();
  add_common(run, w, true);
  CLI::App* world = app.add_subcommand("world", "a mine alone, or the check of a mesh");
  CLI::Option* scenario =
      world->add_option("scenario", w.first, "bundled name or TOML file; or the TOML file of a set of mines");
  CLI::Option* check = world->add_option(
      "--check", w.check,
      "verify a mesh (PLY, OBJ): closed, oriented, labelled, not self-crossing; or a world's folder, its truth too");
  check->excludes(scenario);
  world
      ->add_option("--stats", w.stats,
                   "what all mines under this folder measure, as a table and as plots (-o, else in the folder)")
      ->excludes(scenario)
      ->excludes(check);
  add_common(world, w, true);
  CLI::App* drive = app.add_subcommand("drive", "a recording, in a mine that is made or given");
  drive->add_option("scenario", w.first, "bundled name or TOML file")->required();
  drive->add_option("--world", w.world, "folder of a mine made before");
  add_common(drive, w, true);
  CLI::App* map = app.add_subcommand("map", "a map from a recording alone");
  map->add_option("recording", w.first,
                  "log.h5, a CARMEN log (.log, .clf), a ROS 1 bag (.bag), or a pose graph (.g2o, .graph)")
      ->required();
  add_common(map, w, false);
  add_score(app, w);
  CLI::App* compare = app.add_subcommand("compare", "many runs: medians, intervals, paired differences, failures");
  compare->add_option("out", w.outs, "folders of runs")->required();
  add_common(compare, w, false);
  CLI::App* report =
      app.add_subcommand("report", "the page of a run (OUT/report), or of several side by side (-o, else comparison/)");
  report->add_option("out", w.outs, "folders of runs")->required();
  add_common(report, w, false);
  CLI::App* render = app.add_subcommand("render", "one picture of a run");
  render->add_option("run", w.first, "folder of a run")->required();
  render->add_option("view", w.second, "one of 'adit list views'")->required();
  render->add_option("--eye", w.view.eye, "X,Y,Z in metres to look from: cutaway, chamber, interior-1")
      ->delimiter(',')
      ->expected(3);
  render->add_option("--target", w.view.target, "X,Y,Z in metres to look at")->delimiter(',')->expected(3);
  render->add_option("--fov", w.view.fov_deg, "degrees that the picture is high")->check(CLI::Range(1.0, 150.0));
  add_common(render, w, false);
  CLI::App* convert = app.add_subcommand("convert", "a recording, a path or a cloud in another format");
  convert
      ->add_option(
          "from", w.first,
          ".h5, CARMEN .log or .clf, ROS 1 .bag, .tum, .ply, .pcd, recording/parts of a drive that was killed, or the "
          "folder of a mine")
      ->required();
  convert
      ->add_option("to", w.second,
                   "the same, or a folder in SemanticKITTI's layout; of a mine .obj, .sdf, .json, .ply or a folder")
      ->required();
  convert->add_option("--truth", w.truth, "truth.h5 of the recording; else the one beside it");
  convert->add_option("--every", w.every, "of clouds: every so many scans")->check(CLI::Range(1, 1000000));
  add_common(convert, w, false);
  CLI::App* rig = app.add_subcommand("rig", "pictures of a rig with its fans in a passage");
  rig->add_option("rig", w.first, "bundled name or TOML file")->required();
  add_common(rig, w, false);
  CLI::App* study = app.add_subcommand("study", "many runs with a question: a sweep of settings, a search for mounts");
  study->add_option("study", w.first, "bundled name or TOML file; or 'merge' and the folder of one")->required();
  study->add_option("folder", w.second, "of 'merge'");
  study->add_option("--shard", w.shard, "I/N: only this part of the runs; 'adit study merge OUT' joins them");
  add_common(study, w, true);
  add_nightly(app, w);
  CLI::App* list = app.add_subcommand("list", "what is bundled");
  list->add_option("what", w.first, "scenarios, suites, studies, vehicles, rigs, lasers, views or metrics");
  add_common(list, w, false);
  CLI::App* help = app.add_subcommand("help", "this text, or a topic");
  help->add_option("topic", w.first, "scenario, set, study or suite");
  add_common(help, w, false);
}

}  // namespace

int main(int argc, char** argv) {
  // A file that grows beyond a limit is answered as a full disk is, by an error that names it.
  std::signal(SIGXFSZ, SIG_IGN);
  CLI::App app("adit: test underground laser mapping before anyone goes underground", "adit");
  app.set_version_flag("--version", "adit " ADIT_VERSION);
  app.require_subcommand(1);
  Words words;
  add_commands(app, words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  }
  try {
    if (app.got_subcommand("help") && words.first.empty()) {
      std::printf("%s", app.help().c_str());
      return 0;
    }
    return dispatch(app, words);
  } catch (const adit::Error& e) {
    std::fprintf(stderr, "adit: %s\n", e.what());
    return static_cast<int>(e.fault());
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "adit: out of memory\n");
    return static_cast<int>(adit::Fault::file);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "adit: internal error: %s; please report it\n", e.what());
    return static_cast<int>(adit::Fault::bug);
  }
}
