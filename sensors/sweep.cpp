// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sweep.h"

#include "base/rng.h"
#include "sensors/motion.h"
#include "sensors/noise.h"

#include <algorithm>
#include <cmath>

namespace adit {

std::vector<double> scan_times(const Mount& mount, size_t index, double begin_s, double end_s,
                               const SensorSettings& settings, std::uint64_t seed) {
  const LaserModel& laser = mount.laser;
  double last_beam_s = 0;
  for (int k = 0; k < laser.beams; ++k) last_beam_s = std::max(last_beam_s, laser.beam_offset_s(k));
  std::vector<double> times;
  size_t lost = 0;
  for (size_t n = 0;; ++n) {
    // The link loses whole scans of the mirror, which itself keeps its beat.
    if (n > 0 && uniform(seed, Draw::laser_jitter, scan_address(index, n), 1) < settings.late) ++lost;
    const double t = begin_s + mount.phase_s + static_cast<double>(n) * laser.interval_s +
                     static_cast<double>(lost * static_cast<size_t>(laser.interlace)) * laser.turn_s;
    if (t + last_beam_s > end_s) return times;
    times.push_back(t);
  }
}

Sweep::Sweep(const Caster& caster, const Trajectory& path, const Mount& mount, size_t index, const Hull& hull,
             const SensorSettings& settings, std::uint64_t seed)
    : caster_(&caster),
      path_(&path),
      mount_(&mount),
      index_(index),
      settings_(&settings),
      seed_(seed),
      bias_m_(device_bias_m(mount.laser, index, settings, seed)),
      shadow_(own_shadow(hull, mount, settings.hull_reflectivity)) {
  for (int k = 0; k < mount.laser.beams; ++k) {
    angle_.push_back(mount.laser.beam_angle_rad(k));
    offset_s_.push_back(mount.laser.beam_offset_s(k));
  }
}

// Rays lie in the order of the angle, where neighbours meet the same rock; each turn of the mirror walks the path anew.
void Sweep::aim(double time_s, size_t scan, std::vector<Ray>& rays) const {
  const size_t turns = static_cast<size_t>(mount_->laser.interlace);
  Motion motion(*path_);
  for (size_t turn = 0; turn < turns; ++turn)
    for (size_t k = turn; k < rays.size(); k += turns) {
      const double a = angle_[k] + beam_angle_error_rad(*settings_, {seed_, scan_address(index_, scan), k});
      const Pose X_WS = motion.at(time_s + offset_s_[k]) * mount_->X_BS;
      rays[k].origin = X_WS.translation();
      rays[k].direction = (X_WS.linear() * Vec3(std::cos(a), std::sin(a), 0)).normalized();
    }
}

void Sweep::fire(size_t begin, size_t end, Scans& scans, ScanTruth& truth) const {
  const size_t beams = angle_.size();
  std::vector<Ray> rays(beams);
  std::vector<Hit> hits(beams);
  for (size_t scan = begin; scan < end; ++scan) {
    aim(truth.stamp_s[scan], scan, rays);
    caster_->nearest(rays, hits);
    for (size_t k = 0; k < beams; ++k) {
      const Meeting& own = shadow_[k];
      const Meeting met =
          own.range_m < hits[k].range_m ? own : meeting_of(caster_->mesh(), rays[k], hits[k], settings_->reflectivity);
      const size_t at = scan * beams + k;
      scans.range_m[at] = reading(mount_->laser, met, bias_m_, *settings_, {seed_, scan_address(index_, scan), k});
      truth.range_m[at] = static_cast<float>(met.range_m);
      truth.label[at] = static_cast<std::uint8_t>(met.label);
      truth.part[at] = met.part;
      truth.incidence_rad[at] = static_cast<float>(met.incidence_rad);
      truth.face[at] = met.face;
    }
  }
}

}  // namespace adit
