// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <utility>

namespace adit {
namespace {

int horizontal_laser(const Log& log) {
  const int h = find_view(log.rig, View::horizontal);
  if (h < 0)
    throw Error("rig '" + log.rig.name +
                "' has no horizontal laser; a map needs one whose scan plane is level within some degrees");
  if (static_cast<size_t>(h) >= log.scans.size() || log.scans[h].size() == 0)
    throw Error("the recording holds no scans of its horizontal laser '" + log.rig.mounts[h].name +
                "'; nothing can be mapped");
  return h;
}

Aligned align(const Odometry& odometry, const std::vector<ScanPoints>& points, const MapSettings& settings,
              const Progress& progress) {
  if (settings.method == "icra2003") return align_published(odometry, settings.icra2003, progress);
  const Chain chain = chain_of(odometry, settings.robust.node_m);
  const MatchPlaces match = match_by_scans(points, chain, odometry.X_MB, settings.places, settings.odometry.match);
  return align_robust(odometry, match, settings.robust, progress);
}

bool nods(const Log& log) {
  return std::any_of(log.scans.begin(), log.scans.end(), [](const Scans& s) { return !s.tilt_rad.empty(); });
}

/// What the lasers other than the horizontal one add: path, points, surface, volume and notes. Leaves planar and grid alone.
/// Scans of tilted mounts are in `log` alone and give points alone.
void add_height(const Log& level, const Log& log, const MapSettings& settings, const Progress& progress,
                Estimate& estimate) {
  TiltSolution tilt = solve_tilt(level, estimate.path.stamp_s, estimate.planar, settings.tilt, progress);
  if (!tilt.note.empty()) estimate.notes.push_back(tilt.note);
  estimate.path = std::move(tilt.path);
  const Log corrected = without_bias(level, tilt.range_bias_m);
  estimate.points =
      map_points(nods(log) ? without_bias(log, tilt.range_bias_m) : corrected, tilt.dense, settings.volume);
  MappedVoid mapped = map_void(corrected, tilt.dense, settings.volume, progress);
  estimate.surface = std::move(mapped.surface);
  estimate.volume_m3 = mapped.volume_m3;
  estimate.volume_sigma_m3 = mapped.volume_sigma_m3;
  if (!mapped.volume_m3) estimate.notes.push_back("the rig has no upward laser: no surface and no volume");
}

}  // namespace

Fields fields(MapSettings& s) {
  Fields all{{"method", &s.method, "of the global alignment", {"robust", "icra2003"}}};
  append(all, "odometry", fields(s.odometry));
  append(all, "icra2003", fields(s.icra2003));
  append(all, "robust", fields(s.robust));
  append(all, "places", fields(s.places));
  append(all, "rematch", fields(s.rematch));
  append(all, "grid", fields(s.grid));
  append(all, "tilt", fields(s.tilt));
  append(all, "volume", fields(s.volume));
  append(all, "graph", fields(s.graph));
  return all;
}

Estimate make_map(const Log& all, const MapSettings& settings, const Progress& progress) {
  const Log level = nods(all) ? level_scans(all) : Log{};
  const Log& log = nods(all) ? level : all;
  const int h = horizontal_laser(log);
  const Scans& scans = log.scans[h];
  const Mount& mount = log.rig.mounts[h];
  Estimate estimate;
  estimate.method = settings.method;
  estimate.path.stamp_s = scans.stamp_s;

  const Odometry odometry = estimate_motion(scans, mount, settings.odometry, progress);
  estimate.open_loop = odometry.X_MB;
  estimate.degenerate = odometry.degenerate;
  if (odometry.lost > 0)
    estimate.notes.push_back(std::to_string(odometry.lost) + " scans could not be matched; their motion is predicted");

  const std::vector<ScanPoints> points = scan_points(scans, mount, odometry.X_MB, settings.odometry.points);
  Aligned aligned = align(odometry, points, settings, progress);
  estimate.planar = rematch(points, aligned.X_MB, settings.rematch, settings.odometry.match, progress);
  estimate.rounds = std::move(aligned.rounds);
  estimate.converged = aligned.converged;
  estimate.closures = std::move(aligned.closures);
  estimate.graph = std::move(aligned.graph);
  estimate.covariance.assign(aligned.covariance.begin(), aligned.covariance.end());
  estimate.notes.insert(estimate.notes.end(), aligned.notes.begin(), aligned.notes.end());

  // Height is mostly one factorisation on one thread: the grid is drawn beside it.
  parallel_for(2, [&](size_t task) {
    if (task == 0) add_height(log, all, settings, progress, estimate);
    if (task == 1) estimate.grid = map_grid(scans, mount, estimate.planar, settings.grid, settings.odometry.points);
  });
  return estimate;
}

}  // namespace adit
