// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "rays/caster.h"
#include "sensors/faults.h"
#include "sensors/noise.h"
#include "sensors/sensors.h"
#include "sensors/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <utility>

namespace adit {
namespace {

constexpr double around_s = 0.5;  // of an instant, in which a vehicle stands there or does not

std::string place_name(const Vec3& p) {
  char text[96];
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", p.x(), p.y(), p.z());
  return text;
}

// A laser in the open sees the inner side of the rock all around; one in the rock sees it from behind, or nothing.
void check_open(const Caster& caster, const Pose& X_WB, const Mount& mount) {
  const Pose X_WS = X_WB * mount.X_BS;
  int before = 0, behind = 0;
  bool under_water = false;
  for (const Vec3& d : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(0, 0, 1), Vec3(0, 0, -1)}) {
    const Ray ray{X_WS.translation(), X_WS.linear() * d};
    const Hit hit = caster.nearest(ray);
    if (hit.face < 0) continue;
    const auto face = static_cast<size_t>(hit.face);
    const bool from_behind = caster.mesh().normal(face).dot(ray.direction) < 0;
    ++(from_behind ? behind : before);
    under_water =
        under_water || (from_behind && !caster.mesh().label.empty() && caster.mesh().label[face] == Label::water);
  }
  if (under_water)
    throw Error("laser '" + mount.name + "' starts under water at " + place_name(X_WS.translation()) +
                " m in W; raise its mount or begin the drive elsewhere");
  if (behind > before)
    throw Error("laser '" + mount.name + "' starts inside the rock at " + place_name(X_WS.translation()) +
                " m in W; move its mount or begin the drive elsewhere");
}

void check(const Rig& rig, const SensorSettings& settings) {
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

// Where the vehicle hardly moves within half a second before and after.
bool stands_at(const Trajectory& path, double t_s) {
  constexpr double still_m = 0.01;
  const Vec3 here = path.at(t_s).translation();
  return (path.at(t_s - around_s).translation() - here).norm() < still_m &&
         (path.at(t_s + around_s).translation() - here).norm() < still_m;
}

// How far a mount is tilted at each scan. One that nods at a stand does so once, and waits level for the drive to go on.
class Nod {
 public:
  explicit Nod(const Tilt& tilt) : tilt_(tilt) {}

  double at(double t_s, const Trajectory& path) {
    if (!since_s_) since_s_ = t_s;
    const bool stands = !tilt_.standing_only || stands_at(path, t_s);
    if (stands && !stood_) since_s_ = t_s;
    stood_ = stands;
    const bool nods = stands && (!tilt_.standing_only || t_s - *since_s_ < tilt_.period_s);
    return nods ? tilt_.at(t_s - *since_s_) : 0;
  }

 private:
  Tilt tilt_;
  std::optional<double> since_s_;
  bool stood_ = false;
};

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

template <class T>
std::vector<T> rows(const std::vector<T>& all, size_t from, size_t to) {
  if (all.empty()) return {};
  return {all.begin() + static_cast<std::ptrdiff_t>(from), all.begin() + static_cast<std::ptrdiff_t>(to)};
}

size_t first_from(const std::vector<double>& stamps, double from_s) {
  return static_cast<size_t>(std::lower_bound(stamps.begin(), stamps.end(), from_s) - stamps.begin());
}

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

// One laser on its drive: when it scans, where its mount is, what it told last.
class Laser {
 public:
  Laser(const Caster& caster, const Trajectory& path, const Mount& mount, size_t index, const Hull& hull,
        const SensorSettings& settings, std::vector<FaultPlan> faults, double begin_s, std::uint64_t seed)
      : settings_(settings),
        faults_(std::move(faults)),
        begin_s_(begin_s),
        index_(index),
        seed_(seed),
        beat_(mount, index, begin_s, settings, seed),
        nod_(mount.tilt) {
    // A sweep for each place that the mount has, until it slips again.
    slips_ = {begin_s};
    for (const FaultPlan& f : faults_)
      if (f.kind == FaultPlan::Kind::slips) slips_.push_back(begin_s + f.from_s);
    std::sort(slips_.begin() + 1, slips_.end());
    mounts_.assign(slips_.size(), mount);
    for (size_t i = 0; i < slips_.size(); ++i) {
      mounts_[i].X_BS = slipped_mount(mount.X_BS, slips_[i], faults_, begin_s);
      sweeps_.emplace_back(caster, path, mounts_[i], index, hull, settings_, begin_s, seed);
    }
  }
  Laser(const Laser&) = delete;  // the sweeps point into it
  Laser& operator=(const Laser&) = delete;

  // Stamps and tilts of the scans that begin before to_s and end by end_s, and room for what they tell.
  void plan(double to_s, double end_s, const Trajectory& path, Scans& log, ScanTruth& truth) {
    for (; beat_.time_s() < to_s && beat_.time_s() + beat_.scan_s() <= end_s; beat_.next()) {
      const double t = beat_.time_s();
      ++beats_;
      if (!survives(t, beat_.number(), faults_, begin_s_, index_, seed_)) continue;
      // What is logged is when the computer believes that a scan began.
      const double late_s = settings_.latency ? mounts_[0].laser.latency_s : 0;
      log.stamp_s.push_back(t + clock_error_s(t, faults_, begin_s_) + jitter(first_ + truth.stamp_s.size()) + late_s);
      truth.stamp_s.push_back(t);
      if (mounts_[0].tilt.nods()) truth.tilt_rad.push_back(nod_.at(t, path));
    }
    log.tilt_rad = truth.tilt_rad;
    make_room(mounts_[0], log, truth);
  }

  // Rows [begin, end) of what was planned last.
  void fire(size_t begin, size_t end, Scans& log, ScanTruth& truth) const {
    for (size_t i = 0; i < sweeps_.size(); ++i) {
      const size_t from = i == 0 ? 0 : first_from(truth.stamp_s, slips_[i]),
                   to = i + 1 == sweeps_.size() ? truth.stamp_s.size() : first_from(truth.stamp_s, slips_[i + 1]);
      if (std::max(begin, from) < std::min(end, to))
        sweeps_[i].fire(std::max(begin, from), std::min(end, to), first_, log, truth);
    }
  }

  // All rows of the plan are fired.
  void settle(Scans& log, ScanTruth& truth) {
    if (log.size() == 0) return;
    if (!faults_.empty()) freeze_and_mark(log, truth, before_, faults_, begin_s_);
    before_ = last_of(log);
    first_ += log.size();
  }

  double scan_s() const { return beat_.scan_s(); }
  size_t beats() const { return beats_; }
  size_t scans() const { return first_; }

 private:
  double jitter(size_t scan) const {
    return settings_.jitter_s * (2 * uniform(seed_, Draw::laser_jitter, scan_address(index_, scan), 0) - 1);
  }

  SensorSettings settings_;
  std::vector<FaultPlan> faults_;
  double begin_s_;
  size_t index_;
  std::uint64_t seed_;
  Beat beat_;
  Nod nod_;
  std::vector<double> slips_;
  std::vector<Mount> mounts_;
  std::vector<Sweep> sweeps_;
  size_t beats_ = 0;  // that were planned
  size_t first_ = 0;  // scan that the next plan begins with
  Scans before_;      // and the one before it
};

}  // namespace

struct Recorder::Impl {
  Impl(const World& world, const Rig& nominal, const Hull& hull, const SensorSettings& settings, std::uint64_t seed,
       double piece_s, Take take)
      : hull(hull),
        settings(settings),
        seed(seed),
        piece_s(piece_s),
        take(std::move(take)),
        world(world_hash(world)),
        nominal(nominal),
        true_rig(adit::true_rig(nominal, settings, seed)),
        faults(parse_faults(settings.faults, nominal)),
        caster(world.mesh) {
    check(nominal, settings);
    // When a laser begins is no secret: its stamps tell.
    for (size_t i = 0; i < nominal.mounts.size(); ++i) this->nominal.mounts[i].phase_s = true_rig.mounts[i].phase_s;
  }

