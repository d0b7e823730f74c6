// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "cli/commands.h"
#include "cli/scenario.h"
#include "cli/scores.h"
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

bool has_parts(const ScoreInput& in) {
  return !in.trajectory.empty() || !in.laser.empty() || !in.points.empty() || !in.grid.empty() || !in.surface.empty() ||
         in.volume_m3 >= 0;
}

// The body's path from that of a laser where its nominal mount puts it; M stays the frame that the path is told in.
void lay_on_body(Trajectory& path, const Rig& nominal, const std::string& laser) {
  std::string known;
  for (const Mount& mount : nominal.mounts) {
    known += (known.empty() ? "" : ", ") + mount.name;
    if (mount.name != laser) continue;
    const Pose X_SB = mount.X_BS.inverse();
    for (Pose& X : path.X_WB) X = X * X_SB;
    return;
  }
  throw Error("score: --laser " + laser + ": the rig '" + nominal.name + "' has " + known);
}

// Somebody's result, as far as it was given.
Estimate estimate_of(const ScoreInput& in, const Rig& nominal) {
  if (!in.map.empty()) {
    if (has_parts(in)) throw Error("score: --map is a whole result; give either it or its parts");
    return load_estimate(in.map);
  }
  need(in.trajectory, "--map, or --trajectory (a path ties every other part to the truth)");
  Estimate e;
  e.method = fs::path(in.trajectory).stem().string();
  e.path = read_tum(in.trajectory);
  if (!in.laser.empty()) lay_on_body(e.path, nominal, in.laser);
  if (!in.points.empty()) e.points = read_points(in.points);
  if (!in.grid.empty()) e.grid = read_grid(in.grid);
  if (!in.surface.empty()) e.surface = read_mesh(in.surface);
  if (in.volume_m3 >= 0) e.volume_m3 = in.volume_m3;
  return e;
}

Score score_world(const ScoreInput& in, const ScoreSettings& settings, Console& console) {
  need(in.world, "--world");
  need(in.truth, "--truth");
  const World world = load_world(in.world);
  const Truth truth = load_truth(in.truth);
  if (truth.world != world_hash(world))
    throw Error(in.truth + ": was recorded in another mine than " + in.world + " holds; scores would mean nothing",
                Fault::not_comparable);
  const fs::path log = fs::path(in.truth).parent_path() / "log.h5";
  const Rig nominal = fs::exists(log) ? load_log(log.string()).rig : truth.rig;
  return score_map(world, truth, nominal, estimate_of(in, nominal), settings, console.progress());
}

Score score_real_log(const ScoreInput& in, const ScoreSettings& settings) {
  need(in.trajectory, "--trajectory");
  if (!in.world.empty() || !in.truth.empty() || !in.laser.empty())
    throw Error("score: --relations are the truth of a real log; --world, --truth and --laser do not go with them");
  return score_relations(read_relations(in.relations), read_tum(in.trajectory), settings.max_diff_s);
}

std::string file_of(const ScoreInput& in, const Common& common) {
  if (!common.out.empty()) return common.out + "/score.json";
  const std::string& beside = in.map.empty() ? in.trajectory : in.map;
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
  const Score score = in.relations.empty() ? score_world(in, s.score, console) : score_real_log(in, s.score);
  const std::string file = file_of(in, common);
  write_score(file, score);
  print_scores(score, console);
  console.result("scores: " + file);
  if (console.wants_json()) console.json(nlohmann::ordered_json::parse(read_text(file)).dump());
  return 0;
}

}  // namespace adit
