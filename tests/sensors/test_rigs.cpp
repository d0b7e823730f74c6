// SPDX-License-Identifier: BSD-3-Clause
#include "base/bundled.h"
#include "sensors/fan.h"
#include "sim/vehicle.h"
#include "tests/sensors/scenes.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

Vec3 point_W(const Recording& r, const Drive& stand, size_t mount, int k) {
  const Mount& m = r.truth.rig.mounts[mount];
  const double a = m.laser.beam_angle_rad(k);
  const double range_m = r.truth.scans[mount].range_m[k];
  return stand.path.X_WB[0] * m.X_BS * Vec3(range_m * std::cos(a), range_m * std::sin(a), 0);
}

TEST(Rigs, NoLaserOfTheCartSeesTheCartOrItsPusher) {
  Hull hull = load_vehicle("cart").hull;
  ASSERT_FALSE(hull.empty());
  // Two centimetres to spare: the spot is 12 mm wide at the window and mounts are not exact.
  for (Box& box : hull) {
    box.min_B.array() -= 0.02;
    box.max_B.array() += 0.02;
  }
  for (const Mount& mount : load_rig("cart4", 38400).mounts) {
    const std::vector<Meeting> shadow = make_fan(mount, make_bundle(1), hull, 0.3).shadow;
    for (size_t k = 0; k < shadow.size(); ++k) EXPECT_EQ(shadow[k].range_m, INFINITY) << mount.name << " beam " << k;
  }
}

TEST(Rigs, TheFansOfTheCartLeaveNoBlindBandInAnyPassage) {
  const Rig rig = load_rig("cart4", 500000);
  const int up = find_view(rig, View::up), down = find_view(rig, View::down);
  for (double width : {2.4, 3.7, 5.0})
    for (double height : {1.6, 1.9, 2.2})
      for (double off : {0.0, 0.5})
        for (double roll : {-0.06, 0.0, 0.06}) {
          const World tunnel = tunnel_world(20, width, height);
          const Drive stand = drive_of(0.2, [&](double) { return pose_of({10, off, 0}, 0, 0, roll); });
          const Recording r = record(tunnel, stand, rig, {}, exact(), 1);
          const Vec2 eye(off, 0.9);  // between the two mirrors: about it the section is one ring
          std::vector<double> angle;
          for (int mount : {up, down})
            for (int k = 0; k < 361; ++k) {
              const Vec3 p = point_W(r, stand, static_cast<size_t>(mount), k);
              angle.push_back(std::atan2(p.z() - eye.y(), p.y() - eye.x()));
            }
          std::sort(angle.begin(), angle.end());
          double gap = angle.front() + 2 * M_PI - angle.back();
          for (size_t i = 1; i < angle.size(); ++i) gap = std::max(gap, angle[i] - angle[i - 1]);
          // Half a degree at each mirror looks wider from the eye where a mirror is the nearer one, three times at
          // most; mirrors in the wrong order would leave 0.3 m of 2.5 m open, 7 degrees.
          EXPECT_LT(gap * 180 / M_PI, 1.5) << width << " x " << height << ", " << off << " m off, roll " << roll;
        }
}

TEST(Rigs, UpAndDownOverlapOnBothRibs) {
  const Rig rig = load_rig("cart4", 500000);
  const size_t up = static_cast<size_t>(find_view(rig, View::up)),
               down = static_cast<size_t>(find_view(rig, View::down));
  const World tunnel = tunnel_world(20, 3.7, 1.9);
  const Drive stand = drive_of(0.2, [](double) { return pose_of({10, 0, 0}, 0); });
  const Recording r = record(tunnel, stand, rig, {}, exact(), 1);
  for (int k : {0, 360}) {
    EXPECT_NEAR(point_W(r, stand, down, k).z() - point_W(r, stand, up, k).z(), 0.3, 1e-4);
    EXPECT_NEAR(std::abs(point_W(r, stand, up, k).y()), 1.85, 1e-4);
  }
}

TEST(Rigs, EachLaserOfTheCartLooksWhereItsNameSays) {
  const Rig rig = load_rig("cart4", 500000);
  const World tunnel = tunnel_world(20, 4, 2);
  const Drive stand = drive_of(0.2, [](double) { return pose_of({10, 0, 0}, 0); });
  const Recording r = record(tunnel, stand, rig, {}, exact(), 1);
  const auto middle = [&](View view) { return point_W(r, stand, static_cast<size_t>(find_view(rig, view)), 180); };
  EXPECT_NEAR((middle(View::horizontal) - Vec3(20, 0, 0.7)).norm(), 0, 1e-4);
  EXPECT_NEAR((middle(View::forward_vertical) - Vec3(20, 0, 0.9)).norm(), 0, 1e-4);
  EXPECT_NEAR((middle(View::up) - Vec3(10, 0, 2)).norm(), 0, 1e-4);
  EXPECT_NEAR((middle(View::down) - Vec3(9.3, 0, 0)).norm(), 0, 1e-4);
}

TEST(Rigs, EveryBundledRigAndLaserLoads) {
  for (const std::string& name : bundled_names("sensors/rigs"))
    EXPECT_FALSE(load_rig(name, 38400).mounts.empty()) << name;
  for (const std::string& name : bundled_names("sensors/lasers")) EXPECT_GT(load_laser(name, 38400).beams, 1) << name;
  EXPECT_EQ(load_rig("groundhog2", 38400).mounts.size(), 2u);
}

}  // namespace
}  // namespace adit
