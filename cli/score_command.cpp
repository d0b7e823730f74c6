// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/path_file.h"
#include "cli/commands.h"
#include "cli/scenario.h"
#include "cli/scores.h"
#include "eval/evo_archive.h"
#include "eval/explain.h"
#include "eval/relations.h"

#include <nlohmann/json.hpp>

#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;

void need(const std::string& value, const std::string& option) {
  if (value.empty()) throw Error("score: " + option + " is missing; 'adit score --help' shows what goes together");
}

// The rig and the stamps as the mapper had them; without its log those of the truth.
Log log_beside(const std::string& truth_file, const Truth& truth) {
  const fs::path file = fs::path(truth_file).parent_path() / "log.h5";
  if (fs::exists(file)) return load_log(file.string());
  Log log;
  log.rig = truth.rig;
  for (const ScanTruth& scans : truth.scans) log.scans.emplace_back().stamp_s = scans.stamp_s;
  return log;
}

// Somebody's result, as far as it was given.
Estimate estimate_of(const ScoreInput& in, const Log* log) {
  if (!in.map.empty()) {
    if (in.parts.any()) throw Error("score: --map is a whole result; give either it or its parts");
    return load_estimate(in.map);
  }
  need(in.parts.trajectory, "--map, or --trajectory (a path ties every other part to the truth)");
  return load_parts(in.parts, log);
}

Score score_world(const ScoreInput& in, const ScoreSettings& settings, Console& console) {
  need(in.world, "--world");
  need(in.truth, "--truth");
  const World world = load_world(in.world);
  const Truth truth = load_truth(in.truth);
  if (truth.world != world_hash(world))
    throw Error(in.truth + ": was recorded in another mine than " + in.world + " holds; scores would mean nothing",
                Fault::not_comparable);
  const Log log = log_beside(in.truth, truth);
  return score_map(world, truth, log.rig, estimate_of(in, &log), settings, console.progress());
}

// A reference path of somebody in place of a mine.
Score score_reference(const ScoreInput& in, const ScoreSettings& settings) {
  need(in.parts.trajectory, "--trajectory");
  if (!in.parts.points.empty() || !in.parts.grid.empty() || !in.parts.surface.empty() || !in.parts.laser.empty())
    throw Error(
        "score: points, grids, surfaces and mounts need the mine that they are held against: give --world and its "
        "truth.h5");
  const bool shared_stamps = !in.parts.stamps.empty() && is_kitti(in.truth);
  const Trajectory truth = read_path(in.truth, shared_stamps ? read_stamps(in.parts.stamps) : std::vector<double>{});
  Score score = score_path(truth, estimate_of(in, nullptr), settings);
  score.meta.emplace_back("reference", fs::path(in.truth).filename().string());
  return score;
}

Score score_real_log(const ScoreInput& in, const ScoreSettings& settings) {
  need(in.parts.trajectory, "--trajectory");
  if (!in.world.empty() || !in.truth.empty() || !in.parts.laser.empty() || !in.evo.empty())
    throw Error(
        "score: --relations are the truth of a real log; --world, --truth, --laser and --evo do not go with them");
  return score_relations(read_relations(in.relations), load_parts(in.parts, nullptr).path, settings.max_diff_s);
}

std::string file_of(const ScoreInput& in, const Common& common) {
  if (!common.out.empty()) return common.out + "/score.json";
  const std::string& beside = in.map.empty() ? in.parts.trajectory : in.map;
  return (fs::path(beside).parent_path() / "score.json").string();
}

}  // namespace

int score_command(const ScoreInput& in, const Common& common, Console& console) {
  if (!in.explain.empty()) {
    const std::string words = explain_metric(in.explain);
    console.result(words);
    console.json(nlohmann::ordered_json{{"metric", in.explain}, {"words", words}}.dump());
    return 0;
  }
  Scenario s;
  for (const std::string& a : common.assignments) set_field(fields(s), a);
  const bool no_mine = in.world.empty() && !in.truth.empty() && !in.truth.ends_with(".h5");
  const Score score = !in.relations.empty() ? score_real_log(in, s.score)
                      : no_mine             ? score_reference(in, s.score)
                                            : score_world(in, s.score, console);
  const std::string file = file_of(in, common);
  write_score(file, score);
  for (const std::string& warning : score.warnings) console.note("warning: " + warning);
  if (!in.evo.empty()) write_evo_archive(in.evo, score);
  print_scores(score, console);
  console.result("scores: " + file);
  if (console.wants_json()) console.json(nlohmann::ordered_json::parse(read_text(file)).dump());
  return 0;
}

}  // namespace adit
