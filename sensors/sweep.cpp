// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sweep.h"

#include "base/rng.h"
#include "sensors/mirror.h"
#include "sensors/motion.h"
#include "sensors/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

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

struct Sweep::Shot {
  std::vector<Chance> chance;  // (beams)
  std::vector<Ray> axis;       // (beams)
  std::vector<Vec3> across;    // (beams), where there is a bundle
  std::vector<Hit> hit;        // (beams)
  std::vector<Ray> ray;        // (beams x rays beside the axis)
  std::vector<Glance> glance;
  std::vector<Return> returns;  // (rays) of one beam

  Shot(size_t beams, size_t rays)
      : chance(beams),
        axis(beams),
        across(beams),
        hit(beams),
        ray(beams * (rays - 1)),
        glance(ray.size()),
        returns(rays) {}
};

Sweep::Sweep(const Caster& caster, const Trajectory& path, const Mount& mount, size_t index, const Hull& hull,
             const SensorSettings& settings, std::uint64_t seed)
    : caster_(&caster),
      path_(&path),
      mount_(&mount),
      index_(index),
      settings_(&settings),
      seed_(seed),
      draws_(seed, Draw::beam_chance),
      device_(make_device(mount.laser, index, settings, seed)),
      bundle_(make_bundle(settings.sub_rays)),
      fan_(make_fan(mount, bundle_, hull, settings.hull_reflectivity)),
      water_(settings.water ? water_label() : std::nullopt) {}

namespace {

struct Unit {
  double cosine, sine;
};
// Of an angle that is mostly small.
Unit unit_of(double angle_rad) {
  const double q = angle_rad * angle_rad;
  if (q > 1e-3) return {std::cos(angle_rad), std::sin(angle_rad)};
  return {1 - q / 2 * (1 - q / 12 * (1 - q / 30)), angle_rad * (1 - q / 6 * (1 - q / 20))};
}

}  // namespace

// Rays lie in the order of the angle, where neighbours meet the same rock; each turn of the mirror walks the path anew.
void Sweep::aim(double time_s, std::uint64_t scan, Motion& motion, Shot& shot) const {
  const size_t turns = static_cast<size_t>(mount_->laser.interlace), beams = shot.axis.size();
  const Vec3& p_BS = mount_->X_BS.translation();
  draw_chances(draws_, scan, shot.chance);
  for (size_t turn = 0; turn < turns; ++turn)
    for (size_t k = turn; k < beams; k += turns) {
      const auto [c, s] = unit_of(beam_angle_error_rad(*settings_, shot.chance[k]));
      const Pose X_WB = motion.at(time_s + fan_.offset_s[k]);
      shot.axis[k].origin = X_WB * p_BS;
      shot.axis[k].direction = X_WB.linear() * Vec3(c * fan_.along[k] + s * fan_.across[k]);
      if (!shot.ray.empty()) shot.across[k] = X_WB.linear() * Vec3(c * fan_.across[k] - s * fan_.along[k]);
    }
}

// The rays of one spot stay together: they meet the same rock.
void Sweep::cast(Shot& shot) const {
  caster_->nearest(shot.axis, shot.hit);
  if (shot.ray.empty()) return;
  size_t at = 0;
  for (size_t k = 0; k < shot.axis.size(); ++k) {
    const Vec3 above = shot.axis[k].direction.cross(shot.across[k]);
    for (size_t i = 1; i < bundle_.place.size(); ++i)
      shot.ray[at++] = spot_ray(shot.axis[k], shot.across[k], above, mount_->laser, bundle_, i);
  }
  caster_->glance(shot.ray, shot.glance);
}

Meeting Sweep::axis_meeting(size_t beam, const Shot& shot) const {
  const Meeting& own = fan_.shadow[beam * bundle_.place.size()];
  if (own.range_m < shot.hit[beam].range_m) return own;
  return meeting_of(caster_->mesh(), shot.hit[beam], settings_->reflectivity);
}

