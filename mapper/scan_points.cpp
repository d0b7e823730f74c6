// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/scan_points.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace adit {
namespace {

// The points of a scan before their directions are known, in the order of the beams.
struct Echoes {
  std::vector<Vec2> p_B;
  std::vector<Vec2> ray_B;  // unit, from the laser to the point
  std::vector<double> range_m;
  std::vector<double> z_m;
  std::vector<std::int32_t> beam;
};

Echoes echoes_of(std::span<const float> range_m, const BeamFan& fan, const Twist2& twist, const ScanPointSettings& s,
                 const Stance* stance) {
  Echoes e;
  e.p_B.reserve(range_m.size()), e.ray_B.reserve(range_m.size()), e.z_m.reserve(range_m.size());
  e.range_m.reserve(range_m.size()), e.beam.reserve(range_m.size());
  for (size_t k = 0; k < range_m.size(); ++k) {
    const double r = range_m[k];
    if (!(r >= s.range_min_m && r <= s.range_max_m)) continue;  // NaN fails too
    const double t = fan.offset_s[k];
    const double a = twist.yaw_rad_s * t;
    const double cos_a = 1 - a * a / 2, sin_a = a * (1 - a * a / 6);  // a turn within one scan is small
    const Vec3 d3 = stance ? Vec3((stance->R_BS + t * stance->R_BS_s).leftCols<2>() * fan.direction_S[k])
                           : Vec3(fan.direction_B[k].x(), fan.direction_B[k].y(), 0);
    const Vec2 d = d3.head<2>();
    const Vec2 q = fan.origin_B + r * d;
    e.p_B.emplace_back(cos_a * q.x() - sin_a * q.y() + twist.x_m_s * t,
                       sin_a * q.x() + cos_a * q.y() + twist.y_m_s * t);
    e.ray_B.emplace_back(cos_a * d.x() - sin_a * d.y(), sin_a * d.x() + cos_a * d.y());
    e.range_m.push_back(r);
    e.z_m.push_back(stance ? stance->z_m + t * stance->z_m_s + r * d3.z() : 0);
    e.beam.push_back(static_cast<std::int32_t>(k));
  }
  return e;
}

// Sums over the points before each, so that a line through any stretch of beams costs the same.
class LineSums {
 public:
  explicit LineSums(const std::vector<Vec2>& p) : sum_(p.size() + 1) {
    sum_[0].fill(0);
    for (size_t i = 0; i < p.size(); ++i) {
      const double x = p[i].x(), y = p[i].y();
      sum_[i + 1] = {sum_[i][0] + x, sum_[i][1] + y, sum_[i][2] + x * x, sum_[i][3] + x * y, sum_[i][4] + y * y};
    }
  }

  struct Line {
    Vec2 normal;       // unit, either way
    double rms_m;      // of the distances, two degrees of freedom taken off
    double spread_m2;  // sum of squared places along the line
  };
  /// Total least squares through the points [begin, end), at least three.
  Line fit(size_t begin, size_t end) const {
    const double n = static_cast<double>(end - begin);
    const auto d = [&](int k) { return sum_[end][k] - sum_[begin][k]; };
    const double mx = d(0) / n, my = d(1) / n;
    const double xx = d(2) - n * mx * mx, xy = d(3) - n * mx * my, yy = d(4) - n * my * my;
    const double half = (xx - yy) / 2, root = std::sqrt(half * half + xy * xy), mean = (xx + yy) / 2;
    const double small = std::max(0.0, mean - root);
    // The eigenvector of the smaller value, from the row that is far from zero.
    Vec2 normal = half > 0 ? Vec2(-xy, half + root) : Vec2(half - root, xy);
    const double length = normal.norm();
    normal = length > 0 ? Vec2(normal / length) : Vec2::UnitX();
    return {normal, std::sqrt(small / std::max(1.0, n - 2)), mean + root};
  }

