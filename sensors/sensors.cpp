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
#include <cstdio>

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
    r.truth.scans[i].stamp_s = scan_times(mount, i, begin_s, end_s, settings, seed);
    if (r.truth.scans[i].stamp_s.empty())
      throw Error("a drive of " + std::to_string(end_s - begin_s) + " s is too short for one scan of laser '" +
                  mount.name + "'");
    r.truth.scans[i].stamp_s = surviving(r.truth.scans[i].stamp_s, own, begin_s, i, seed);
    if (r.truth.scans[i].stamp_s.empty())
      throw Error("sensors.faults leave no scan of laser '" + mount.name + "'; take it out of the rig instead");
    r.log.scans[i].stamp_s = logged(r.truth.scans[i].stamp_s, i, settings, own, begin_s, seed);
  }
  return r;
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

  void fire(size_t begin, size_t end, Scans& scans, ScanTruth& truth) const {
    for (size_t i = 0; i < sweeps_.size(); ++i) {
      const size_t from = std::max(begin, first_[i]), to = std::min(end, first_[i + 1]);
      if (from < to) sweeps_[i].fire(from, to, scans, truth);
    }
  }

 private:
  std::vector<Mount> mounts_;
  std::vector<Sweep> sweeps_;
  std::vector<size_t> first_;  // scan of each sweep, and the end
};

}  // namespace

Recording record(const World& world, const Drive& drive, const Rig& nominal, const Hull& hull,
                 const SensorSettings& settings, std::uint64_t seed, const Progress& progress) {
  check(drive, nominal, settings);
  const std::vector<FaultPlan> faults = parse_faults(settings.faults, nominal);
  Recording r = blank(world, drive, nominal, settings, faults, seed);
  const Caster caster(world.mesh);
  for (const Mount& mount : r.truth.rig.mounts) check_open(caster, drive.path.X_WB.front(), mount);

  double total = 0, done = 0;
  for (const ScanTruth& truth : r.truth.scans) total += static_cast<double>(truth.stamp_s.size());
  for (size_t i = 0; i < r.truth.scans.size(); ++i) {
    const Mount& mount = r.truth.rig.mounts[i];
    Scans& scans = r.log.scans[i];
    ScanTruth& truth = r.truth.scans[i];
    make_room(mount, scans, truth);
    const std::vector<FaultPlan> own = faults_of(faults, mount.name);
    const SlippingSweep sweep(caster, drive, mount, i, hull, settings, own, truth, seed);
    constexpr size_t block = 1024, grain = 8;  // scans between two words of progress, and at a stretch on one thread
    for (size_t from = 0; from < truth.stamp_s.size(); from += block) {
      const size_t n = std::min(block, truth.stamp_s.size() - from);
      parallel_chunks(n, grain, [&](size_t b, size_t e) { sweep.fire(from + b, from + e, scans, truth); });
      done += static_cast<double>(n);
      progress("scans", done, total);
    }
    if (!own.empty()) freeze_and_mark(scans, truth, own, drive.path.stamp_s.front());
  }
  return r;
}

}  // namespace adit
