// SPDX-License-Identifier: BSD-3-Clause
#include "eval/score.h"

#include "base/error.h"
#include "eval/bound.h"
#include "eval/closure_score.h"
#include "eval/consistency.h"
#include "eval/graph_score.h"
#include "eval/grid_error.h"
#include "eval/map_error.h"
#include "eval/metric_list.h"
#include "eval/observable.h"
#include "eval/passage_map.h"
#include "eval/path_error.h"
#include "eval/plausible.h"
#include "eval/topology.h"
#include "eval/true_scans.h"
#include "eval/volume_error.h"
#include "eval/worst_places.h"
#include "eval/yardstick.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <optional>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;
constexpr double least_share = 0.95;

std::string text(double value) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", value);
  return buffer;
}

// How the estimate's path lies on the true one.
struct Fit {
  int mapping_laser;  // -1: the rig has none
  Pose X_BN;          // the body as the mapping laser's nominal mount has it, in the true body
  PathMatch match;
  std::string no_path;  // why there is no path to judge, or empty
  Alignment first_pose, se3, yaw_xyz;
};

// What all parts stand on.
struct Bench : Fit {
  const Yardstick& yard;
  const Estimate& estimate;
  const Progress& progress;
};

PathMatch matched(const Trajectory& truth, const Trajectory& estimate, const Pose& X_BN, const ScoreSettings& s) {
  if (s.association != "nearest") return associate(truth, estimate, X_BN, s.max_gap_s);
  PathMatch match = associate_nearest(truth, estimate, s.max_diff_s);
  for (Pose& X : match.X_WB) X = X * X_BN;
  return match;
}

void check_share(const PathMatch& match, const Trajectory& truth, const Trajectory& estimate) {
  if (match.share() >= least_share) return;
  const auto span = [](const Trajectory& path) {
    return path.empty() ? std::string("nothing")
                        : text(path.stamp_s.front()) + " to " + text(path.stamp_s.back()) + " s";
  };
  throw Error("the truth covers " + std::to_string(match.size()) + " of the estimate's " + std::to_string(match.asked) +
                  " poses (" + span(truth) + ", the estimate " + span(estimate) +
                  "); at least 95 % is needed: do the stamps belong together?",
              Fault::not_comparable);
}

Pose nominal_body(const Truth& truth, const Rig& nominal, int laser) {
  if (laser < 0) return Pose::Identity();
  return truth.rig.mounts[static_cast<size_t>(laser)].X_BS * nominal.mounts[static_cast<size_t>(laser)].X_BS.inverse();
}

// Cheap, so that what cannot be judged is refused before anything long begins.
Fit fit_of(const Truth& truth, const Rig& nominal, const Estimate& estimate, const ScoreSettings& settings) {
  const int laser = find_view(nominal, View::horizontal);
  Fit fit{laser, nominal_body(truth, nominal, laser), {}, "", {}, {}, {}};
  fit.match = matched(truth.drive.path, estimate.path, fit.X_BN, settings);
  if (estimate.path.empty()) {
    fit.no_path = "the estimate has no path";
    return fit;
  }
  check_share(fit.match, truth.drive.path, estimate.path);
  check_plausible(estimate, fit.match);
  fit.first_pose = align_first_pose(fit.match);
  fit.se3 = align_se3(fit.match);
  fit.yaw_xyz = align_yaw_xyz(fit.match);
  return fit;
}

// The path of scan matching alone, as a path in space.
Trajectory lifted(const Estimate& estimate) {
  Trajectory path;
  path.stamp_s = estimate.path.stamp_s;
  for (const Pose2& X : estimate.open_loop) path.X_WB.push_back(lift(X));
  return path;
}

void score_open_loop(const Bench& b, const MetricList& list) {
  const bool have = !b.estimate.path.empty() && b.estimate.open_loop.size() == b.estimate.path.size();
  const std::string why = have ? "" : "the estimate has no path of scan matching alone";
  const PathMatch match =
      have ? matched(b.yard.truth.drive.path, lifted(b.estimate), b.X_BN, b.yard.settings) : PathMatch{};
  std::vector<PoseError> first, best;
  if (match.size()) {
    first = pose_errors(match, align_first_pose(match).X_WM);
    best = pose_errors(match, align_se3(match).X_WM);
  }
  add_ate(list.under("first_pose"), first, why);
  add_ate(list.under("se3"), best, why);
  add_rpe(list, match, b.yard.settings.rpe_m, why);
  add_length(list, match, why);
}

