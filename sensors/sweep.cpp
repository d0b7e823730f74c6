// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sweep.h"

#include "base/error.h"
#include "base/rng.h"
#include "sensors/mirror.h"
#include "sensors/motion.h"
#include "sensors/noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {

Beat::Beat(const Mount& mount, size_t index, double begin_s, const SensorSettings& settings, std::uint64_t seed)
    : from_s_(begin_s + mount.phase_s),
      interval_s_(mount.laser.interval_s),
      mirror_scan_s_(static_cast<double>(mount.laser.interlace) * mount.laser.turn_s),
      late_(settings.late),
      index_(index),
      seed_(seed) {
  for (int k = 0; k < mount.laser.beams; ++k) scan_s_ = std::max(scan_s_, mount.laser.beam_offset_s(k));
}

double Beat::time_s() const {
  return from_s_ + static_cast<double>(number_) * interval_s_ + static_cast<double>(lost_) * mirror_scan_s_;
}

// The link loses whole scans of the mirror, which itself keeps its beat.
void Beat::next() {
  ++number_;
  if (uniform(seed_, Draw::laser_jitter, scan_address(index_, number_), 1) < late_) ++lost_;
}

// What a few scans need on their way. Columns are (scans x beams).
struct Sweep::Shot {
  Chances chance;
  std::vector<double> error_rad;  // (beams) of the scan that is being aimed
  RayColumns<double> axis;
  Directions left;  // where there is a bundle
  HitColumns<double> hit;
  std::vector<float> incidence_rad;  // (beams) of the scan that is being told
  // The rays beside the axes of one scan's beams. (beams x others)
  RayColumns<float> ray;
  HitColumns<float> glance;
  std::vector<Return> returns;  // (rays) of one beam
};

Sweep::Sweep(const Caster& caster, const Trajectory& path, const Mount& mount, size_t index, const Hull& hull,
             const SensorSettings& settings, double begin_s, std::uint64_t seed)
    : caster_(&caster),
      path_(&path),
      mount_(&mount),
      hull_(&hull),
      index_(index),
      settings_(&settings),
      begin_s_(begin_s),
      seed_(seed),
      draws_(seed, Draw::beam_chance),
      device_(make_device(mount.laser, index, settings, seed)),
      bundle_(make_bundle(settings.sub_rays)),
      fan_(make_fan(mount, bundle_, hull, settings.hull_reflectivity)),
      aim_(fan_, mount.X_BS.translation(), mount.laser.interlace) {
  const double lean = mount.laser.divergence_rad / 2;
  for (size_t i = 1; i < bundle_.place.size(); ++i) {
    other_.x.push_back(static_cast<float>(bundle_.place[i].x()));
    other_.y.push_back(static_cast<float>(bundle_.place[i].y()));
    other_.shorter.push_back(static_cast<float>(1 / std::sqrt(1 + lean * lean * bundle_.place[i].squaredNorm())));
  }
  const std::vector<Label>& labels = caster.mesh().label;
  if (settings.water && water_label() && std::find(labels.begin(), labels.end(), *water_label()) != labels.end())
    water_ = water_label();
}

namespace {

constexpr size_t together = 8;  // scans

// The arc cosine of 0 to 1, within 2e-12: sqrt(1 - x) times a polynomial fitted at Chebyshev's points; by Horner.
void arcs(const double* cosine, float* arc, size_t n) {
  constexpr double c[] = {1.5707963267930549,    -0.21460183596158758,   0.089048585383781936,  -0.050791961627552486,
                          0.033671015598772724,  -0.024299699958938797,  0.018317342976662546,  -0.013721481319958496,
                          0.0094804194842250718, -0.0054830891717620768, 0.0023684400920601519, -0.00065621382841909884,
                          8.5713914107703618e-05};
  for (size_t k = 0; k < n; ++k) {
    const double x = std::min(std::abs(cosine[k]), 1.0);
    double sum = c[12];
    for (int i = 11; i >= 0; --i) sum = sum * x + c[i];
    arc[k] = static_cast<float>(std::sqrt(1 - x) * sum);
  }
}

}  // namespace

MountFan Sweep::tilted_fan(double tilt_rad) const {
  Mount mount = *mount_;
  mount.X_BS = mount.X_BS_at(tilt_rad);
  return make_fan(mount, bundle_, *hull_, settings_->hull_reflectivity);
}

