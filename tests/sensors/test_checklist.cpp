// SPDX-License-Identifier: BSD-3-Clause
// What anybody may read off the sheets of the SICK LMS 200, asked of whole recordings.
#include "tests/sensors/scenes.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

// Ranges of the middle beam at a wall that stands square before the laser, all effects as they are by default.
struct Wall {
  double mean_m = 0, sd_m = 0, seen = 0;  // seen: share of the scans
};

Wall wall_at(double range_m, float reflectivity, const std::string& mode, std::uint64_t seed) {
  World room = tunnel_world(range_m + 10, 4, 2, 2);
  room.mesh.reflectivity.assign(room.mesh.face.size(), reflectivity);
  const Drive stand = drive_of(60, [&](double) { return pose_of({10, 0, 0}, 0); });
  Rig rig{.name = "one", .mounts = {{.name = "laser", .laser = load_laser("lms200", 500000, {mode, ""})}}};
  rig.mounts[0].X_BS = pose_of({0, 0, 1}, 0);
  const Recording r = record(room, stand, rig, {}, {}, seed);
  const Scans& scans = r.log.scans[0];
  Wall wall;
  double n = 0, sum = 0, squares = 0;
  for (size_t i = 0; i < scans.size(); ++i) {
    const double got = static_cast<double>(scans[i][180]);
    if (!std::isfinite(got)) continue;
    ++n, sum += got, squares += got * got;
  }
  wall.seen = n / static_cast<double>(scans.size());
  if (n < 2) return wall;
  wall.mean_m = sum / n;
  wall.sd_m = std::sqrt((squares - sum * sum / n) / (n - 1));
  return wall;
}

TEST(Checklist, AHalfDegreeScanIs361ValuesIn26Point64Milliseconds) {
  const LaserModel laser = load_laser("lms200", 500000, {"", "180/0.5"});
  EXPECT_EQ(laser.beams, 361);
  EXPECT_NEAR(laser.turn_s * laser.interlace, 0.02664, 1e-12);
  EXPECT_NEAR(laser.interval_s, 0.02664, 1e-12);  // the telegram of 732 bytes takes 14.6 ms at 500 kBd: none is lost
  EXPECT_LT(732 * 10 / 500e3, laser.interval_s);
  // At 38.4 kBd it takes 190.6 ms: eight scans pass unheard.
  const LaserModel slow = load_laser("lms200", 38400);
  EXPECT_NEAR(slow.interval_s, 9 * 0.02664, 1e-12);
  EXPECT_GT(slow.interval_s, 732 * 10 / 38400.0);
  EXPECT_LT(slow.interval_s - 0.02664 * 2, 732 * 10 / 38400.0);  // not more than the link needs, and one scan of grace
}

TEST(Checklist, The8MetreModeEndsAt8Point183Metres) {
  EXPECT_NEAR(load_laser("lms200", 0, {"8m", ""}).range_max_m, 8.183, 1e-12);
  EXPECT_GT(wall_at(8.1, 0.8F, "8m", 1).seen, 0.99);
  EXPECT_EQ(wall_at(8.3, 0.8F, "8m", 1).seen, 0);
}

TEST(Checklist, ATenPercentTargetIsSeenAt9MetresAndNotAt11) {
  EXPECT_GT(wall_at(9, 0.1F, "80m", 1).seen, 0.5);
  EXPECT_LT(wall_at(11, 0.1F, "80m", 1).seen, 0.2);
}

TEST(Checklist, CoalOf4PercentIsSeenAt5MetresAndNotAt8) {
  EXPECT_GT(wall_at(5, 0.04F, "80m", 1).seen, 0.9);
  EXPECT_LT(wall_at(8, 0.04F, "80m", 1).seen, 0.05);
}

TEST(Checklist, AWhiteWallAt5MetresIsToldWithin15MillimetresWithAnSdOf5) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Wall wall = wall_at(5, 0.9F, "8m", seed);
    EXPECT_NEAR(wall.mean_m, 5, 0.015) << "seed " << seed;
    // Five standard errors of an sd over 2250 scans, the millimetre's rounding and what the direction's error adds.
    EXPECT_NEAR(wall.sd_m, 0.005, 5 * 0.005 / std::sqrt(2 * 2250.0) + 0.0002) << "seed " << seed;
  }
}

}  // namespace
}  // namespace adit