 private:
  std::vector<std::array<double, 5>> sum_;
};

// Ends of the stretches in which neighbouring beams can have met one rib: run[i] is where the stretch of point i
// begins, and along[i] the way to it over the points before.
struct Runs {
  std::vector<size_t> begin, end;
  std::vector<double> along_m;
};

Runs runs_of(const Echoes& e, const BeamFan& fan, const ScanPointSettings& s) {
  const size_t n = e.p_B.size();
  Runs runs{std::vector<size_t>(n), std::vector<size_t>(n), std::vector<double>(n)};
  const double graze = std::sin(s.graze_deg * std::numbers::pi / 180);
  size_t begin = 0;
  for (size_t i = 0; i < n; ++i) {
    if (i > 0) {
      const double gap = (e.p_B[i] - e.p_B[i - 1]).norm();
      const double turn = (e.beam[i] - e.beam[i - 1]) * fan.step_rad;
      const double reach = std::min(e.range_m[i], e.range_m[i - 1]) * turn / graze + 4 * fan.sigma_m;
      runs.along_m[i] = runs.along_m[i - 1] + gap;
      if (gap > reach || turn > 4.5 * fan.step_rad) begin = i;
    }
    runs.begin[i] = begin;
  }
  for (size_t i = n; i-- > 0;) runs.end[i] = i + 1 < n && runs.begin[i + 1] == runs.begin[i] ? runs.end[i + 1] : i + 1;
  return runs;
}

struct RibLine {
  Vec2 normal;  // towards the laser
  double sigma_m, sigma_normal_rad;
};

// The line about point i through the widest stretch of its neighbours that the laser's noise explains; at last the
// narrowest if it is half-way a line. The neighbourhood runs along the beams: on a rib seen flatly they lie far apart.
std::optional<RibLine> rib_line(size_t i, const Echoes& e, const Runs& runs, const LineSums& sums, const BeamFan& fan,
                                const ScanPointSettings& s) {
  constexpr std::array<double, 4> shrink{1.0, 0.7, 0.5, 0.35};
  size_t lo = runs.begin[i], hi = runs.end[i];
  if (hi - lo < 3) return {};
  for (size_t step = 0; step < shrink.size(); ++step) {
    const double reach = s.fit_half_m * shrink[step];
    size_t begin = i, end = i + 1;
    while (begin > lo && runs.along_m[i] - runs.along_m[begin - 1] <= reach) --begin;
    while (end < hi && runs.along_m[end] - runs.along_m[i] <= reach) ++end;
    if (end - begin < 3) {  // beams lie farther apart than that: the next ones
      begin = std::min(i > lo ? i - 1 : i, hi - 3);
      end = begin + 3;
    }
    const LineSums::Line line = sums.fit(begin, end);
    const double facing = line.normal.dot(e.ray_B[i]);
    const double expected = fan.sigma_m * std::max(std::abs(facing), 0.3);
    const double allowed = (step + 1 == shrink.size() ? 4 : 1) * s.fit_sigmas * expected;
    if (line.rms_m <= allowed)
      return RibLine{facing > 0 ? Vec2(-line.normal) : line.normal, std::max(line.rms_m, expected),
                     expected / std::sqrt(std::max(line.spread_m2, 1e-6))};
    lo = begin, hi = end;
  }
  return {};
}

}  // namespace

Fields fields(ScanPointSettings& s) {
  return {
      {"range_min_m", &s.range_min_m, "shorter ranges are the vehicle or dust on the window", 0, 100},
      {"range_max_m", &s.range_max_m, "longer ranges are not taken for ribs: floor and roof on pitching ground", 1,
       1000},
      {"fit_half_m", &s.fit_half_m, "longest reach of a line fit to either side of a point", 0.05, 10},
      {"fit_sigmas", &s.fit_sigmas, "a line fits while its rms residual is below so many sigma of the laser", 0.5, 100},
      {"graze_deg", &s.graze_deg, "flattest angle at which neighbouring beams are joined to one rib", 0.5, 45}};
}

BeamFan fan_of(const Mount& mount) {
  const LaserModel& laser = mount.laser;
  BeamFan fan;
  fan.origin_B = mount.X_BS.translation().head<2>();
  fan.step_rad = laser.fov_rad / std::max(1, laser.beams - 1);
  fan.sigma_m = std::max(laser.sigma_m, 0.002);  // a stated noise of zero would trust the last millimetre
  for (int k = 0; k < laser.beams; ++k) {
    const double a = laser.beam_angle_rad(k);
    fan.direction_S.push_back({std::cos(a), std::sin(a)});
    fan.direction_B.push_back((mount.X_BS.linear() * Vec3(std::cos(a), std::sin(a), 0)).head<2>());
    fan.offset_s.push_back(laser.beam_offset_s(k));
  }
  return fan;
}