void Sweep::aim(const Aim& aim, double time_s, std::uint64_t scan, size_t at, Motion& motion, Shot& shot) const {
  constexpr double degree = std::numbers::pi / 180;
  const size_t beams = aim.beams();
  const LaserModel& m = device_.model;
  const bool noisy = settings_->noise && (m.sigma_m > 0 || m.spot_m > 0 || m.divergence_rad > 0);
  draw_chances(draws_, scan, beams, noisy || settings_->beam_angle_deg > 0, shot.chance, at);
  for (size_t k = 0; k < beams; ++k) shot.error_rad[k] = settings_->beam_angle_deg * degree * shot.chance.angle[at + k];
  aim.rays(time_s, shot.error_rad, motion, shot.axis, at, bundle_.place.size() > 1 ? &shot.left : nullptr);
}

// The spots' other rays. Those of one spot stay together: they meet the same rock.
void Sweep::spread(size_t at, Shot& shot) const {
  const size_t others = bundle_.place.size() - 1, beams = fan_.along.size();
  const float wide = static_cast<float>(mount_->laser.spot_m / 2),
              lean = static_cast<float>(mount_->laser.divergence_rad / 2);
  shot.ray.resize(beams * others);
  const Vec3& middle = caster_->middle();
  for (size_t k = 0; k < beams; ++k) {
    const RayColumns<double>& axis = shot.axis;
    const Vec3 d(axis.dx[at + k], axis.dy[at + k], axis.dz[at + k]);
    const Vec3 left(shot.left.x[at + k], shot.left.y[at + k], shot.left.z[at + k]), above = d.cross(left);
    const Eigen::Vector3f o = (Vec3(axis.x[at + k], axis.y[at + k], axis.z[at + k]) - middle).cast<float>(),
                          a = d.cast<float>(), l = left.cast<float>(), u = above.cast<float>();
    const float *px = other_.x.data(), *py = other_.y.data(), *shorter = other_.shorter.data();
    const auto axis_of = [&](int i, float* from, float* to) {
      const float oi = o[i], ai = a[i], li = l[i], ui = u[i];
      for (size_t j = 0; j < others; ++j) {
        const float off = px[j] * li + py[j] * ui;
        from[j] = oi + wide * off;
        to[j] = (ai + lean * off) * shorter[j];
      }
    };
    const size_t to = k * others;
    axis_of(0, &shot.ray.x[to], &shot.ray.dx[to]);
    axis_of(1, &shot.ray.y[to], &shot.ray.dy[to]);
    axis_of(2, &shot.ray.z[to], &shot.ray.dz[to]);
  }
  caster_->glance(shot.ray, shot.glance);
}

// What a ray of the world met, or of the vehicle before that.
Meeting Sweep::meeting(const Meeting& own, double range_m, std::int32_t face, double cosine) const {
  if (own.range_m < range_m) return own;
  return meeting_of(caster_->mesh(), {range_m, face, cosine}, settings_->reflectivity);
}

// Fills the returns of a beam whose axis meets `axis`. Says whether any of them was seen in a mirror.
bool Sweep::gather(const MountFan& fan, size_t beam, size_t at, const Meeting& axis, Shot& shot) const {
  const size_t rays = bundle_.place.size();
  shot.returns[0] = {axis.range_m, bundle_.weight[0] * axis.effective_reflectivity()};
  const std::vector<float>& reflectivity = caster_->mesh().reflectivity;
  const size_t first = beam * (rays - 1);
  for (size_t i = 1; i < rays; ++i) {
    const size_t j = first + i - 1;
    const Meeting& own = fan.shadow[beam * rays + i];
    const std::int32_t face = shot.glance.face[j];
    const double range_m = static_cast<double>(shot.glance.range_m[j]);
    const double reflects = face < 0               ? 0
                            : reflectivity.empty() ? settings_->reflectivity
                                                   : static_cast<double>(reflectivity[static_cast<size_t>(face)]);
    shot.returns[i] =
        own.range_m < range_m
            ? Return{own.range_m, bundle_.weight[i] * own.effective_reflectivity()}
            : Return{range_m, bundle_.weight[i] * reflects * std::abs(static_cast<double>(shot.glance.cosine[j]))};
  }
  return water_ && mirror(fan, beam, at, axis, shot);
}

