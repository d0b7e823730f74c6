// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sensors.h"

#include "base/error.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "rays/caster.h"
#include "sensors/faults.h"
#include "sensors/noise.h"
#include "sensors/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace adit {
namespace {

std::string place_name(const Vec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", p.x(), p.y(), p.z());
  return text;
}

// A laser in the open sees the inner side of the rock all around; one in the rock sees it from behind, or nothing.
void check_open(const Caster& caster, const Pose& X_WB, const Mount& mount) {
  const Pose X_WS = X_WB * mount.X_BS;
  int before = 0, behind = 0;
  for (const Vec3& d : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    const Ray ray{X_WS.translation(), X_WS.linear() * d};
    const Hit hit = caster.nearest(ray);
    if (hit.face < 0) continue;
    ++(caster.mesh().normal(static_cast<size_t>(hit.face)).dot(ray.direction) < 0 ? behind : before);
  }
  if (behind > before)
    throw Error("laser '" + mount.name + "' starts inside the rock at " + place_name(X_WS.translation()) +
                " m in W; lower its mount or begin the drive elsewhere");
}

void check(const Drive& drive, const Rig& rig, const SensorSettings& settings) {
  if (drive.path.size() < 2) throw Error("a drive of fewer than two poses cannot be recorded");
  if (settings.crosstalk > 0 && rig.mounts.size() < 2)
    throw Error("sensors.crosstalk needs a second laser; the rig '" + rig.name + "' has one");
  for (const Mount& mount : rig.mounts) {
    const double scan_s = mount.laser.turn_s * mount.laser.interlace;
    if (settings.jitter_s * 2 >= scan_s)
      throw Error("sensors.jitter_s = " + std::to_string(settings.jitter_s) + " is too large for laser '" + mount.name +
                  "': it must be less than half of one scan's " + std::to_string(scan_s) +
                  " s, or stamps go backwards");
  }
}

// What is logged is when the computer believes that a scan began.
std::vector<double> logged(const std::vector<double>& times, size_t mount, const SensorSettings& settings,
                           const std::vector<FaultPlan>& faults, double begin_s, std::uint64_t seed) {
  std::vector<double> stamps = times;
  for (size_t n = 0; n < stamps.size(); ++n)
    stamps[n] += clock_error_s(times[n], faults, begin_s) +
                 settings.jitter_s * (2 * uniform(seed, Draw::laser_jitter, scan_address(mount, n), 0) - 1);
  return stamps;
}

// Where the vehicle hardly moves within half a second before and after.
bool stands_at(const Trajectory& path, double t_s) {
  constexpr double around_s = 0.5, still_m = 0.01;
  const Vec3 here = path.at(t_s).translation();
  return (path.at(t_s - around_s).translation() - here).norm() < still_m &&
         (path.at(t_s + around_s).translation() - here).norm() < still_m;
}

// How far the mount is tilted at each scan. One that nods at a stand does so once, and waits level for the drive to go on.
std::vector<double> tilts(const Tilt& tilt, const std::vector<double>& stamps, const Trajectory& path) {
  std::vector<double> tilts;
  double since_s = stamps.front();
  bool stood = false;
  for (const double t : stamps) {
    const bool stands = !tilt.standing_only || stands_at(path, t);
    if (stands && !stood) since_s = t;
    stood = stands;
    const bool nods = stands && (!tilt.standing_only || t - since_s < tilt.period_s);
    tilts.push_back(nods ? tilt.at(t - since_s) : 0);
  }
  return tilts;
}

void make_room(const Mount& mount, Scans& log, ScanTruth& truth) {
  const size_t n = truth.stamp_s.size() * static_cast<size_t>(mount.laser.beams);
  log.beams = mount.laser.beams;
  log.range_m.resize(n);
  log.code.resize(n);
  truth.range_m.resize(n);
  truth.label.resize(n);
  truth.part.resize(n);
  truth.incidence_rad.resize(n);
  truth.face.resize(n);
  truth.passage.resize(n);
  truth.surfaces.resize(n);
  truth.fault.resize(n);
}

// Rigs and stamps are settled, the ranges are still to be measured.
Recording blank(const World& world, const Drive& drive, const Rig& nominal, const SensorSettings& settings,
                const std::vector<FaultPlan>& faults, std::uint64_t seed) {
  const size_t lasers = nominal.mounts.size();
  Recording r{.log = {nominal, std::vector<Scans>(lasers)},
              .truth = {world_hash(world), drive, true_rig(nominal, settings, seed), std::vector<ScanTruth>(lasers)}};
  const double begin_s = drive.path.stamp_s.front(), end_s = drive.path.stamp_s.back();
  for (size_t i = 0; i < lasers; ++i) {
    const Mount& mount = r.truth.rig.mounts[i];
    // When a laser begins is no secret: its stamps tell.
    r.log.rig.mounts[i].phase_s = mount.phase_s;
    const std::vector<FaultPlan> own = faults_of(faults, mount.name);
    std::vector<double>& stamps = r.truth.scans[i].stamp_s;
    stamps = scan_times(mount, i, begin_s, end_s, settings, seed);
    if (stamps.empty())
      throw Error("a drive of " + std::to_string(end_s - begin_s) + " s is too short for one scan of laser '" +
                  mount.name + "'");
    stamps = surviving(stamps, own, begin_s, i, seed);
    if (stamps.empty())
      throw Error("sensors.faults leave no scan of laser '" + mount.name + "'; take it out of the rig instead");
    r.log.scans[i].stamp_s = logged(stamps, i, settings, own, begin_s, seed);
    if (mount.tilt.nods()) r.log.scans[i].tilt_rad = r.truth.scans[i].tilt_rad = tilts(mount.tilt, stamps, drive.path);
  }
  return r;
}

template <class T>
std::vector<T> rows(const std::vector<T>& all, size_t from, size_t to) {
  if (all.empty()) return {};
  return {all.begin() + static_cast<std::ptrdiff_t>(from), all.begin() + static_cast<std::ptrdiff_t>(to)};
}

size_t first_from(const std::vector<double>& stamps, double from_s) {
  return static_cast<size_t>(std::lower_bound(stamps.begin(), stamps.end(), from_s) - stamps.begin());
}

// What of a blank recording happens from from_s until to_s, with room for its ranges.
Recording piece_of(const Recording& whole, double from_s, double to_s) {
  const size_t lasers = whole.log.scans.size();
  const Trajectory& path = whole.truth.drive.path;
  Recording piece{.log = {whole.log.rig, std::vector<Scans>(lasers)},
                  .truth = {whole.truth.world, {}, whole.truth.rig, std::vector<ScanTruth>(lasers)}};
  const size_t p = first_from(path.stamp_s, from_s), q = first_from(path.stamp_s, to_s);
  const Drive& drive = whole.truth.drive;
  piece.truth.drive = {drive.route,    {rows(path.stamp_s, p, q), rows(path.X_WB, p, q)},
                       drive.end,      drive.cause,
                       drive.driven_m, drive.ground};
  for (size_t i = 0; i < lasers; ++i) {
    const ScanTruth& all = whole.truth.scans[i];
    const size_t a = first_from(all.stamp_s, from_s), b = first_from(all.stamp_s, to_s);
    piece.truth.scans[i].stamp_s = rows(all.stamp_s, a, b);
    piece.truth.scans[i].tilt_rad = rows(all.tilt_rad, a, b);
    piece.log.scans[i].stamp_s = rows(whole.log.scans[i].stamp_s, a, b);
    piece.log.scans[i].tilt_rad = rows(whole.log.scans[i].tilt_rad, a, b);
    make_room(whole.truth.rig.mounts[i], piece.log.scans[i], piece.truth.scans[i]);
  }
  return piece;
}

// One laser over its whole drive: a sweep for each place that its mount has, until it slips again.
class SlippingSweep {
 public:
  SlippingSweep(const Caster& caster, const Drive& drive, const Mount& mount, size_t index, const Hull& hull,
                const SensorSettings& settings, const std::vector<FaultPlan>& faults, const ScanTruth& truth,
                std::uint64_t seed) {
    const double begin_s = drive.path.stamp_s.front();
    std::vector<double> slips;
    for (const FaultPlan& f : faults)
      if (f.kind == FaultPlan::Kind::slips) slips.push_back(begin_s + f.from_s);
    std::sort(slips.begin(), slips.end());
    slips.insert(slips.begin(), begin_s);
    mounts_.reserve(slips.size());
    for (double since_s : slips) {
      mounts_.push_back(mount);
      mounts_.back().X_BS = slipped_mount(mount.X_BS, since_s, faults, begin_s);
      sweeps_.emplace_back(caster, drive.path, mounts_.back(), index, hull, settings, seed);
      first_.push_back(static_cast<size_t>(std::lower_bound(truth.stamp_s.begin(), truth.stamp_s.end(), since_s) -
                                           truth.stamp_s.begin()));
    }
    first_.push_back(truth.stamp_s.size());
    first_.front() = 0;
  }

