// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/tube_log.h"

#include "base/parallel.h"
#include "base/rng.h"
#include "rays/caster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;

double phase(std::uint64_t seed, std::uint64_t wave) {
  return 2 * pi * uniform(seed, Draw::test, 77, wave);
}

/// Sum of plane waves, sd 1.
double rough(const Vec3& p, std::uint64_t seed, int axis) {
  constexpr int waves = 16;
  double sum = 0;
  for (std::uint64_t w = 0; w < waves; ++w) {
    const std::uint64_t address = 100 * (axis + 1) + w;
    const Vec3 direction(normal(seed, Draw::test, address, 1), normal(seed, Draw::test, address, 2),
                         normal(seed, Draw::test, address, 3));
    const double length = 0.5 + 1.5 * uniform(seed, Draw::test, address, 4);
    sum += std::sin(2 * pi / length * direction.normalized().dot(p) + phase(seed, address));
  }
  return sum * std::sqrt(2.0 / waves);
}

}  // namespace

double Ground::height_m(const Vec2& p) const {
  return roll_m * (std::sin(2 * pi * p.x() / 31 + phase(seed, 1)) +
                   std::sin(2 * pi * (p.x() + 2 * p.y()) / 45 + phase(seed, 2)) +
                   std::sin(2 * pi * p.y() / 20 + phase(seed, 3)));
}

Vec3 Ground::moved(const Vec3& p) const {
  Vec3 to = p;
  if (rough_m > 0)
    for (int axis = 0; axis < 3; ++axis) to[axis] += rough_m * rough(p, seed, axis);
  to.z() += height_m(p.head<2>());
  return to;
}

Mesh bent(Mesh mesh, const Ground& ground) {
  parallel_for(
      mesh.vertex.size(), [&](size_t n) { mesh.vertex[n] = ground.moved(mesh.vertex[n]); }, 1024);
  return mesh;
}

std::vector<Vec2> straight_line(double from_x, double to_x) {
  std::vector<Vec2> line;
  const int n = static_cast<int>(std::ceil((to_x - from_x) / 0.05));
  for (int i = 0; i <= n; ++i) line.emplace_back(from_x + (to_x - from_x) * i / n, 0);
  return line;
}

std::vector<Vec2> ring_line(double outer_m, double width_m, double radius_m, double rounds) {
  const double half = (outer_m - width_m) / 2;  // of the square of centre lines
  const double straight = 2 * (half - radius_m), arc = pi / 2 * radius_m, quarter = straight + arc;
  std::vector<Vec2> line;
  const int n = static_cast<int>(std::ceil(rounds * 4 * quarter / 0.05));
  for (int i = 0; i <= n; ++i) {
    const double s = rounds * 4 * quarter * i / n + straight / 2;  // from the start of the lower side
    const int side = static_cast<int>(s / quarter);
    const double along = s - side * quarter;
    Vec2 p(std::min(along, straight) - straight / 2, -half);
    if (along > straight) {
      const double a = (along - straight) / radius_m;
      p = {straight / 2 + radius_m * std::sin(a), -half + radius_m * (1 - std::cos(a))};
    }
    line.push_back(Eigen::Rotation2Dd(side * pi / 2) * p);
  }
  return line;
}

Trajectory ride_along(const std::vector<Vec2>& line, const Ground& ground, const Ride& ride) {
  constexpr double step_s = 0.01;
  std::vector<double> along(line.size(), 0);
  for (size_t i = 1; i < line.size(); ++i) along[i] = along[i - 1] + (line[i] - line[i - 1]).norm();
  const auto place = [&](double s) -> Vec2 {
    const size_t i =
        std::clamp<size_t>(std::upper_bound(along.begin(), along.end(), s) - along.begin(), 1, line.size() - 1);
    return line[i - 1] + (line[i] - line[i - 1]) * ((s - along[i - 1]) / (along[i] - along[i - 1]));
  };
  const auto shake = [](double sd, double hz, double t) {
    return sd *
           (std::sin(2 * pi * hz * t) + std::sin(2 * pi * hz * 0.73 * t + 1) + std::sin(2 * pi * hz * 0.31 * t + 2) -
            std::sin(1.0) - std::sin(2.0)) *
           std::sqrt(2.0 / 3);
  };
  Trajectory path;
  const double middle_s = along.back() / 2 / ride.speed_mps, length_s = along.back() / ride.speed_mps + ride.stop_s;
  for (int n = 0; n * step_s <= length_s; ++n) {
    const double t = n * step_s;
    const double moving_s = t < middle_s ? t : std::max(middle_s, t - ride.stop_s);
    const double s = std::min(moving_s * ride.speed_mps, along.back());
    const double from = std::clamp(s - 0.05, 0.0, along.back() - 0.1);
    const Vec2 p = place(s), ahead = (place(from + 0.1) - place(from)).normalized();
    const auto slope = [&](const Vec2& d) {
      return (ground.height_m(p + 0.05 * d) - ground.height_m(p - 0.05 * d)) / 0.1;
    };
    const double to_rad = pi / 180;
    path.stamp_s.push_back(t);
    path.X_WB.push_back(pose_of(
        {p.x(), p.y(), ground.height_m(p) + shake(ride.heave_m, 1.0, moving_s)}, std::atan2(ahead.y(), ahead.x()),
        -std::atan(slope(ahead)) + to_rad * shake(ride.pitch_deg, 1.2, moving_s),
        std::atan(slope({-ahead.y(), ahead.x()})) + to_rad * shake(ride.roll_deg, 0.9, moving_s)));
  }
  return path;
}

Log tube_log(const Mesh& mesh, const Rig& rig, const Trajectory& X_WB, double noise_m, std::uint64_t seed) {
  const Caster caster(mesh);
  Log log{rig, {}};
  for (size_t m = 0; m < rig.mounts.size(); ++m) {
    const Mount& mount = rig.mounts[m];
    Scans scans;
    scans.beams = mount.laser.beams;
    for (double t = 0.031 * static_cast<double>(m + 1); t + 0.03 < X_WB.stamp_s.back(); t += mount.laser.interval_s)
      scans.stamp_s.push_back(t);
    scans.range_m.resize(scans.size() * scans.beams);
    parallel_for(scans.size(), [&](size_t n) {
      for (int k = 0; k < scans.beams; ++k) {
        const Pose X_WS = X_WB.at(scans.stamp_s[n] + mount.laser.beam_offset_s(k)) * mount.X_BS;
        const double angle = mount.laser.beam_angle_rad(k);
        const Hit hit = caster.nearest({X_WS.translation(), X_WS.linear() * Vec3(std::cos(angle), std::sin(angle), 0)});
        const bool seen = hit.face >= 0 && hit.range_m < mount.laser.range_max_m;
        scans.range_m[n * scans.beams + k] =
            seen ? static_cast<float>(hit.range_m + noise_m * normal(seed, Draw::beam_range, m << 32 | n, k))
                 : std::numeric_limits<float>::infinity();
      }
    });
    log.scans.push_back(std::move(scans));
  }
  return log;
}

}  // namespace adit
