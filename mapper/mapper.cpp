// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/mapper.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
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

Aligned align(const Odometry& odometry, const std::vector<ScanPoints>& points, const MatchSettings& match,
              const MapSettings& settings, const Progress& progress) {
  if (settings.method == "icra2003") return align_published(odometry, settings.icra2003, progress);
  const Chain chain = chain_of(odometry, settings.robust.node_m);
  return align_robust(odometry, match_by_scans(points, chain, odometry, settings.places, match), settings.robust,
                      progress);
}

/// The path of the horizontal laser's scans in the plane.
struct PlanarMap {
  Odometry odometry;
  Aligned aligned;
  std::vector<Pose2> X_MB;
};

/// From scans that were matched once and for all. @param matched  with which settings; @param stances  in space, or none
PlanarMap align_matched(const Log& log, int horizontal, Odometry odometry, const OdometrySettings& matched,
                        const std::vector<Stance>& stances, const MapSettings& settings, const Progress& progress) {
  const OdometrySettings found = at_ribs(matched, odometry);
  const std::vector<ScanPoints> points =
      scan_points(log.scans[horizontal], log.rig.mounts[horizontal], odometry.X_MB, found.points, stances);
  Aligned aligned = align(odometry, points, found.match, settings, progress);
  std::vector<Pose2> X_MB = rematch(points, aligned.X_MB, settings.rematch, found.match, progress);
  return {std::move(odometry), std::move(aligned), std::move(X_MB)};
}

/// For a path that is to be bettered.
TiltSettings roughly(TiltSettings s) {
  s.node_m *= s.coarse, s.coarse = 1, s.iterations = std::min(s.iterations, 2);
  return s;
}

/// The laser at each scan, by the height, pitch and roll that a first path in the plane leads to.
std::vector<Stance> stances_of(const Log& log, int horizontal, const Odometry& odometry, const MapSettings& settings,
                               const Progress& progress) {
  const Scans& scans = log.scans[horizontal];
  const Mount& mount = log.rig.mounts[horizontal];
  const OdometrySettings found = at_ribs(settings.odometry, odometry);
  const Aligned aligned =
      align(odometry, scan_points(scans, mount, odometry.X_MB, found.points), found.match, settings, progress);
  const TiltSolution tilt = solve_tilt(log, scans.stamp_s, aligned.X_MB, roughly(settings.tilt), progress);
  return stances_along(tilt.dense, scans.stamp_s, mount, fan_of(mount).scan_s());
}

/// A laser that pitches and rolls sees other rock in every scan, and only what lies at one height is the same: where the rig
/// tells height, pitch and roll all is matched once more, each beam where it was in space.
PlanarMap map_plan(const Log& log, int horizontal, Odometry odometry, const MapSettings& settings,
                   const Progress& progress) {
  if (settings.space.use && settings.method == "robust" && find_view(log.rig, View::forward_vertical) >= 0) {
    const std::vector<Stance> stances = stances_of(log, horizontal, odometry, settings, progress);
    const OdometrySettings matched = in_space(settings.odometry, settings.space, odometry);
    Odometry again =
        estimate_motion(log.scans[horizontal], log.rig.mounts[horizontal], matched, progress, stances, &odometry);
    if (again.breaks.empty())
      return align_matched(log, horizontal, std::move(again), matched, stances, settings, progress);
  }
  return align_matched(log, horizontal, std::move(odometry), settings.odometry, {}, settings, progress);
}

/// What the path in the plane tells.
void take(PlanarMap plan, Estimate& estimate) {
  const Odometry& odometry = plan.odometry;
  estimate.open_loop = odometry.X_MB;
  estimate.degenerate = odometry.degenerate;
  if (odometry.lost > 0)
    estimate.notes.push_back(std::to_string(odometry.lost) + " scans could not be matched; their motion is predicted");
  if (odometry.uneven) {
    char text[120];
    std::snprintf(text, sizeof text,
                  "ribs are uneven: a scan finds them off the map by %.2f m, 1 sd, as the laser tilts",
                  odometry.rib_sigma_m);
    estimate.notes.push_back(text);
  }
  estimate.planar = std::move(plan.X_MB);
  estimate.rounds = std::move(plan.aligned.rounds);
  estimate.converged = plan.aligned.converged;
  estimate.closures = std::move(plan.aligned.closures);
  estimate.graph = std::move(plan.aligned.graph);
  estimate.covariance.assign(plan.aligned.covariance.begin(), plan.aligned.covariance.end());
  estimate.notes.insert(estimate.notes.end(), plan.aligned.notes.begin(), plan.aligned.notes.end());
}

bool nods(const Log& log) {
  return std::any_of(log.scans.begin(), log.scans.end(), [](const Scans& s) { return !s.tilt_rad.empty(); });
}

/// What the lasers other than the horizontal one add: path, points, surface, volume and notes. Leaves planar and grid alone.
/// Scans of tilted mounts are in `log` alone: what they see is in points and volume, the path does without them.
void add_height(const Log& level, const Log& log, const MapSettings& settings, const Progress& progress,
                Estimate& estimate) {
  TiltSolution tilt = solve_tilt(level, estimate.path.stamp_s, estimate.planar, settings.tilt, progress);
  if (!tilt.note.empty()) estimate.notes.push_back(tilt.note);
  estimate.path = std::move(tilt.path);
  const Log corrected = without_bias(nods(log) ? log : level, tilt.range_bias_m);
  estimate.points = map_points(corrected, tilt.dense, settings.volume, tilt.bias_covariance);
  for (const int m : tilt.biased)
    estimate.range_bias.push_back(
        {log.rig.mounts[m].name, tilt.range_bias_m[m], std::sqrt(tilt.bias_covariance(m, m))});
  MappedVoid mapped = map_void(corrected, tilt.dense, settings.volume, progress, tilt.bias_covariance);
  estimate.volume_m3 = mapped.volume_m3;
  estimate.volume_sigma_m3 = mapped.volume_sigma_m3;
  estimate.volume_parts = volume_parts(mapped, estimate.path, settings.volume);
  estimate.surface = std::move(mapped.surface);
  if (!mapped.volume_m3) estimate.notes.push_back("the rig has no upward laser: no surface and no volume");
}

