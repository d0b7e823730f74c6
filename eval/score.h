// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/estimate.h"
#include "base/frames.h"
#include "base/mesh.h"
#include "base/progress.h"
#include "base/recording.h"
#include "base/rig.h"
#include "base/world.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace adit {

/// Which way a number gets better; a signed one (a bias, an error in percent) by its distance from 0.
enum class Better { lower, higher };
std::string better_name(Better better);

/// One number of a score. docs/metrics.md defines each name.
struct Metric {
  std::string name;  // dotted: "trajectory.se3.ate_xy_rmse_m"
  double value;      // NaN: could not be had, and `why` says the cause; written as null
  std::string unit;  // "m", "m3", "deg", "percent", "share", "count", "ratio"
  Better better;
  std::int64_t n;   // poses, points, pairs, patches or cells that it is made of
  std::string why;  // empty where there is a value
};

/// Error of one pose of the estimate, laid on W by se3.
struct PoseError {
  double stamp_s;
  double along_m;      // true distance driven until then
  Pose X_WB;           // truth (of the body as the nominal mount has it)
  Vec3 p_error_W;      // estimate - truth, m
  YawPitchRoll error;  // of R_true^-1 * R_estimate
  Pose X_WB_estimate = Pose::Identity();
};

/// How good the map is in one passage: of the map's points whose nearest surface lies there, laid by se3.
struct PassageScore {
  int passage;                  // id in World::passages
  std::int64_t n;               // points
  double bias_m, mae_m, p95_m;  // signed mean, mean and 95th percentile of the absolute error; NaN where n = 0
  double observable_m3 = 0;     // void of the volume's domain that is nearest to the passage's centre line
  double mapped_m3 = 0;         // what the map says of it; NaN without a mapped surface
};

/// How a pillar stands in a map's grid.
struct PillarScore {
  int pillar;       // id in World::pillars
  double true_m2;   // of its island of cells that are not free, in the true section
  double found_m2;  // in the grid; NaN where it does not stand there alone
};

/// A place where the map is worst, worst first; places lie at least 10 m apart.
struct WorstPlace {
  Vec3 p_W;        // mean of the true surface points concerned
  int passage;     // nearest
  std::int64_t n;  // points of the map there
  double bias_m, mae_m;
};

/// How wrong a map is.
struct Score {
  std::vector<Metric> metrics;
  std::vector<std::pair<std::string, std::string>> meta;  // truth's hash, alignments, association, thresholds
  std::vector<std::string> notes;                         // what was missing or left out, one sentence each
  std::vector<std::string> warnings;                      // of the notes, those that cast doubt on the input
  std::vector<PassageScore> passages;
  std::vector<PillarScore> pillars;
  std::vector<WorstPlace> worst;

  // For pictures; not in score.json.
  Pose X_WM_first_pose = Pose::Identity(), X_WM_se3 = Pose::Identity();
  std::vector<PoseError> poses;           // estimate poses that the truth covers, in their order
  std::vector<float> point_error_m;       // (Estimate::points) signed, + into the void, by se3; NaN where it has none
  std::vector<std::uint8_t> point_label;  // (Estimate::points) Label of the nearest surface
  std::vector<std::uint8_t>
      face_hits;  // (World::mesh.face) noise-free beams that met it at a usable angle, at most 255

  /// By its dotted name, or null.
  const Metric* find(const std::string& name) const;
};

/// What counts as right. Keys below [score].
struct ScoreSettings {
  std::string association = "interpolated";  // of the truth at the estimate's stamps; or "nearest", one to one
  double max_gap_s = 0.5;                    // between true poses that are interpolated
  double max_diff_s = 0.13;                  // of a relation's ends, or of "nearest", to the nearest pose
  bool gravity = false;                      // the map's z is vertical by measurement: yaw_xyz is told too
  std::vector<double> rpe_m = {1, 5, 10, 25, 50, 100};
  double closure_m = 0.5, closure_deg = 3;                // a measured closure is right within these
  double place_m = 3, place_deg = 45, revisit_m = 20;     // the same place; path between two visits of it
  double loop_m = 1;                                      // two visits laid together within this close a loop
  std::vector<double> thresholds_m = {0.05, 0.10, 0.20};  // of precision, recall and F
  double patch_m = 0.2;                                   // edge of the patches of surface that are counted
  double incidence_deg = 80;   // beams that meet the surface flatter do not make it observable
  double window_m = 5;         // of local_5m
  double domain_cell_m = 0.1;  // columns of the volume's domain
  double domain_rock_m = 0.5;  // rock about the observable surface that belongs to it
  double domain_step_m = 0.3;  // farther scans are not joined
  double domain_beam_deg = 2;  // step of the beams whose fans span it
  double pillar_m2 = 4;        // smaller islands in the grid are no pillars
  double junction_m = 3;       // a junction of the map's graph within this of a true one is that one
};
Fields fields(ScoreSettings& settings);

/// Raised whenever a metric's definition changes, so that numbers of two definitions are never held against each other.
constexpr int evaluator_version = 2;

/// Holds an estimate against the truth. All lengths in m, angles in degrees where a name ends in _deg.
/// @param truth     of the same world: Error (not_comparable) when its hash is another
/// @param nominal   the rig that the mapper was told; the path is judged for the mapping laser's nominal mount
/// @param estimate  any part may be missing: its metrics are then null and say why
/// @throws Error (not_comparable) where the truth covers less than 95 % of the estimate's poses
/// The same bits on any number of threads.
Score score_map(const World& world, const Truth& truth, const Rig& nominal, const Estimate& estimate,
                const ScoreSettings& settings, const Progress& progress = {});

/// The block `trajectory` alone (and `consistency`), against a reference path; alignments as of score_map.
/// @throws Error (not_comparable) where the reference covers less than 95 % of the estimate's poses
Score score_path(const Trajectory& reference, const Estimate& estimate, const ScoreSettings& settings);

/// score.json: blocks nested by the dots of the names, every metric {"value", "unit", "better", "n"}; null comes with
/// "why".
void write_score(const std::string& file, const Score& score);
/// Metrics, meta, notes, passages and worst places; the members for pictures stay empty.
Score read_score(const std::string& file);

}  // namespace adit
