// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/sweep.h"
#include "tests/sensors/scenes.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

// Float rays find the face, doubles the range to its plane; what is left is the truth's float at some 30 m.
constexpr double tolerance_m = 5e-6;

// Range from p in plan along an angle to the walls of a tunnel, 0 < x < length, |y| < half.
double range_in_tunnel(const Vec2& p, double angle, double length, double half) {
  const double side = ((std::sin(angle) > 0 ? half : -half) - p.y()) / std::sin(angle);
  const double end = ((std::cos(angle) > 0 ? length : 0) - p.x()) / std::cos(angle);
  return std::min(side > 0 ? side : INFINITY, end > 0 ? end : INFINITY);
}

TEST(Sweep, RangeInAStraightTunnelIsHalfWidthOverSine) {
  const World tunnel = tunnel_world(60, 4, 2);
  const Drive stand = drive_of(0.2, [](double) { return pose_of({30, 0, 0}, 0); });
  const Recording r = record(tunnel, stand, one_laser("ideal", pose_of({0, 0, 1}, 0)), {}, exact(), 1);
  const LaserModel& laser = r.log.rig.mounts[0].laser;
  ASSERT_GT(r.log.scans[0].size(), 3u);
  for (int k = 0; k < 361; ++k) {
    const double a = laser.beam_angle_rad(k);
    if (std::abs(std::sin(a)) < 0.1) continue;  // they meet the end
    EXPECT_NEAR(r.truth.scans[0].range_m[k], 2 / std::abs(std::sin(a)), tolerance_m) << k;
    EXPECT_NEAR(r.log.scans[0][1][k], 2 / std::abs(std::sin(a)), 1e-6 + tolerance_m) << k;  // told in micrometres
    EXPECT_NEAR(r.truth.scans[0].incidence_rad[k], M_PI / 2 - std::abs(a), 1e-5) << k;
    EXPECT_EQ(r.truth.scans[0].label[k], static_cast<int>(Label::rib));
  }
}

TEST(Sweep, RangeOnARampIsTheHeightOverTheSineToItsSlope) {
  // The tunnel rises by 10 degrees; the laser stands level, 1 m above its floor, its fan along the way.
  const double slope = 10 * M_PI / 180;
  World ramp = tunnel_world(80, 4, 2);
  const Pose X = pose_of({-40, 0, 0}, 0, -slope);
  const Vec3 foot = X * Vec3(40, 0, 0);
  for (Vec3& v : ramp.mesh.vertex) v = X * v;
  const Drive stand = drive_of(0.2, [&](double) { return pose_of(foot, 0); });
  const Recording r = record(ramp, stand, one_laser("ideal", pose_of({0, 0, 1}, 0, 0, M_PI / 2)), {}, exact(), 1);
  for (int k = 0; k < 361; ++k) {
    const double above = r.log.rig.mounts[0].laser.beam_angle_rad(k) - slope;  // of the tunnel's axis
    if (std::abs(above) < 0.1) continue;                                       // they meet the end
    const double to_side_m = (above < 0 ? 1 : 2 / std::cos(slope) - 1) * std::cos(slope);
    EXPECT_NEAR(r.truth.scans[0].range_m[k], to_side_m / std::abs(std::sin(above)), tolerance_m) << k;
    EXPECT_EQ(r.truth.scans[0].label[k], static_cast<int>(above < 0 ? Label::floor : Label::roof)) << k;
    EXPECT_NEAR(r.truth.scans[0].incidence_rad[k], std::abs(M_PI / 2 - std::abs(above)), 1e-5) << k;
  }
}

TEST(Sweep, RangeInASphereIsTheChord) {
  World world;
  const Vec3 c(3, -2, 1);
  world.mesh = sphere_mesh(c, 5, 6);
  const Vec3 p(4, -1, 0.5);
  const Drive stand = drive_of(0.2, [&](double) { return pose_of(p, 0.7, 0.3, -0.2); });
  const Recording r = record(world, stand, one_laser("ideal", Pose::Identity()), {}, exact(), 1);
  for (int k = 0; k < 361; ++k) {
    const double a = r.log.rig.mounts[0].laser.beam_angle_rad(k);
    const Vec3 d = rotation_of(0.7, 0.3, -0.2) * Vec3(std::cos(a), std::sin(a), 0);
    const double b = d.dot(p - c), range = -b + std::sqrt(b * b - (p - c).squaredNorm() + 25);
    // Faces with edges of 5 m / 64 * 1.1 lie up to e^2 / 6 R = 0.25 mm within the sphere; beams slant by up to 20 deg.
    EXPECT_NEAR(r.truth.scans[0].range_m[k], range, 4e-4) << k;
  }
}