// What is said of scans that are left out.
std::string share_of(size_t some, size_t all) {
  return std::to_string(some) + " of " + std::to_string(all) + " scans";
}

/// The scans of a laser whose stamps grow.
std::vector<size_t> in_order(const Scans& scans) {
  std::vector<size_t> good;
  for (size_t n = 0; n < scans.size(); ++n)
    if (std::isfinite(scans.stamp_s[n]) && (good.empty() || scans.stamp_s[n] > scans.stamp_s[good.back()]))
      good.push_back(n);
  return good;
}

bool all_in_order(const Log& log) {
  return std::all_of(log.scans.begin(), log.scans.end(),
                     [](const Scans& scans) { return in_order(scans).size() == scans.size(); });
}

/// A log without the scans whose stamps do not grow; how many there were goes into the notes.
Log put_in_order(const Log& log, std::vector<std::string>& notes) {
  Log sound{log.rig, {}};
  for (size_t i = 0; i < log.scans.size(); ++i) {
    const std::vector<size_t> good = in_order(log.scans[i]);
    sound.scans.push_back(chosen(log.scans[i], good));
    if (const size_t all = log.scans[i].size(); good.size() < all)
      notes.push_back("laser '" + log.rig.mounts[i].name + "': " + share_of(all - good.size(), all) +
                      " are left out: their stamps do not grow");
  }
  return sound;
}

/// What was recorded within [from_s, to_s].
Log between(const Log& log, double from_s, double to_s) {
  Log part{log.rig, {}};
  for (const Scans& all : log.scans) {
    std::vector<size_t> within;
    for (size_t n = 0; n < all.size(); ++n)
      if (all.stamp_s[n] >= from_s && all.stamp_s[n] <= to_s) within.push_back(n);
    part.scans.push_back(chosen(all, within));
  }
  return part;
}

struct Piece {
  size_t begin, end;  // scans of the horizontal laser
};

Piece longest_piece(const std::vector<size_t>& breaks, size_t scans) {
  Piece longest{0, 0};
  size_t begin = 0;
  for (size_t i = 0; i <= breaks.size(); ++i) {
    const size_t end = i < breaks.size() ? breaks[i] : scans;
    if (end - begin > longest.end - longest.begin) longest = {begin, end};
    begin = end;
  }
  return longest;
}

/// Of a log that falls into pieces the longest, mapped; the notes tell what is left out.
Estimate map_longest_piece(const Log& log, const std::vector<double>& stamp_s, const std::vector<size_t>& breaks,
                           const MapSettings& settings, const Progress& progress) {
  const Piece piece = longest_piece(breaks, stamp_s.size());
  const double from_s = stamp_s[piece.begin], to_s = stamp_s[piece.end - 1];
  char text[240];
  std::snprintf(text, sizeof text,
                "the log falls into %zu pieces that nothing connects, the first gap at %.2f s; mapped is the longest, "
                "%.2f s to %.2f s, %s",
                breaks.size() + 1, stamp_s[breaks.front() - 1], from_s, to_s,
                share_of(piece.end - piece.begin, stamp_s.size()).c_str());
  Estimate estimate = make_map(between(log, from_s, to_s), settings, progress);
  estimate.notes.insert(estimate.notes.begin(), text);
  return estimate;
}

}  // namespace

Fields fields(MapSettings& s) {
  Fields all{{"method", &s.method, "of the global alignment", {"robust", "icra2003"}}};
  append(all, "odometry", fields(s.odometry));
  append(all, "space", fields(s.space));
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

Estimate make_map(const Log& given, const MapSettings& settings, const Progress& progress) {
  Estimate estimate;
  const bool sound = all_in_order(given);
  const Log ordered = sound ? Log{} : put_in_order(given, estimate.notes);
  const Log& all = sound ? given : ordered;
  const Log level = nods(all) ? level_scans(all) : Log{};
  const Log& log = nods(all) ? level : all;
  const int h = horizontal_laser(log);
  const Scans& scans = log.scans[h];
  const Mount& mount = log.rig.mounts[h];
  estimate.method = settings.method;
  estimate.path.stamp_s = scans.stamp_s;

  Odometry odometry = estimate_motion(scans, mount, settings.odometry, progress);
  if (!odometry.breaks.empty()) {
    Estimate piece = map_longest_piece(all, scans.stamp_s, odometry.breaks, settings, progress);
    piece.notes.insert(piece.notes.begin(), estimate.notes.begin(), estimate.notes.end());
    return piece;
  }
  take(map_plan(log, h, std::move(odometry), settings, progress), estimate);

  // Height is mostly one factorisation on one thread: the grid is drawn beside it.
  parallel_for(2, [&](size_t task) {
    if (task == 0) add_height(log, all, settings, progress, estimate);
    if (task == 1) estimate.grid = map_grid(scans, mount, estimate.planar, settings.grid, settings.odometry.points);
  });
  return estimate;
}

}  // namespace adit