  void add(const Drive& stretch);

 private:
  void begin();
  void piece(double to_s, bool last);
  void check_scans() const;
  void forget(double before_s);

  const Hull& hull;
  const SensorSettings& settings;
  std::uint64_t seed;
  double piece_s;
  Take take;
  std::string world;
  Rig nominal, true_rig;
  std::vector<FaultPlan> faults;
  Caster caster;
  Drive drive;                     // what is known of it, of its path what is still needed
  double begin_s = 0, from_s = 0;  // of the drive, of the next piece
  size_t pieces = 0;
  std::vector<std::unique_ptr<Laser>> lasers;
};

void Recorder::Impl::begin() {
  begin_s = from_s = drive.path.stamp_s.front();
  for (size_t i = 0; i < true_rig.mounts.size(); ++i) {
    const Mount& mount = true_rig.mounts[i];
    check_open(caster, drive.path.X_WB.front(), mount);
    lasers.push_back(std::make_unique<Laser>(caster, drive.path, mount, i, hull, settings_of(settings, true_rig, i),
                                             faults_of(faults, mount.name), begin_s, seed));
  }
}

void Recorder::Impl::add(const Drive& stretch) {
  append(drive, stretch);
  const bool over = drive.end != DriveEnd::underway;
  if (drive.path.size() < 2) {
    if (over) throw Error("a drive of fewer than two poses cannot be recorded");
    return;
  }
  if (lasers.empty()) begin();
  double ahead_s = around_s;  // that the scans of a piece need to know of the path beyond it
  for (const auto& laser : lasers) ahead_s = std::max(ahead_s, 2 * laser->scan_s());
  const double end_s = drive.path.stamp_s.back();
  const auto next_s = [&] { return begin_s + static_cast<double>(pieces + 1) * piece_s; };
  while (next_s() + (over ? 0 : ahead_s) < end_s) piece(next_s(), false);
  if (over) piece(std::numeric_limits<double>::infinity(), true);
}

// What happens from from_s until to_s.
void Recorder::Impl::piece(double to_s, bool last) {
  const size_t n = lasers.size();
  Recording piece{.log = {nominal, std::vector<Scans>(n)}, .truth = {world, {}, true_rig, std::vector<ScanTruth>(n)}};
  const Trajectory& path = drive.path;
  const size_t p = first_from(path.stamp_s, from_s), q = first_from(path.stamp_s, to_s);
  piece.truth.drive = {drive.route,    {rows(path.stamp_s, p, q), rows(path.X_WB, p, q)},
                       drive.end,      drive.cause,
                       drive.driven_m, drive.ground};
  for (size_t i = 0; i < n; ++i)
    lasers[i]->plan(to_s, path.stamp_s.back(), path, piece.log.scans[i], piece.truth.scans[i]);
  const std::vector<Job> jobs = jobs_of(piece);
  parallel_for(jobs.size(), [&](size_t j) {
    const Job& job = jobs[j];
    lasers[job.laser]->fire(job.begin, job.end, piece.log.scans[job.laser], piece.truth.scans[job.laser]);
  });
  for (size_t i = 0; i < n; ++i) lasers[i]->settle(piece.log.scans[i], piece.truth.scans[i]);
  if (last) check_scans();
  take(std::move(piece));
  ++pieces;
  from_s = to_s;
  if (!last) forget(to_s - around_s);
}

void Recorder::Impl::check_scans() const {
  for (size_t i = 0; i < lasers.size(); ++i) {
    const std::string& name = true_rig.mounts[i].name;
    if (lasers[i]->beats() == 0)
      throw Error("a drive of " + std::to_string(drive.path.stamp_s.back() - begin_s) +
                  " s is too short for one scan of laser '" + name + "'");
    if (lasers[i]->scans() == 0)
      throw Error("sensors.faults leave no scan of laser '" + name + "'; take it out of the rig instead");
  }
}

// Of the path before an instant all but the two poses next to it.
void Recorder::Impl::forget(double before_s) {
  Trajectory& path = drive.path;
  const auto gone = static_cast<std::ptrdiff_t>(first_from(path.stamp_s, before_s)) - 2;
  if (gone <= 0) return;
  path.stamp_s.erase(path.stamp_s.begin(), path.stamp_s.begin() + gone);
  path.X_WB.erase(path.X_WB.begin(), path.X_WB.begin() + gone);
}

Recorder::Recorder(const World& world, const Rig& nominal, const Hull& hull, const SensorSettings& settings,
                   std::uint64_t seed, double piece_s, Take take)
    : impl_(std::make_unique<Impl>(world, nominal, hull, settings, seed, piece_s, std::move(take))) {}
Recorder::~Recorder() = default;

void Recorder::add(const Drive& stretch) {
  impl_->add(stretch);
}

void append(Recording& recording, const Recording& later) {
  append(recording.log, later.log);
  append(recording.truth, later.truth);
}

Recording record(const World& world, const Drive& drive, const Rig& nominal, const Hull& hull,
                 const SensorSettings& settings, std::uint64_t seed) {
  Recording whole;
  Recorder recorder(world, nominal, hull, settings, seed, 60, [&](Recording&& piece) {
    if (whole.log.scans.empty())
      whole = std::move(piece);
    else
      append(whole, piece);
  });
  recorder.add(drive);
  return whole;
}

}  // namespace adit
