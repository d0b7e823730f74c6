// SPDX-License-Identifier: BSD-3-Clause
#include "base/rig.h"
#include "mapper/local_map.h"
#include "mapper/odometry.h"
#include "mapper/stance.h"
#include "tests/support/shapes.h"
#include "tests/support/tube_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double degree = std::numbers::pi / 180;

Mount laser_ahead() {
  return load_rig("cart4", 38400).mounts[0];
}

Trajectory standing(const Pose& X_MB) {
  return {{0, 1}, {X_MB, X_MB}};
}

// A wall across the way at x = 5, seen by a laser that looks 6 deg down and is rolled by 4 deg.
TEST(Stance, BeamsEndWhereTheyAreInSpace) {
  const Mount mount = laser_ahead();
  const Pose X_MB = pose_of({1, 2, 3}, 0, 6 * degree, 4 * degree), X_MS = X_MB * mount.X_BS;
  std::vector<float> range_m(mount.laser.beams, std::numeric_limits<float>::infinity());
  std::vector<Vec3> end_M(mount.laser.beams, Vec3::Zero());
  for (int k = 0; k < mount.laser.beams; ++k) {
    const double a = mount.laser.beam_angle_rad(k);
    const Vec3 d = X_MS.linear() * Vec3(std::cos(a), std::sin(a), 0);
    if (d.x() < 0.7) continue;
    range_m[k] = static_cast<float>((5 - X_MS.translation().x()) / d.x());
    end_M[k] = X_MS.translation() + range_m[k] * d;
  }
  const std::vector<Stance> stances = stances_along(standing(X_MB), {0.5}, mount, 0.01);
  const ScanPoints points = scan_points(range_m, fan_of(mount), {}, {}, &stances[0]);
  // B is level where the laser stands in plan.
  const Pose2 X_MBl = flatten(X_MS) * flatten(mount.X_BS).inverse();
  ASSERT_GT(points.size(), 50u);
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3& end = end_M[points.beam[i]];
    EXPECT_LT((X_MBl * points.p_B[i] - Vec2(end.head<2>())).norm(), 1e-6);
    EXPECT_NEAR(points.z_m[i], end.z(), 1e-6);
    EXPECT_NEAR((X_MBl * points.normal_B[i] - X_MBl.position()).x(), -1, 1e-4);
  }
}

TEST(Stance, ALevelLaserSeesWhatOneWithoutAStanceSees) {
  const Mount mount = laser_ahead();
  std::vector<float> range_m(mount.laser.beams);
  for (int k = 0; k < mount.laser.beams; ++k) range_m[k] = 3 + 0.01F * static_cast<float>(k % 3);
  const std::vector<Stance> stances = stances_along(standing(Pose::Identity()), {0.5}, mount, 0.01);
  const ScanPoints plain = scan_points(range_m, fan_of(mount), {}, {});
  const ScanPoints lifted = scan_points(range_m, fan_of(mount), {}, {}, &stances[0]);
  ASSERT_EQ(plain.size(), lifted.size());
  for (size_t i = 0; i < plain.size(); ++i) {
    EXPECT_LT((plain.p_B[i] - lifted.p_B[i]).norm(), 1e-12);
    EXPECT_EQ(plain.z_m[i], 0);
    EXPECT_NEAR(lifted.z_m[i], mount.X_BS.translation().z(), 1e-12);
  }
  EXPECT_EQ(stances_along(standing(Pose::Identity()), {0.5}, mount, 0)[0].z_m_s, 0);
}