Twist2 twist_of(const Pose2& X, double dt_s) {
  // Inverse of the motion along an arc: the chord in the frame turned by half the angle, longer by a / (2 sin(a / 2)).
  const double half = X.yaw_rad / 2;
  const double stretch = std::abs(half) < 1e-6 ? 1.0 : half / std::sin(half);
  const double c = std::cos(half), s = std::sin(half);
  return {stretch * (c * X.x_m + s * X.y_m) / dt_s, stretch * (c * X.y_m - s * X.x_m) / dt_s, X.yaw_rad / dt_s};
}

Pose2 pose_after(const Twist2& twist, double dt_s) {
  const double half = twist.yaw_rad_s * dt_s / 2;
  const double chord = std::abs(half) < 1e-6 ? 1.0 : std::sin(half) / half;
  const double x = twist.x_m_s * dt_s * chord, y = twist.y_m_s * dt_s * chord;
  const double c = std::cos(half), s = std::sin(half);
  return {c * x - s * y, s * x + c * y, wrap_angle(2 * half)};
}

ScanPoints scan_points(std::span<const float> range_m, const BeamFan& fan, const Twist2& twist,
                       const ScanPointSettings& s, const Stance* stance) {
  ADIT_CHECK(range_m.size() == fan.direction_B.size());
  const Echoes e = echoes_of(range_m, fan, twist, s, stance);
  const Runs runs = runs_of(e, fan, s);
  const LineSums sums(e.p_B);
  ScanPoints out;
  out.reserve(e.p_B.size());
  for (size_t i = 0; i < e.p_B.size(); ++i) {
    const std::optional<RibLine> rib = rib_line(i, e, runs, sums, fan, s);
    if (!rib) continue;
    out.p_B.push_back(e.p_B[i]);
    out.normal_B.push_back(rib->normal);
    out.sigma_m.push_back(rib->sigma_m);
    out.sigma_normal_rad.push_back(rib->sigma_normal_rad);
    out.z_m.push_back(e.z_m[i]);
    out.beam.push_back(e.beam[i]);
  }
  return out;
}

void ScanPoints::reserve(size_t n) {
  p_B.reserve(n), normal_B.reserve(n), sigma_m.reserve(n), sigma_normal_rad.reserve(n), z_m.reserve(n), beam.reserve(n);
}

std::vector<Twist2> twists_of(const std::vector<double>& stamp_s, const std::vector<Pose2>& X_MB) {
  ADIT_CHECK(stamp_s.size() == X_MB.size());
  std::vector<Twist2> out(X_MB.size());
  for (size_t i = 0; i < X_MB.size(); ++i) {
    const size_t a = i > 0 ? i - 1 : i, b = i + 1 < X_MB.size() ? i + 1 : i;
    const double dt_s = stamp_s[b] - stamp_s[a];
    if (dt_s > 0 && dt_s < 2) out[i] = twist_of(X_MB[a].inverse() * X_MB[b], dt_s);  // over a gap nothing is known
  }
  return out;
}

std::vector<ScanPoints> scan_points(const Scans& scans, const Mount& mount, const std::vector<Pose2>& X_MB,
                                    const ScanPointSettings& settings, const std::vector<Stance>& stances) {
  ADIT_CHECK(scans.size() == X_MB.size() && (stances.empty() || stances.size() == scans.size()));
  const BeamFan fan = fan_of(mount);
  const std::vector<Twist2> twists = twists_of(scans.stamp_s, X_MB);
  std::vector<ScanPoints> out(scans.size());
  parallel_for(
      scans.size(),
      [&](size_t i) {
        out[i] = scan_points(scans[i], fan, twists[i], settings, stances.empty() ? nullptr : &stances[i]);
      },
      64);
  return out;
}

}  // namespace adit