// What a path alone is judged by.
void add_path(const MetricList& list, const PathMatch& match, const Alignment& first_pose, const Alignment& se3,
              const Alignment& yaw_xyz, const ScoreSettings& settings, const std::string& why, Score& score) {
  list.add("matched_share", why.empty() ? match.share() : NAN, "share", Better::higher,
           static_cast<std::int64_t>(match.asked), why);
  score.poses = pose_errors(match, se3.X_WM);
  add_ate(list.under("first_pose"), pose_errors(match, first_pose.X_WM), why);
  add_ate(list.under("se3"), score.poses, why);
  if (settings.gravity) add_ate(list.under("yaw_xyz"), pose_errors(match, yaw_xyz.X_WM), why);
  add_rpe(list, match, settings.rpe_m, why);
  add_length(list, match, why);
}

void score_path(const Bench& b, Score& score) {
  const MetricList list(score.metrics, "trajectory.");
  add_path(list, b.match, b.first_pose, b.se3, b.yaw_xyz, b.yard.settings, b.no_path, score);
  score_open_loop(b, list.under("open_loop"));
  add_consistency(MetricList(score.metrics, "consistency."), b.match, b.estimate.covariance, b.no_path);
  const Pose X_BS =
      b.mapping_laser < 0 ? Pose::Identity() : b.yard.nominal.mounts[static_cast<size_t>(b.mapping_laser)].X_BS;
  add_bound(MetricList(score.metrics, "bound."), b.yard.scans, b.yard.world.mesh, b.mapping_laser, X_BS, b.match,
            b.estimate.open_loop, b.no_path);
  const Vec3 p_BL = b.mapping_laser >= 0
                        ? Vec3(b.yard.nominal.mounts[static_cast<size_t>(b.mapping_laser)].X_BS.translation())
                        : Vec3::UnitZ();
  add_closures(MetricList(score.metrics, "closures."), b.yard.passages, *b.yard.surface.caster, b.match,
               b.estimate.closures, p_BL, b.yard.settings, b.no_path);
}

void score_points(const Bench& b, Score& score) {
  const Patches& patches = b.yard.patches;
  const VolumeDomain* domain = b.yard.domain ? &*b.yard.domain : nullptr;
  const std::string why = !b.no_path.empty() ? b.no_path : b.estimate.points.p.empty() ? "the map has no points" : "";
  const MetricList list(score.metrics, "map.");
  const auto add = [&](const std::string& name, const MapPoints& points, const LaidPoints& laid,
                       const std::string& because) {
    add_map(list.under(name), points, laid, b.yard.world.mesh, patches, b.yard.observable, b.yard.settings, because);
  };
  if (!why.empty()) {
    for (const char* name : {"se3", "first_pose", "local_5m"}) add(name, {}, {}, why);
    return;
  }
  const MapPoints points = map_points(b.estimate.points, b.estimate.path, b.yard.nominal, b.yard.settings.patch_m);
  if (points.seen_M.empty())
    score.notes.push_back(
        "The map's points do not tell which beam saw them: each is held against the nearest surface of either side.");
  b.progress("score: points", 0, 3);
  {
    const LaidPoints laid = lay(
        points, [&](size_t) -> const Pose& { return b.se3.X_WM; }, b.yard.surface, patches, domain);
    add("se3", points, laid, "");
    score.point_error_m = laid.error_m;
    for (const std::int32_t f : laid.face)
      score.point_label.push_back(f >= 0 && !b.yard.world.mesh.label.empty()
                                      ? static_cast<std::uint8_t>(b.yard.world.mesh.label[static_cast<size_t>(f)])
                                      : 0);
    score.passages = passage_scores(laid, b.yard.world.mesh, b.yard.passages);
    score.worst = worst_places(laid, b.yard.passages);
  }
  b.progress("score: points", 1, 3);
  add("first_pose", points,
      lay(
          points, [&](size_t) -> const Pose& { return b.first_pose.X_WM; }, b.yard.surface, patches, domain),
      "");
  if (b.yard.settings.gravity)
    add("yaw_xyz", points,
        lay(
            points, [&](size_t) -> const Pose& { return b.yaw_xyz.X_WM; }, b.yard.surface, patches, domain),
        "");
  b.progress("score: points", 2, 3);
  if (points.stamp_s.empty()) {
    add("local_5m", {}, {}, "the map's points have no stamps");
  } else {
    const Windows windows = windows_of(b.match, b.yard.settings.window_m);
    add("local_5m", points,
        lay(
            points, [&](size_t i) -> const Pose& { return windows.at(points.stamp_s[i]); }, b.yard.surface, patches,
            domain),
        "");
  }
  b.progress("score: points", 3, 3);
}