// A rib along x that leans away from the void by 0.3 m a metre of height, seen at two heights.
TEST(LocalMap, BetweenTheHeightsAtWhichARibWasSeenItLeans) {
  constexpr double lean = 0.3;
  ScanPoints low, high;
  for (int i = 0; i < 100; ++i)
    for (auto [scan, z_m] : {std::pair(&low, 0.95), {&high, 1.05}}) {
      scan->p_B.emplace_back(0.05 * i, lean * z_m), scan->normal_B.emplace_back(0, -1);
      scan->z_m.push_back(z_m), scan->beam.push_back(i);
      scan->sigma_m.push_back(0.01), scan->sigma_normal_rad.push_back(0.01);
    }
  const ScanPoints* scans[] = {&low, &high};
  const Pose2 poses[] = {{}, {}};
  const LocalMap map(scans, poses);
  const auto off_m = [&](double z_m) { return map.rib_near({2.5, lean * z_m}, z_m, {0, -1}, 0.25)->distance_m; };
  EXPECT_NEAR(off_m(1.0), 0, 1e-3);
  EXPECT_NEAR(off_m(0.97), 0, 0.002);
  // Told to be at one height the same rib is 0.03 m thick.
  EXPECT_GT(map.rib_near({2.5, lean * 0.95}, 1.0, {0, -1}, 0.25)->distance_m, 0.01);
  // Above all that was seen the slope is a guess, and the distance less certain for it.
  EXPECT_GT(map.rib_near({2.5, lean * 1.2}, 1.2, {0, -1}, 0.25)->sigma_m,
            2 * map.rib_near({2.5, lean}, 1.0, {0, -1}, 0.25)->sigma_m + 0.01);
}

TEST(LocalMap, RibsAtOneHeightAreCertainToTheLaserAlone) {
  ScanPoints scan;
  for (int i = 0; i < 100; ++i) {
    scan.p_B.emplace_back(0.05 * i, 1), scan.normal_B.emplace_back(0, -1), scan.z_m.push_back(0);
    scan.beam.push_back(i), scan.sigma_m.push_back(0.01), scan.sigma_normal_rad.push_back(0.01);
  }
  const ScanPoints* scans[] = {&scan};
  const Pose2 poses[] = {{}};
  EXPECT_EQ(LocalMap(scans, poses).rib_near({2.5, 1.02}, 0, {0, -1}, 0.25)->sigma_m, 0);
}

// A ring of passages with ribs that are rough in all three directions, and a cart that shakes as on a track bed.
TEST(Odometry, KnownPitchAndRollHalveTheErrorOfSteps) {
  const Ground ground{.roll_m = 0, .rough_m = 0.06, .seed = 3};
  const Mesh mesh = bent(ring_world(24, 5, 2.2, 0.2).mesh, ground);
  Rig rig;
  rig.name = "one";
  rig.mounts = {laser_ahead()};
  const Trajectory path = ride_along(ring_line(24, 5, 3, 0.6), ground, {.pitch_deg = 2.5, .roll_deg = 2});
  const Log log = tube_log(mesh, rig, path, 0.005, 4);
  const Mount& mount = rig.mounts[0];
  const std::vector<Stance> stances = stances_along(path, log.scans[0].stamp_s, mount, fan_of(mount).scan_s());
  std::vector<Pose2> truth;
  for (const double t : log.scans[0].stamp_s)
    truth.push_back(flatten(path.at(t) * mount.X_BS) * flatten(mount.X_BS).inverse());
  const auto off_rad = [&](const Odometry& o) {  // rms of the turn over two metres
    double sum = 0, count = 0;
    for (size_t i = 0, j = 0; i < truth.size(); ++i) {
      while (j < truth.size() && (truth[j].position() - truth[i].position()).norm() < 2) ++j;
      if (j == truth.size()) break;
      const double e = wrap_angle((o.X_MB[i].inverse() * o.X_MB[j]).yaw_rad - (truth[i].inverse() * truth[j]).yaw_rad);
      sum += e * e, ++count;
    }
    return std::sqrt(sum / count);
  };
  const Odometry flat = estimate_motion(log.scans[0], mount, {});
  const Odometry space = estimate_motion(log.scans[0], mount, {}, {}, stances);
  EXPECT_EQ(space.lost, 0);
  EXPECT_LT(off_rad(space), 0.5 * off_rad(flat));
}

}  // namespace
}  // namespace adit