// Fills the returns of a beam whose axis meets `axis`. Says whether any of them was seen in a mirror.
bool Sweep::gather(size_t beam, const Meeting& axis, Shot& shot) const {
  const Mesh& mesh = caster_->mesh();
  const size_t rays = bundle_.place.size();
  bool mirrored = false;
  const auto seen = [&](const Ray& ray, const Meeting& met) {
    if (!water_ || met.face < 0 || met.label != *water_) return met;
    const Meeting there = seen_in_water(*caster_, ray, met, settings_->reflectivity);
    mirrored = mirrored || there.range_m != met.range_m;
    return there;
  };
  const auto back = [&](size_t i, const Meeting& met) {
    return Return{met.range_m, bundle_.weight[i] * met.effective_reflectivity()};
  };
  shot.returns[0] = back(0, seen(shot.axis[beam], axis));
  for (size_t i = 1; i < rays; ++i) {
    const size_t at = beam * (rays - 1) + i - 1;
    const Glance& glance = shot.glance[at];
    const Meeting& own = fan_.shadow[beam * rays + i];
    const Hit hit{glance.range_m, glance.face, glance.cosine};
    shot.returns[i] =
        back(i, own.range_m < hit.range_m ? own : seen(shot.ray[at], meeting_of(mesh, hit, settings_->reflectivity)));
  }
  return mirrored;
}

void Sweep::tell(size_t beam, size_t scan, Shot& shot, Scans& scans, ScanTruth& truth) const {
  const size_t at = scan * shot.axis.size() + beam;
  const Meeting met = axis_meeting(beam, shot);
  const bool mirrored = gather(beam, met, shot);
  const double incidence_rad = met.incidence_rad();
  const double on_s = settings_->on_s + truth.stamp_s[scan] - path_->stamp_s.front();
  const Reading r = reading(device_, shot.returns, incidence_rad, *settings_, shot.chance[beam],
                            {seed_, scan_address(index_, scan), beam}, on_s);
  scans.range_m[at] = r.range_m;
  scans.code[at] = r.code;
  truth.range_m[at] = static_cast<float>(met.range_m);
  truth.label[at] = static_cast<std::uint8_t>(met.label);
  truth.part[at] = met.part;
  truth.incidence_rad[at] = static_cast<float>(std::isfinite(met.range_m) ? incidence_rad : 0.0);
  truth.face[at] = met.face;
  truth.surfaces[at] = r.surfaces;
  truth.fault[at] = r.fault | (mirrored ? trouble::ghost : 0);
}

// Daylight falls in where the mine is cut off at a portal.
void Sweep::dazzle(size_t scan, Scans& scans, const ScanTruth& truth) const {
  const int beams = mount_->laser.beams;
  const double step_deg = mount_->laser.fov_rad / (beams - 1) * 180 / std::numbers::pi;
  const int reach = static_cast<int>(settings_->dazzle_deg / step_deg);
  const size_t row = scan * static_cast<size_t>(beams);
  for (int k = 0; k < beams; ++k) {
    if (truth.label[row + static_cast<size_t>(k)] != static_cast<std::uint8_t>(Label::cap)) continue;
    for (int j = std::max(0, k - reach); j <= std::min(beams - 1, k + reach); ++j) {
      scans.range_m[row + static_cast<size_t>(j)] = std::numeric_limits<float>::quiet_NaN();
      scans.code[row + static_cast<size_t>(j)] = device_.model.codes ? Code::dazzled : Code::unreadable;
    }
  }
}

void Sweep::fire(size_t begin, size_t end, Scans& scans, ScanTruth& truth) const {
  Shot shot(fan_.along.size(), bundle_.place.size());
  Motion motion(*path_);
  for (size_t scan = begin; scan < end; ++scan) {
    aim(truth.stamp_s[scan], scan_address(index_, scan), motion, shot);
    cast(shot);
    for (size_t k = 0; k < shot.axis.size(); ++k) tell(k, scan, shot, scans, truth);
    if (settings_->dazzle_deg > 0) dazzle(scan, scans, truth);
  }
}

}  // namespace adit