void score_grid(const Bench& b, Score& score) {
  const Grid& grid = b.estimate.grid;
  const MetricList list(score.metrics, "grid.");
  std::string why = b.no_path;
  if (why.empty() && (grid.log_odds.empty() || !(grid.cell_m > 0))) why = "the map has no grid";
  if (why.empty() && b.mapping_laser < 0) why = "the rig has no horizontal laser";
  if (!why.empty()) {
    add_grid(list, {}, {}, why);
    add_topology(list, b.yard.world, {}, {}, {}, 0, b.yard.settings.pillar_m2, why);
    add_graph(list, b.yard.world, b.yard.passages, {}, {}, {}, b.yard.settings, why);
    return;
  }
  const auto laser = static_cast<size_t>(b.mapping_laser);
  const TrueSection section = true_section(grid, b.se3.X_WM, b.yard.scans, laser, b.yard.world.mesh);
  add_grid(list, section, grid, "");
  double height_m = 0;
  for (const Pose& X : b.match.X_WB) height_m += X.translation().z() / static_cast<double>(b.match.size());
  const std::vector<Grid::Cell> cells = cells_over(section, grid);
  score.pillars = add_topology(list, b.yard.world, section, cells, b.se3.X_WM, height_m, b.yard.settings.pillar_m2, "");
  add_graph(list, b.yard.world, b.yard.passages, section, cells, b.se3.X_WM, b.yard.settings, "");
}

void score_volume(const Bench& b, Score& score) {
  const std::string& why = b.yard.no_domain;
  std::optional<Mesh> mapped;
  std::string unmapped = b.no_path;
  if (unmapped.empty() && b.estimate.surface.face.empty()) unmapped = "the map has no surface";
  if (unmapped.empty())
    if (const size_t open = open_edges(b.estimate.surface); open > 0)
      unmapped = "the map's surface has " + std::to_string(open) + " open edges: it encloses no volume";
  if (unmapped.empty()) {
    mapped = b.estimate.surface;
    for (Vec3& v : mapped->vertex) v = b.se3.X_WM * v;
  }
  const std::vector<PassageVolume> shares = add_volume(
      MetricList(score.metrics, "volume."), why.empty() ? enclosed_volume(b.yard.world.mesh) : NAN, b.yard.domain, why,
      mapped, unmapped, b.estimate.volume_m3, b.estimate.volume_sigma_m3, b.yard.passages);
  for (PassageScore& p : score.passages) {
    if (shares.empty()) continue;
    p.observable_m3 = shares[static_cast<size_t>(p.passage)].observable_m3;
    p.mapped_m3 = shares[static_cast<size_t>(p.passage)].mapped_m3;
  }
}

void add_path_meta(const PathMatch& match, const Alignment& first_pose, const Alignment& se3, const Alignment& yaw_xyz,
                   const ScoreSettings& s, Score& score) {
  score.meta.emplace_back("association", s.association == "nearest"
                                             ? "nearest pose of the truth within " + text(s.max_diff_s) +
                                                   " s, one to one; widest " + text(match.widest_s) + " s"
                                             : "truth interpolated at the estimate's stamps, gaps up to " +
                                                   text(s.max_gap_s) + " s; widest " + text(match.widest_s) + " s");
  score.meta.emplace_back("first_pose", first_pose.how);
  score.meta.emplace_back("se3", se3.how);
  if (s.gravity) score.meta.emplace_back("yaw_xyz", yaw_xyz.how);
}