  // Rows [begin, end) of arrays whose row 0 is scan `first` of the drive.
  void fire(size_t begin, size_t end, size_t first, Scans& scans, ScanTruth& truth) const {
    for (size_t i = 0; i < sweeps_.size(); ++i) {
      const size_t from = std::max(first + begin, first_[i]), to = std::min(first + end, first_[i + 1]);
      if (from < to) sweeps_[i].fire(from - first, to - first, first, scans, truth);
    }
  }

 private:
  std::vector<Mount> mounts_;
  std::vector<Sweep> sweeps_;
  std::vector<size_t> first_;  // scan of each sweep, and the end
};

// Lasers nearer than 6 m to one another may hear each other (telegram listing 8007954); that the share falls evenly to
// there is assumed. The nearest laser counts.
SensorSettings settings_of(const SensorSettings& settings, const Rig& rig, size_t laser) {
  constexpr double reach_m = 6;
  double nearest_m = reach_m;
  for (size_t j = 0; j < rig.mounts.size(); ++j)
    if (j != laser)
      nearest_m = std::min(nearest_m, (rig.mounts[j].X_BS.translation() - rig.mounts[laser].X_BS.translation()).norm());
  SensorSettings own = settings;
  own.crosstalk *= 1 - nearest_m / reach_m;
  return own;
}

// A laser's scans that one thread fires at a stretch.
struct Job {
  size_t laser, begin, end;
};

std::vector<Job> jobs_of(const Recording& piece) {
  constexpr size_t grain = 8;
  std::vector<Job> jobs;
  for (size_t i = 0; i < piece.truth.scans.size(); ++i)
    for (size_t n = 0; n < piece.truth.scans[i].stamp_s.size(); n += grain)
      jobs.push_back({i, n, std::min(n + grain, piece.truth.scans[i].stamp_s.size())});
  return jobs;
}

Scans last_of(const Scans& scans) {
  const auto beams = static_cast<std::ptrdiff_t>(scans.beams);
  Scans last;
  last.beams = scans.beams;
  last.stamp_s.assign(scans.stamp_s.end() - 1, scans.stamp_s.end());
  last.range_m.assign(scans.range_m.end() - beams, scans.range_m.end());
  last.code.assign(scans.code.end() - beams, scans.code.end());
  return last;
}

}  // namespace

