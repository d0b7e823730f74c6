// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/tilt_beams.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace adit {
namespace {

constexpr int reach = 2;        // beams to either side that tell the slope: of the same turn of an LMS 200's mirror
constexpr double steep = 2;     // rise over run of a rib, at least
constexpr double step_m = 0.5;  // neighbours farther apart along the beam lie on another surface
constexpr double level_direction = 0.05;  // sine of elevation of a beam too level to be floor or roof

/// One scan in B.
struct Section {
  std::vector<Vec3> p, direction;
  std::vector<double> range;
};

Section section_of(const Mount& mount, std::span<const float> range_m) {
  Section s;
  for (size_t k = 0; k < range_m.size(); ++k) {
    const double angle = mount.laser.beam_angle_rad(static_cast<int>(k));
    s.direction.push_back(mount.X_BS.linear() * Vec3(std::cos(angle), std::sin(angle), 0));
    s.range.push_back(range_m[k]);
    s.p.push_back(mount.X_BS.translation() + range_m[k] * s.direction.back());
  }
  return s;
}

/// Rise over run of the section at beam k; none at its ends, at jumps and beside unreadable beams.
std::optional<double> slope_at(const Section& s, size_t k) {
  if (k < reach || k + reach >= s.p.size()) return std::nullopt;
  for (const size_t n : {k - reach, k, k + reach})
    if (!std::isfinite(s.range[n]) || std::abs(s.range[n] - s.range[k]) > step_m + 0.1 * s.range[k])
      return std::nullopt;
  const Vec3 d = s.p[k + reach] - s.p[k - reach];
  return std::abs(d.z()) / std::max(1e-9, d.head<2>().norm());
}

void add_flat(const Section& s, int laser, const LaserModel& model, double stamp_s, double farthest_m,
              const TiltSettings& settings, std::vector<TiltBeam>& beams) {
  std::optional<Vec3> last;
  for (size_t k = 0; k < s.p.size(); ++k) {
    if (std::abs(s.direction[k].z()) < level_direction || !std::isfinite(s.range[k])) continue;
    if (s.p[k].head<2>().norm() > farthest_m) continue;
    const auto slope = slope_at(s, k);
    if (!slope || *slope > 1) continue;
    if (last && (s.p[k] - *last).norm() < settings.spacing_m) continue;
    last = s.p[k];
    beams.push_back({stamp_s + model.beam_offset_s(static_cast<int>(k)), s.p[k], s.direction[k],
                     static_cast<std::uint8_t>(laser), s.direction[k].z() > 0});
  }
}

/// The slope dy/dz of the rib on one side by least squares, as the roll that makes it vertical.
void add_rib(const Section& s, double side, double at_s, std::vector<RibTilt>& ribs) {
  constexpr double least_height_m = 0.4, most_off_m = 0.15;
  constexpr int least_beams = 8;
  std::vector<Vec2> zy;
  for (size_t k = 0; k < s.p.size(); ++k)
    if (const auto slope = slope_at(s, k); slope && *slope > steep && s.p[k].y() * side > 0.5)
      zy.emplace_back(s.p[k].z(), s.p[k].y());
  if (zy.size() < least_beams) return;
  std::vector<double> y;
  for (const Vec2& q : zy) y.push_back(q.y());
  std::nth_element(y.begin(), y.begin() + static_cast<std::ptrdiff_t>(y.size() / 2), y.end());
  const double middle = y[y.size() / 2];
  double n = 0, sz = 0, sy = 0, szz = 0, szy = 0, low = std::numeric_limits<double>::infinity(), high = -low;
  for (const Vec2& q : zy) {
    if (std::abs(q.y() - middle) > most_off_m) continue;
    n += 1, sz += q.x(), sy += q.y(), szz += q.x() * q.x(), szy += q.x() * q.y();
    low = std::min(low, q.x()), high = std::max(high, q.x());
  }
  if (n < least_beams || high - low < least_height_m) return;
  ribs.push_back({at_s, std::atan((n * szy - sz * sy) / (n * szz - sz * sz))});
}

/// Scans worth using: all while moving, about one in two seconds while standing.
std::vector<size_t> useful_scans(const Scans& scans, double lasts_s, const PlanarMotion& motion) {
  constexpr double rest_s = 2;
  const auto& stamps = motion.stamp_s();
  std::vector<size_t> useful;
  double last_s = -std::numeric_limits<double>::infinity();
  for (size_t n = 0; n < scans.size(); ++n) {
    const double t = scans.stamp_s[n];
    if (t < stamps.front() || t + lasts_s > stamps.back()) continue;
    const auto next = std::upper_bound(stamps.begin(), stamps.end(), t) - stamps.begin();
    if (!motion.moves(static_cast<size_t>(std::max<std::ptrdiff_t>(0, next - 1))) && t - last_s < rest_s) continue;
    last_s = t;
    useful.push_back(n);
  }
  return useful;
}

}  // namespace

TiltData tilt_data(const Log& log, const PlanarMotion& motion, const TiltSettings& settings) {
  TiltData all;
  for (size_t m = 0; m < log.rig.mounts.size(); ++m) {
    const Mount& mount = log.rig.mounts[m];
    const View view = view_of(mount);
    if (view == View::horizontal || view == View::other) continue;
    const bool ahead = view == View::forward_vertical;
    const double lasts_s = mount.laser.turn_s * mount.laser.interlace;
    const std::vector<size_t> scans = useful_scans(log.scans[m], lasts_s, motion);
    std::vector<TiltData> part(scans.size());
    parallel_for(
        scans.size(),
        [&](size_t n) {
          const double stamp_s = log.scans[m].stamp_s[scans[n]];
          const Section section = section_of(mount, log.scans[m][scans[n]]);
          add_flat(section, static_cast<int>(m), mount.laser, stamp_s, ahead ? settings.forward_m : settings.sideways_m,
                   settings, part[n].beams);
          if (!ahead && settings.rib_sigma_deg > 0)
            for (const double side : {-1.0, 1.0}) add_rib(section, side, stamp_s + lasts_s / 2, part[n].ribs);
        },
        16);
    for (const TiltData& p : part) {
      all.beams.insert(all.beams.end(), p.beams.begin(), p.beams.end());
      all.ribs.insert(all.ribs.end(), p.ribs.begin(), p.ribs.end());
    }
  }
  return all;
}

}  // namespace adit