// Points that lie far from any rock though the path fits are told in another frame than it.
void warn_of_frames(Score& score) {
  const Metric *map = score.find("map.se3.p50_m"), *path = score.find("trajectory.se3.ate_rmse_m");
  if (!map || !path || !(map->value > 1) || !(path->value < 0.3 * map->value)) return;
  score.warnings.push_back("The points lie " + text(map->value) + " m off in the median, the path only " +
                           text(path->value) + " m: are the points told in the frame of the path?");
}

// No map claims tens of times the mine; another unit does.
void warn_of_litres(Score& score) {
  const Metric *claimed = score.find("volume.claimed_m3"), *mine = score.find("volume.true_m3");
  if (!claimed || !mine || !(claimed->value > 0) || !(mine->value > 0)) return;
  const double times = claimed->value / mine->value;
  if (times > 20)
    score.warnings.push_back("The volume that is claimed is " + text(times) +
                             " times the mine's: is it told in m3, not in litres or cubic feet?");
}

void add_notes(Score& score) {
  const auto silent = [](const std::string& name) {
    for (const char* part : {"by_label", "rpe_", "bound.smooth", "bound.rough", "inside_95", "claim_"})
      if (name.find(part) != std::string::npos) return true;
    return false;
  };
  for (const std::string& warning : score.warnings) score.notes.push_back(warning);
  for (const Metric& m : score.metrics)
    if (!m.why.empty() && !silent(m.name)) score.notes.push_back(m.name + " could not be had: " + m.why + ".");
}

// The path that was driven, to a tenth of a millimetre: another drive through the same mine is another truth.
std::string path_hash(const Trajectory& path) {
  std::uint64_t h = 0xcbf29ce484222325;  // FNV-1a
  const auto add = [&](double metres) {
    h = (h ^ static_cast<std::uint64_t>(std::llround(metres * 1e4))) * 0x100000001b3;
  };
  for (const Pose& X : path.X_WB)
    for (int k = 0; k < 3; ++k) add(X.translation()[k]);
  char hex[17];
  std::snprintf(hex, sizeof hex, "%016llx", static_cast<unsigned long long>(h));
  return hex;
}

void add_meta(const Bench& b, Score& score) {
  const ScoreSettings& s = b.yard.settings;
  const auto add = [&](const std::string& key, const std::string& value) { score.meta.emplace_back(key, value); };
  add("method", b.estimate.method);
  add("world", b.yard.world.name);
  add("truth_hash", b.yard.truth.world);
  add("path_hash", path_hash(b.yard.truth.drive.path));
  add("evaluator", std::to_string(evaluator_version));
  add_path_meta(b.match, b.first_pose, b.se3, b.yaw_xyz, s, score);
  const Vec3 shift = b.X_BN.translation();
  add("mapping_mount_error", text(shift.norm()) + " m, " + text(Eigen::AngleAxisd(b.X_BN.linear()).angle() / deg) +
                                 " deg: taken out of the path, for it is the calibration's");
  add("closure", "measured: " + text(s.closure_m) + " m, " + text(s.closure_deg) +
                     " deg; by place: " + text(s.place_m) + " m, " + text(s.place_deg) + " deg; revisited after " +
                     text(s.revisit_m) + " m of way");
  add("surface",
      "patches of " + text(s.patch_m) + " m, observable with 1 beam at up to " + text(s.incidence_deg) + " deg");
  add("domain", "columns of " + text(s.domain_cell_m) + " m, fans every " + text(s.domain_beam_deg) +
                    " deg between scans up to " + text(s.domain_step_m) + " m apart, rock within " +
                    text(s.domain_rock_m) + " m of the observable surface");
}

Score scored(const Bench& b) {
  Score score;
  score.X_WM_first_pose = b.first_pose.X_WM;
  score.X_WM_se3 = b.se3.X_WM;
  add_meta(b, score);
  if (!b.se3.warning.empty()) score.warnings.push_back(b.se3.warning);
  score_path(b, score);
  score.face_hits = b.yard.observable.face_hits;
  score_points(b, score);
  score_grid(b, score);
  score_volume(b, score);
  warn_of_frames(score);
  warn_of_litres(score);
  add_notes(score);
  return score;
}

}  // namespace

