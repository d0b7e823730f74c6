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

// What a few scans need on their way.
struct Sweep::Shot {
  Chances chance;                 // (scans x beams)
  std::vector<double> error_rad;  // (beams) of the scan that is being aimed
  // By the scans' places. (scans x beams)
  RayColumns<double> axis;
  Directions left;  // where there is a bundle
  HitColumns<double> hit;
  // Of the scan that is being told. (beams)
  Axes met;
  Readings reading;
  std::vector<std::uint8_t> ghost;  // where there is water: whether any of a beam was seen in it
  // The rays beside the axes of one scan's beams. (beams x others)
  RayColumns<float> ray;
  HitColumns<float> glance;
  std::vector<Return> returns;  // (rays) of one beam

  Ray axis_at(size_t i) const { return {{axis.x[i], axis.y[i], axis.z[i]}, {axis.dx[i], axis.dy[i], axis.dz[i]}}; }
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
  if (!caster.mesh().reflectivity.empty()) reflectivity_ = caster.mesh().reflectivity.data();
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

void Sweep::aim(const Aim& aim, double time_s, std::uint64_t scan, size_t at, const Places& places, Motion& motion,
                Shot& shot) const {
  constexpr double degree = std::numbers::pi / 180;
  const size_t beams = aim.beams();
  const LaserModel& m = device_.model;
  const bool spot = m.spot_m > 0 || m.divergence_rad > 0;
  const bool noisy = (settings_->noise && (m.sigma_m > 0 || spot)) || (settings_->footprint && spot);
  const Normals normal = settings_->beam_angle_deg > 0 ? Normals::both : noisy ? Normals::range : Normals::none;
  draw_chances(draws_, scan, beams, normal, shot.chance, at);
  for (size_t k = 0; k < beams; ++k) shot.error_rad[k] = settings_->beam_angle_deg * degree * shot.chance.angle[at + k];
  aim.rays(time_s, shot.error_rad, motion, shot.axis, places, bundle_.place.size() > 1 ? &shot.left : nullptr);
}

// The spots' other rays. Those of one spot stay together: they meet the same rock.
void Sweep::spread(const Places& places, Shot& shot) const {
  const size_t others = bundle_.place.size() - 1, beams = fan_.along.size();
  const float wide = static_cast<float>(mount_->laser.spot_m / 2),
              lean = static_cast<float>(mount_->laser.divergence_rad / 2);
  shot.ray.resize(beams * others);
  const Vec3& middle = caster_->middle();
  for (size_t k = 0; k < beams; ++k) {
    const size_t at = places[k];
    const Ray axis = shot.axis_at(at);
    const Vec3 &d = axis.direction, left(shot.left.x[at], shot.left.y[at], shot.left.z[at]), above = d.cross(left);
    const Eigen::Vector3f o = (axis.origin - middle).cast<float>(), a = d.cast<float>(), l = left.cast<float>(),
                          u = above.cast<float>();
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

double Sweep::reflectivity_of(std::int32_t face) const {
  if (face < 0) return 0;
  return reflectivity_ ? static_cast<double>(reflectivity_[face]) : settings_->reflectivity;
}

namespace {

// A property of faces by the faces of a scan's beams.
template <class Told, class T>
void look_up_faces(const std::vector<T>& of_face, T of_none, const std::int32_t* face, size_t n, Told* told) {
  const T* known = of_face.data();
  if (of_face.empty()) return void(std::fill_n(told, n, static_cast<Told>(of_none)));
  for (size_t k = 0; k < n; ++k) told[k] = static_cast<Told>(face[k] >= 0 ? known[face[k]] : of_none);
}

}  // namespace

// What the axes of a scan meet: the world, or the vehicle before that.
void Sweep::look_up(const MountFan& fan, const Places& places, size_t row, Shot& shot, ScanTruth& truth) const {
  const size_t beams = fan.along.size(), first = row * beams;
  const Mesh& mesh = caster_->mesh();
  std::int32_t* face = &truth.face[first];
  double *range_m = shot.met.range_m.data(), *cosine = shot.met.cosine.data(), *power = shot.met.power.data();
  for (size_t k = 0; k < beams; ++k) {
    const size_t at = places[k];
    face[k] = shot.hit.face[at];
    range_m[k] = shot.hit.range_m[at];
    cosine[k] = face[k] < 0 ? 1 : std::abs(shot.hit.cosine[at]);
  }
  look_up_faces(mesh.label, Label::none, face, beams, &truth.label[first]);
  look_up_faces(mesh.part, -1, face, beams, &truth.part[first]);
  look_up_faces(mesh.passage, -1, face, beams, &truth.passage[first]);
  for (size_t k = 0; k < beams; ++k) power[k] = reflectivity_of(face[k]) * cosine[k];
  arcs(cosine, &truth.incidence_rad[first], beams);
  for (const size_t k : fan.shadowed) {
    const Meeting& own = fan.shadow[k * bundle_.place.size()];
    if (own.range_m >= range_m[k]) continue;
    range_m[k] = own.range_m, cosine[k] = own.cosine, power[k] = own.effective_reflectivity();
    truth.label[first + k] = static_cast<std::uint8_t>(own.label);
    truth.part[first + k] = truth.passage[first + k] = face[k] = -1;
    truth.incidence_rad[first + k] = static_cast<float>(own.incidence_rad());
  }
  for (size_t k = 0; k < beams; ++k) truth.range_m[first + k] = static_cast<float>(range_m[k]);
}

// What a ray of the world met, or of the vehicle before that.
Meeting Sweep::meeting(const Meeting& own, const Hit& hit) const {
  return own.range_m < hit.range_m ? own : meeting_of(caster_->mesh(), hit, settings_->reflectivity);
}

// Fills the returns of a beam's spot. Says whether any of them was seen in a mirror.
bool Sweep::gather(const MountFan& fan, size_t beam, size_t at, Shot& shot) const {
  const size_t rays = bundle_.place.size(), first = beam * (rays - 1);
  shot.returns[0] = {shot.met.range_m[beam], bundle_.weight[0] * shot.met.power[beam]};
  for (size_t i = 1; i < rays; ++i) {
    const size_t j = first + i - 1;
    const Meeting& own = fan.shadow[beam * rays + i];
    const double range_m = static_cast<double>(shot.glance.range_m[j]);
    const double reflects = reflectivity_of(shot.glance.face[j]);
    shot.returns[i] =
        own.range_m < range_m
            ? Return{own.range_m, bundle_.weight[i] * own.effective_reflectivity()}
            : Return{range_m, bundle_.weight[i] * reflects * std::abs(static_cast<double>(shot.glance.cosine[j]))};
  }
  return water_ && mirror(fan, beam, at, shot);
}

// Sees in water what lies beyond it.
bool Sweep::mirror(const MountFan& fan, size_t beam, size_t at, Shot& shot) const {
  const size_t rays = bundle_.place.size();
  bool mirrored = false;
  for (size_t i = 0; i < rays; ++i) {
    const size_t j = beam * (rays - 1) + i - 1;
    const Hit hit = i == 0 ? Hit{shot.hit.range_m[at], shot.hit.face[at], shot.hit.cosine[at]}
                           : Hit{static_cast<double>(shot.glance.range_m[j]), shot.glance.face[j],
                                 static_cast<double>(shot.glance.cosine[j])};
    const Meeting met = meeting(fan.shadow[beam * rays + i], hit);
    if (met.face < 0 || met.label != *water_) continue;
    Ray ray = shot.axis_at(at);
    if (i > 0)
      ray = {Eigen::Vector3f(shot.ray.x[j], shot.ray.y[j], shot.ray.z[j]).cast<double>() + caster_->middle(),
             Eigen::Vector3f(shot.ray.dx[j], shot.ray.dy[j], shot.ray.dz[j]).cast<double>().normalized()};
    const Meeting there = seen_in_water(*caster_, ray, met, settings_->reflectivity);
    mirrored = mirrored || there.range_m != met.range_m;
    shot.returns[i] = {there.range_m, bundle_.weight[i] * there.effective_reflectivity()};
  }
  return mirrored;
}

// What the device tells of the scan that was looked up.
void Sweep::read(const MountFan& fan, size_t at, const Places& places, const BeamAddress& first, double on_s,
                 Shot& shot) const {
  const size_t beams = fan.along.size();
  const bool spots = bundle_.place.size() > 1;
  Axes& met = shot.met;
  for (size_t k = 0; (spots || water_) && k < beams; ++k) {
    shot.ghost[k] = gather(fan, k, places[k], shot) ? trouble::ghost : 0;
    if (spots)
      shot.reading.put(k, reading(device_, shot.returns, met.cosine[k], *settings_, shot.chance[at + k],
                                  {first.seed, first.scan, k}, on_s));
    else
      met.range_m[k] = shot.returns[0].range_m, met.power[k] = shot.returns[0].power;
  }
  if (!spots) read_axes(device_, met, *settings_, shot.chance, at, first, on_s, shot.reading);
  for (size_t k = 0; water_ && k < beams; ++k) shot.reading.fault[k] |= shot.ghost[k];
}

void Sweep::tell(const MountFan& fan, size_t at, const Places& places, std::uint64_t scan, size_t row, Shot& shot,
                 Scans& scans, ScanTruth& truth) const {
  look_up(fan, places, row, shot, truth);
  read(fan, at, places, {seed_, scan, 0}, settings_->on_s + truth.stamp_s[row] - begin_s_, shot);
  const auto to = static_cast<std::ptrdiff_t>(row * fan.along.size());
  const Readings& r = shot.reading;
  std::copy(r.range_m.begin(), r.range_m.end(), scans.range_m.begin() + to);
  std::copy(r.code.begin(), r.code.end(), scans.code.begin() + to);
  std::copy(r.surfaces.begin(), r.surfaces.end(), truth.surfaces.begin() + to);
  std::copy(r.fault.begin(), r.fault.end(), truth.fault.begin() + to);
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
  shot.met.resize(beams);
  shot.reading.resize(beams);
  shot.ghost.resize(beams);
  Motion motion(*path_);
  // Of a laser that tells every turn or two the next scans see the same rock; of a slower one they are a step ahead.
  const size_t abreast = mount_->laser.interval_s < 0.06 ? 8 : 4;
  for (size_t row = begin; row < end; row += together) {
    const size_t n = std::min(together, end - row);
    shot.chance.resize(n * beams);
    shot.axis.resize(n * beams);
    if (rays > 1) shot.left.resize(n * beams);
    const auto places_of = [&](size_t i) {
      const size_t group = i - i % abreast;
      return Places{group * beams + i % abreast, std::min(abreast, n - group)};
    };
    std::vector<MountFan> tilted(truth.tilt_rad.empty() ? 0 : n);
    for (size_t i = 0; i < n; ++i) {
      if (!tilted.empty()) tilted[i] = tilted_fan(truth.tilt_rad[row + i]);
      const std::uint64_t scan = scan_address(index_, first + row + i);
      const auto aim_by = [&](const Aim& aimed) {
        aim(aimed, truth.stamp_s[row + i], scan, i * beams, places_of(i), motion, shot);
      };
      tilted.empty() ? aim_by(aim_) : aim_by(Aim(tilted[i], mount_->X_BS.translation(), mount_->laser.interlace));
    }
    shot.hit.resize(n * beams);
    for (size_t group = 0; group < n; group += abreast) {
      const size_t scans_of_it = std::min(abreast, n - group);
      caster_->nearest(shot.axis, group * beams, (group + scans_of_it) * beams, scans_of_it * (16 / abreast), shot.hit);
    }
    for (size_t i = 0; i < n; ++i) {
      if (rays > 1) spread(places_of(i), shot);
      tell(tilted.empty() ? fan_ : tilted[i], i * beams, places_of(i), scan_address(index_, first + row + i), row + i,
           shot, scans, truth);
      if (settings_->dazzle_deg > 0) dazzle(row + i, scans, truth);
    }
  }
}

}  // namespace adit