void record(const World& world, const Drive& drive, const Rig& nominal, const Hull& hull,
            const SensorSettings& settings, std::uint64_t seed, double piece_s,
            const std::function<void(Recording&&)>& take, const Progress& progress) {
  check(drive, nominal, settings);
  const std::vector<FaultPlan> faults = parse_faults(settings.faults, nominal);
  const Recording whole = blank(world, drive, nominal, settings, faults, seed);
  const Caster caster(world.mesh);
  const size_t lasers = nominal.mounts.size();
  std::vector<SensorSettings> own_settings;
  for (size_t i = 0; i < lasers; ++i) own_settings.push_back(settings_of(settings, whole.truth.rig, i));
  std::vector<SlippingSweep> sweeps;
  double total = 0, done = 0;
  for (size_t i = 0; i < lasers; ++i) {
    const Mount& mount = whole.truth.rig.mounts[i];
    check_open(caster, drive.path.X_WB.front(), mount);
    sweeps.emplace_back(caster, drive, mount, i, hull, own_settings[i], faults_of(faults, mount.name),
                        whole.truth.scans[i], seed);
    total += static_cast<double>(whole.truth.scans[i].stamp_s.size());
  }
  std::vector<size_t> first(lasers, 0);  // scan of each laser that the next piece begins with
  std::vector<Scans> before(lasers);     // and the one before it
  const double begin_s = drive.path.stamp_s.front(), end_s = drive.path.stamp_s.back();
  const size_t pieces = std::max<size_t>(1, static_cast<size_t>(std::ceil((end_s - begin_s) / piece_s)));
  for (size_t p = 0; p < pieces; ++p) {
    const double from_s = begin_s + static_cast<double>(p) * piece_s;
    Recording piece =
        piece_of(whole, from_s, p + 1 == pieces ? std::numeric_limits<double>::infinity() : from_s + piece_s);
    const std::vector<Job> jobs = jobs_of(piece);
    parallel_for(jobs.size(), [&](size_t j) {
      const Job& job = jobs[j];
      sweeps[job.laser].fire(job.begin, job.end, first[job.laser], piece.log.scans[job.laser],
                             piece.truth.scans[job.laser]);
    });
    for (size_t i = 0; i < lasers; ++i) {
      Scans& scans = piece.log.scans[i];
      if (scans.size() == 0) continue;
      if (const auto own = faults_of(faults, nominal.mounts[i].name); !own.empty())
        freeze_and_mark(scans, piece.truth.scans[i], before[i], own, begin_s);
      before[i] = last_of(scans);
      first[i] += scans.size();
      done += static_cast<double>(scans.size());
    }
    take(std::move(piece));
    progress("scans", done, total);
  }
}

Recording record(const World& world, const Drive& drive, const Rig& nominal, const Hull& hull,
                 const SensorSettings& settings, std::uint64_t seed, const Progress& progress) {
  Recording whole;
  const auto take = [&](Recording&& piece) {
    if (whole.log.scans.empty()) {
      whole = std::move(piece);
    } else {
      append(whole.log, piece.log);
      append(whole.truth, piece.truth);
    }
  };
  record(world, drive, nominal, hull, settings, seed, 60, take, progress);
  return whole;
}

}  // namespace adit