std::string better_name(Better better) {
  return better == Better::higher ? "higher" : "lower";
}

const Metric* Score::find(const std::string& name) const {
  for (const Metric& m : metrics)
    if (m.name == name) return &m;
  return nullptr;
}

Fields fields(ScoreSettings& s) {
  constexpr double most = 1e6;
  return {
      {"association", &s.association, "of truth and estimate by stamps", {"interpolated", "nearest"}},
      {"gravity", &s.gravity, "the map's z is vertical by measurement: yaw_xyz is told too"},
      {"max_gap_s", &s.max_gap_s, "widest gap between true poses that is interpolated", 0, most},
      {"max_diff_s", &s.max_diff_s, "between an end of a relation, or a pose of 'nearest', and the nearest pose", 0,
       most},
      {"rpe_m", &s.rpe_m, "distances of the relative pose error"},
      {"closure_m", &s.closure_m, "a measured closure is right within this distance", 0, most},
      {"closure_deg", &s.closure_deg, "and this angle", 0, 180},
      {"place_m", &s.place_m, "true poses within this are the same place", 0, most},
      {"place_deg", &s.place_deg, "headings within this of each other or of opposite are along each other", 0, 90},
      {"revisit_m", &s.revisit_m, "way between two visits of a place", 0, most},
      {"loop_m", &s.loop_m, "a loop is closed when two visits of a place are laid within this of the truth", 0, most},
      {"thresholds_m", &s.thresholds_m, "of precision, recall and F"},
      {"patch_m", &s.patch_m, "edge of the patches in which surface is counted", 0.01, 100},
      {"incidence_deg", &s.incidence_deg, "beams that meet the surface flatter do not make it observable", 0, 90},
      {"window_m", &s.window_m, "of local_5m: way whose points are laid together", 0.1, most},
      {"domain_cell_m", &s.domain_cell_m, "columns of the volume's domain", 0.01, 10},
      {"domain_rock_m", &s.domain_rock_m, "rock about the observable surface that belongs to it", 0, 100},
      {"domain_step_m", &s.domain_step_m, "scans farther apart span no volume", 0, 100},
      {"domain_beam_deg", &s.domain_beam_deg, "between the beams whose fans span it", 0.01, 45},
      {"pillar_m2", &s.pillar_m2, "smaller islands in a grid are no pillars", 0, most},
      {"junction_m", &s.junction_m, "junctions of the map's graph and the mine's within this are one", 0, most}};
}

Score score_map(const World& world, const Truth& truth, const Rig& nominal, const Estimate& estimate,
                const ScoreSettings& settings, const Progress& progress) {
  check_comparable(world, truth, nominal);
  const Fit fit = fit_of(truth, nominal, estimate, settings);
  return scored({fit, Yardstick(world, truth, nominal, settings, progress), estimate, progress});
}

Score score_map(const Yardstick& yard, const Estimate& estimate, const Progress& progress) {
  return scored({fit_of(yard.truth, yard.nominal, estimate, yard.settings), yard, estimate, progress});
}

Score score_path(const Trajectory& reference, const Estimate& estimate, const ScoreSettings& settings) {
  const PathMatch match = matched(reference, estimate.path, Pose::Identity(), settings);
  check_share(match, reference, estimate.path);
  check_plausible(estimate, match);
  const Alignment first_pose = align_first_pose(match), se3 = align_se3(match), yaw_xyz = align_yaw_xyz(match);
  Score score;
  score.meta.emplace_back("method", estimate.method);
  add_path_meta(match, first_pose, se3, yaw_xyz, settings, score);
  if (!se3.warning.empty()) score.warnings.push_back(se3.warning);
  score.X_WM_first_pose = first_pose.X_WM;
  score.X_WM_se3 = se3.X_WM;
  add_path(MetricList(score.metrics, "trajectory."), match, first_pose, se3, yaw_xyz, settings, "", score);
  add_consistency(MetricList(score.metrics, "consistency."), match, estimate.covariance, "");
  add_notes(score);
  return score;
}

}  // namespace adit