// Sees in water what lies beyond it.
bool Sweep::mirror(const MountFan& fan, size_t beam, size_t at, const Meeting& axis, Shot& shot) const {
  const size_t rays = bundle_.place.size();
  bool mirrored = false;
  for (size_t i = 0; i < rays; ++i) {
    const size_t j = beam * (rays - 1) + i - 1;
    const Meeting met = i == 0 ? axis
                               : meeting(fan.shadow[beam * rays + i], static_cast<double>(shot.glance.range_m[j]),
                                         shot.glance.face[j], static_cast<double>(shot.glance.cosine[j]));
    if (met.face < 0 || met.label != *water_) continue;
    const RayColumns<double>& a = shot.axis;
    Ray ray{{a.x[at + beam], a.y[at + beam], a.z[at + beam]}, {a.dx[at + beam], a.dy[at + beam], a.dz[at + beam]}};
    if (i > 0)
      ray = {Eigen::Vector3f(shot.ray.x[j], shot.ray.y[j], shot.ray.z[j]).cast<double>() + caster_->middle(),
             Eigen::Vector3f(shot.ray.dx[j], shot.ray.dy[j], shot.ray.dz[j]).cast<double>().normalized()};
    const Meeting there = seen_in_water(*caster_, ray, met, settings_->reflectivity);
    mirrored = mirrored || there.range_m != met.range_m;
    shot.returns[i] = {there.range_m, bundle_.weight[i] * there.effective_reflectivity()};
  }
  return mirrored;
}

void Sweep::tell(const MountFan& fan, size_t at, std::uint64_t scan, size_t row, Shot& shot, Scans& scans,
                 ScanTruth& truth) const {
  const size_t beams = fan.along.size(), rays = bundle_.place.size();
  const double on_s = settings_->on_s + truth.stamp_s[row] - begin_s_;
  const std::vector<int>& passage = caster_->mesh().passage;
  arcs(shot.hit.cosine.data() + at, shot.incidence_rad.data(), beams);
  for (size_t k = 0; k < beams; ++k) {
    const size_t to = row * beams + k;
    const Meeting& own = fan.shadow[k * rays];
    const Meeting met = meeting(own, shot.hit.range_m[at + k], shot.hit.face[at + k], shot.hit.cosine[at + k]);
    const bool mirrored = gather(fan, k, at, met, shot);
    const Reading r =
        reading(device_, shot.returns, met.cosine, *settings_, shot.chance[at + k], {seed_, scan, k}, on_s);
    scans.range_m[to] = r.range_m;
    scans.code[to] = r.code;
    truth.range_m[to] = static_cast<float>(met.range_m);
    truth.label[to] = static_cast<std::uint8_t>(met.label);
    truth.part[to] = met.part;
    truth.incidence_rad[to] = std::isinf(met.range_m) ? 0
                              : met.face >= 0         ? shot.incidence_rad[k]
                                                      : static_cast<float>(met.incidence_rad());
    truth.face[to] = met.face;
    truth.passage[to] = met.face >= 0 && !passage.empty() ? passage[static_cast<size_t>(met.face)] : -1;
    truth.surfaces[to] = r.surfaces;
    truth.fault[to] = r.fault | (mirrored ? trouble::ghost : 0);
  }
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

void Sweep::fire(size_t begin, size_t end, size_t first, Scans& scans, ScanTruth& truth) const {
  const size_t beams = fan_.along.size(), rays = bundle_.place.size();
  Shot shot;
  shot.returns.resize(rays);
  shot.error_rad.resize(beams);
  shot.incidence_rad.resize(beams);
  Motion motion(*path_);
  // Of a laser that tells every turn or two the next scans see the same rock; of a slower one they are a step ahead.
  const size_t abreast = mount_->laser.interval_s < 0.06 ? 8 : 4;
  for (size_t row = begin; row < end; row += together) {
    const size_t n = std::min(together, end - row);
    shot.chance.resize(n * beams);
    shot.axis.resize(n * beams);
    if (rays > 1) shot.left.resize(n * beams);
    std::vector<MountFan> tilted(truth.tilt_rad.empty() ? 0 : n);
    for (size_t i = 0; i < n; ++i) {
      if (!tilted.empty()) tilted[i] = tilted_fan(truth.tilt_rad[row + i]);
      const MountFan& fan = tilted.empty() ? fan_ : tilted[i];
      aim(tilted.empty() ? aim_ : Aim(fan, mount_->X_BS.translation(), mount_->laser.interlace), truth.stamp_s[row + i],
          scan_address(index_, first + row + i), i * beams, motion, shot);
    }
    caster_->nearest(shot.axis, beams, abreast, shot.hit);
    for (size_t i = 0; i < n; ++i) {
      if (rays > 1) spread(i * beams, shot);
      tell(tilted.empty() ? fan_ : tilted[i], i * beams, scan_address(index_, first + row + i), row + i, shot, scans,
           truth);
      if (settings_->dazzle_deg > 0) dazzle(row + i, scans, truth);
    }
  }
}

}  // namespace adit