TEST(Sweep, AMovingAndTurningLaserFiresEachBeamFromItsOwnPose) {
  const double v = 1.5, w = 0.6, length = 40, half = 2;
  const World tunnel = tunnel_world(length, 2 * half, 2);
  const auto pose = [&](double t) { return pose_of({10 + v * t, 0.3, 0}, 0.2 + w * t); };
  // The mirror stands in the body's origin, which moves evenly: the path between its poses is exact.
  const Recording r = record(tunnel, drive_of(1, pose), one_laser("ideal", pose_of({0, 0, 1}, 0)), {}, exact(), 1);
  const LaserModel& laser = r.log.rig.mounts[0].laser;
  const Scans& scans = r.log.scans[0];
  double comb = 0;  // what one pose for the whole scan would err by
  for (size_t i = 0; i < scans.size(); ++i)
    for (int k = 0; k < 361; ++k) {
      const double t = scans.stamp_s[i] + laser.beam_offset_s(k), a = laser.beam_angle_rad(k);
      const auto range = [&](double at) { return range_in_tunnel({10 + v * at, 0.3}, 0.2 + w * at + a, length, half); };
      EXPECT_NEAR(r.truth.scans[0].range_m[i * 361 + k], range(t), 2e-5) << i << " " << k;
      comb = std::max(comb, std::abs(range(t) - range(scans.stamp_s[i])));
    }
  EXPECT_GT(comb, 0.02);
}

std::vector<double> times_of(const Mount& mount, double begin_s, double end_s, const SensorSettings& settings) {
  std::vector<double> times;
  for (Beat beat(mount, 0, begin_s, settings, 1); beat.time_s() + beat.scan_s() <= end_s; beat.next())
    times.push_back(beat.time_s());
  return times;
}

TEST(Sweep, AScanIs361BeamsOfTwoTurnsIn26Point64Milliseconds) {
  const Mount mount = one_laser("lms200", Pose::Identity()).mounts[0];
  const std::vector<double> times = times_of(mount, 10, 20, exact());
  for (size_t i = 1; i < times.size(); ++i) EXPECT_NEAR(times[i] - times[i - 1], 0.02664, 1e-9);
  EXPECT_NEAR(static_cast<double>(times.size()), 10 / 0.02664, 1);
  EXPECT_GE(times.front(), 10);
  EXPECT_LE(times.back() + 0.02664 - 0.00666, 20 + 0.0001);  // the last odd beam has left before the end
  EXPECT_EQ(mount.laser.beams, 361);
}

TEST(Sweep, TheLinkLosesWholeScansOfTheMirrorInTheStatedShare) {
  Mount mount = one_laser("lms200", Pose::Identity()).mounts[0];
  mount.laser = load_laser("lms200", 38400);
  SensorSettings s = exact();
  s.late = 0.2;
  const std::vector<double> times = times_of(mount, 0, 2000, s);
  double late = 0;
  for (size_t i = 1; i < times.size(); ++i) {
    const double more = (times[i] - times[i - 1] - mount.laser.interval_s) / 0.02664;
    EXPECT_NEAR(more, std::round(more), 1e-6);
    late += more > 0.5;
  }
  const double n = static_cast<double>(times.size() - 1);
  EXPECT_NEAR(late / n, 0.2, 5 * std::sqrt(0.2 * 0.8 / n));
}

TEST(Sweep, LasersAreNotSynchronised) {
  const World tunnel = tunnel_world(20, 4, 2);
  const Drive stand = drive_of(1, [](double) { return pose_of({10, 0, 0}, 0); });
  const Recording r = record(tunnel, stand, load_rig("cart4", 38400), {}, SensorSettings{}, 5);
  for (size_t i = 0; i < 4; ++i)
    for (size_t j = 0; j < i; ++j) EXPECT_GT(std::abs(r.log.rig.mounts[i].phase_s - r.log.rig.mounts[j].phase_s), 1e-6);
}

TEST(Sweep, TheVehicleItselfStandsInTheRays) {
  const World tunnel = tunnel_world(20, 4, 2);
  const Drive stand = drive_of(0.2, [](double) { return pose_of({10, 0, 0}, 1.1); });
  const Hull hull{{"post", {1, -0.1, 0}, {1.1, 0.1, 2}, Label::vehicle}};
  const Recording r = record(tunnel, stand, one_laser("ideal", pose_of({0, 0, 1}, 0)), hull, exact(), 1);
  EXPECT_EQ(r.truth.scans[0].range_m[180], 1.0f);
  EXPECT_EQ(r.truth.scans[0].label[180], static_cast<int>(Label::vehicle));
  EXPECT_EQ(r.truth.scans[0].face[180], -1);
  EXPECT_EQ(r.truth.scans[0].part[180], -1);
  EXPECT_EQ(r.truth.scans[0].label[90], static_cast<int>(Label::rib));
  EXPECT_GE(r.truth.scans[0].face[90], 0);
}

}  // namespace
}  // namespace adit
