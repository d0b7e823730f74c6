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

TEST(Checklist, TheMirrorTakes37MicrosecondsADegreeAndFinerStepsWholeTurnsMore) {
  const double turn_s = 0.01332;
  for (const auto& [raster, next_s] :
       {std::pair{"180/1", 0.0}, {"180/0.5", turn_s}, {"100/0.25", 3 * turn_s}, {"180/0.25", 3 * turn_s}}) {
    const LaserModel m = load_laser("lms200", 500000, {"", raster});
    double most_s = 0;  // between neighbours, but for the way of the mirror from one to the next
    for (int k = 1; k < m.beams; ++k) {
      const double step_s = 37e-6 * (m.beam_angle_rad(k) - m.beam_angle_rad(k - 1)) * 180 / M_PI;
      most_s = std::max(most_s, std::abs(m.beam_offset_s(k) - m.beam_offset_s(k - 1) - step_s));
    }
    EXPECT_NEAR(most_s, next_s, 1e-9) << raster;  // 13.32 ms at half a degree, 39.96 ms at a quarter
    EXPECT_NEAR(m.beam_offset_s(m.beams - 1) - m.beam_offset_s(0), 37e-6 * m.fov_rad * 180 / M_PI, 1e-9);
  }
  const LaserModel narrow = load_laser("lms200", 0, {"", "100/0.5"});
  EXPECT_NEAR(90 + narrow.beam_angle_rad(0) * 180 / M_PI, 40, 1e-9);  // a sector of 40 to 140 deg
  EXPECT_NEAR(90 + narrow.beam_angle_rad(200) * 180 / M_PI, 140, 1e-9);
}

TEST(Checklist, OddBeamsOfAMovingLaserLieAComb9MillimetresOrPoint4DegreesOff) {
  const World room = tunnel_world(40, 4, 2);
  Rig rig = one_laser("ideal", pose_of({0, 0, 1}, 0));
  const auto range_m = [&](double v, double yaw_rate, int k) {
    const Drive drive = drive_of(0.2, [&](double t) { return pose_of({20 + v * t, 0, 0}, yaw_rate * t); });
    return static_cast<double>(record(room, drive, rig, {}, exact(), 1).truth.scans[0].range_m[static_cast<size_t>(k)]);
  };
  const double half = 0.5 * M_PI / 180;
  // 0.7 m/s for one turn and half a degree of the next, towards a wall ahead.
  EXPECT_NEAR(range_m(0.7, 0, 180) - range_m(0.7, 0, 181) * std::cos(half), 0.009, 0.0005);
  // 30 deg/s: the beam one to the left of 60 deg meets the rib 2 m away where one 0.9 deg to the left would.
  const double rate = 30 * M_PI / 180;
  const double turned = std::asin(2 / range_m(0, rate, 301)) - std::asin(2 / range_m(0, rate, 300));
  EXPECT_NEAR(turned * 180 / M_PI - 0.5, 0.4, 0.002);
}

TEST(Checklist, AStampOfArrivalIsLateByTheScanTheBufferAndTheLink) {
  // Telegrams of 372, 732 and 812 bytes leave in 1, 2 and 2 turns of 13.32 ms, then cross the link at ten bits a byte.
  const auto latency_s = [](const char* raster, int baud) {
    return load_laser("lms200", baud, {"", raster}).latency_s;
  };
  EXPECT_NEAR(latency_s("180/0.5", 38400), 0.02664 + 0.02664 + 7320 / 38400.0, 1e-12);
  EXPECT_NEAR(latency_s("180/1", 500000), 0.01332 + 0.01332 + 3720 / 500e3, 1e-12);
  EXPECT_NEAR(latency_s("100/0.25", 500000), 0.05328 + 0.02664 + 8120 / 500e3, 1e-12);
  EXPECT_NEAR(latency_s("180/0.25", 500000), 0.05328 + 0.01332 + 3720 / 500e3, 1e-12);  // one telegram a turn
  const World room = tunnel_world(40, 4, 2);
  SensorSettings s = exact();
  s.latency = true;
  const Recording r = record(room,
                             drive_of(1,
                                      [](double) {
                                        return pose_of({20, 0, 0}, 0);
                                      }),
                             one_laser("lms200", pose_of({0, 0, 1}, 0)), {}, s, 1);
  for (size_t i = 0; i < r.log.scans[0].size(); ++i)
    EXPECT_NEAR(r.log.scans[0].stamp_s[i] - r.truth.scans[0].stamp_s[i], latency_s("180/0.5", 500000), 1e-12);
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
