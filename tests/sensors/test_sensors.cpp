// SPDX-License-Identifier: BSD-3-Clause
#include "base/h5.h"
#include "base/parallel.h"
#include "sensors/sensors.h"
#include "tests/sensors/scenes.h"
#include "tests/support/errors.h"
#include "tests/support/scratch.h"
#include "tests/support/shapes.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace adit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Drive round_the_ring(double duration_s) {
  return drive_of(duration_s, [](double t) {
    return pose_of({8 * std::cos(0.1 * t), 8 * std::sin(0.1 * t), 0}, 0.1 * t + M_PI / 2, 0.02 * std::sin(3 * t), 0);
  });
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

// Whatever can be switched on.
SensorSettings everything() {
  SensorSettings s;
  s.sub_rays = 7;
  s.range_curve = s.energy = s.warm_up = s.latency = true;
  s.counter_mm = 10, s.dirty_window = 1.2, s.dust_loss_per_m = s.dust_echo_per_m = 0.02, s.crosstalk = 0.01;
  s.dazzle_deg = 3;
  s.faults = {"front freezes from_s=5 to_s=7", "up slips from_s=4 yaw_deg=1", "down loses from_s=1 share=0.5"};
  return s;
}

void expect_same_on_any_number_of_threads(SensorSettings s) {
  const World world = ring_world(20, 4, 2, 1);
  const Drive drive = round_the_ring(10);
  s.mount_error_deg = 0.2;
  std::vector<Recording> got;
  for (int threads : {1, 2, 7}) {
    set_threads(threads);
    got.push_back(record(world, drive, load_rig("cart4", 38400), {}, s, 11));
  }
  set_threads(0);
  for (size_t n = 1; n < got.size(); ++n)
    for (size_t i = 0; i < 4; ++i) {
      EXPECT_TRUE(same_bits(got[0].log.scans[i].stamp_s, got[n].log.scans[i].stamp_s));
      EXPECT_TRUE(same_bits(got[0].log.scans[i].range_m, got[n].log.scans[i].range_m));
      EXPECT_TRUE(same_bits(got[0].truth.scans[i].range_m, got[n].truth.scans[i].range_m));
      EXPECT_TRUE(same_bits(got[0].truth.scans[i].face, got[n].truth.scans[i].face));
      EXPECT_TRUE(same_bits(got[0].truth.scans[i].incidence_rad, got[n].truth.scans[i].incidence_rad));
      EXPECT_TRUE(same_bits(got[0].truth.scans[i].fault, got[n].truth.scans[i].fault));
    }
  const Recording other = record(world, drive, load_rig("cart4", 38400), {}, s, 12);
  EXPECT_FALSE(same_bits(got[0].log.scans[0].range_m, other.log.scans[0].range_m));
}

TEST(Sensors, TheSameSeedGivesTheSameRecordingOnAnyNumberOfThreads) {
  expect_same_on_any_number_of_threads({});
}

TEST(Sensors, SoItDoesWithEverythingSwitchedOn) {
  expect_same_on_any_number_of_threads(everything());
}

TEST(Sensors, TheLogDoesNotKnowWhereTheWorldLies) {
  World here = ring_world(20, 4, 2, 1), there = here;
  const Pose X = pose_of({128, -64, 8}, M_PI / 2);
  for (Vec3& v : there.mesh.vertex) v = X * v;
  Drive drive = round_the_ring(10), moved = drive;
  for (Pose& X_WB : moved.path.X_WB) X_WB = X * X_WB;
  const Rig rig = load_rig("cart4", 38400);
  const Log a = record(here, drive, rig, {}, SensorSettings{}, 3).log;
  const Log b = record(there, moved, rig, {}, SensorSettings{}, 3).log;
  size_t differ = 0, beams = 0;
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(a.scans[i].stamp_s, b.scans[i].stamp_s);
    for (size_t k = 0; k < a.scans[i].range_m.size(); ++k, ++beams) {
      const float p = a.scans[i].range_m[k], q = b.scans[i].range_m[k];
      if (std::isfinite(p) && std::isfinite(q) && std::abs(p - q) > 1e-6) ++differ;
    }
  }
  // Where a range falls on the edge of a millimetre, or a beam on the edge of a corner, the last bits decide.
  EXPECT_LT(static_cast<double>(differ), 2e-3 * static_cast<double>(beams));
}

TEST(Sensors, TheLogHoldsTheNominalRigAndTheTruthTheTrueOne) {
  const Rig nominal = load_rig("cart4", 38400);
  SensorSettings s;
  s.mount_error_deg = 1;
  s.mount_error_m = 0.01;
  const Recording r = record(ring_world(20, 4, 2, 5), round_the_ring(2), nominal, {}, s, 3);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(r.log.rig.mounts[i].X_BS.matrix(), nominal.mounts[i].X_BS.matrix());
    EXPECT_NE(r.truth.rig.mounts[i].X_BS.matrix(), nominal.mounts[i].X_BS.matrix());
  }
  const std::string file = scratch("sensors_log.h5");
  save_log(file, r.log);
  const H5Reader in(file);
  EXPECT_THAT(in.names("/"), ElementsAre("rig", "scans"));
  EXPECT_THAT(in.names("/scans"), ElementsAre("down", "front", "profile", "up"));
  EXPECT_THAT(in.names("/scans/up"), ElementsAre("ranges_mm", "stamp_s"));
  EXPECT_THAT(in.names("/rig/up"), ElementsAre("X_BS"));
}

// A drive as it comes while it is driven, so many poses at a time.
std::vector<Drive> in_stretches(const Drive& drive, size_t poses) {
  std::vector<Drive> stretches;
  for (size_t from = 0; from < drive.path.size(); from += poses) {
    const size_t to = std::min(from + poses, drive.path.size());
    stretches.push_back(drive);
    Drive& stretch = stretches.back();
    stretch.path.stamp_s = {drive.path.stamp_s.begin() + from, drive.path.stamp_s.begin() + to};
    stretch.path.X_WB = {drive.path.X_WB.begin() + from, drive.path.X_WB.begin() + to};
    if (to < drive.path.size()) stretch.end = DriveEnd::underway;
  }
  return stretches;
}

TEST(Sensors, PiecesPutTogetherAreTheWholeAlsoAcrossAFault) {
  const World world = ring_world(20, 4, 2, 1);
  Drive drive = round_the_ring(20);
  drive.ground = {1, 0, 2};
  drive.end = DriveEnd::stuck;
  SensorSettings s;
  s.faults = {"front freezes from_s=5 to_s=13", "up slips from_s=8 yaw_deg=1", "down loses from_s=1 share=0.5"};
  const Rig rig = load_rig("cart4", 38400);
  const Recording whole = record(world, drive, rig, {}, s, 11);
  Recording sum;
  size_t pieces = 0;
  const Hull nothing;
  Recorder recorder(world, rig, nothing, s, 11, 3.7, [&](Recording&& piece) {
    if (pieces++ == 0)
      sum = std::move(piece);
    else
      append(sum, piece);
  });
  for (const Drive& stretch : in_stretches(drive, 131)) recorder.add(stretch);
  EXPECT_EQ(pieces, 6u);  // 20 s / 3.7 s
  EXPECT_EQ(sum.truth.drive.path.stamp_s, drive.path.stamp_s);
  EXPECT_EQ(sum.truth.drive.ground, drive.ground);
  EXPECT_EQ(sum.truth.drive.end, DriveEnd::stuck);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_TRUE(same_bits(sum.log.scans[i].stamp_s, whole.log.scans[i].stamp_s));
    EXPECT_TRUE(same_bits(sum.log.scans[i].range_m, whole.log.scans[i].range_m));
    EXPECT_TRUE(same_bits(sum.truth.scans[i].range_m, whole.truth.scans[i].range_m));
    EXPECT_TRUE(same_bits(sum.truth.scans[i].fault, whole.truth.scans[i].fault));
  }
}

TEST(Sensors, AMountThatNodsAtAStandTellsHowFarAndSeesFloorAndRoof) {
  // Stands until 20 s, then drives on.
  const World tunnel = tunnel_world(60, 4, 2);
  const Drive drive = drive_of(25, [](double t) { return pose_of({20 + std::max(0.0, t - 20), 0, 0}, 0); });
  Rig rig = one_laser("ideal", pose_of({0, 0, 1}, 0));
  rig.mounts[0].tilt = {-0.5, 0.5, 10, true};
  const Recording r = record(tunnel, drive, rig, {}, exact(), 1);
  const Scans& scans = r.log.scans[0];
  ASSERT_EQ(scans.tilt_rad.size(), scans.size());
  EXPECT_EQ(r.truth.scans[0].tilt_rad, scans.tilt_rad);
  double least = 0, most = 0;
  for (size_t n = 0; n < scans.size(); ++n) {
    const double tilt = scans.tilt_rad[n], r_m = r.truth.scans[0].range_m[n * 361 + 180];  // the middle beam
    if (scans.stamp_s[n] > 10.1) {
      EXPECT_EQ(tilt, 0) << n;
    }  // one nod of 10 s a stand
    // Straight ahead and tilted: the floor 1 m below, the roof 1 m above, or the end of the tunnel.
    const double ahead_m = 40 - std::max(0.0, scans.stamp_s[n] - 20);
    const double expected = std::min(1 / std::max(1e-9, std::abs(std::sin(tilt))), ahead_m / std::cos(tilt));
    EXPECT_NEAR(r_m, expected, 1e-3 + 1e-4 * expected) << n << " at " << tilt;
    if (tilt > 0.1) {
      EXPECT_EQ(r.truth.scans[0].label[n * 361 + 180], static_cast<int>(Label::floor));
    }
    if (tilt < -0.1) {
      EXPECT_EQ(r.truth.scans[0].label[n * 361 + 180], static_cast<int>(Label::roof));
    }
    least = std::min(least, tilt), most = std::max(most, tilt);
  }
  EXPECT_NEAR(most, 0.5, 0.01);  // 37.5 scans a second, 0.2 rad a second
  EXPECT_NEAR(least, -0.5, 0.01);
  const Log level = level_scans(r.log);
  EXPECT_LT(level.scans[0].size(), scans.size());
  for (const double tilt : level.scans[0].tilt_rad) EXPECT_EQ(tilt, 0);
}

TEST(Sensors, CrosstalkFallsWithTheDistanceToTheOtherLaserAndEndsAt6Metres) {
  const World tunnel = tunnel_world(60, 8, 4, 2);
  const Drive stand = drive_of(20, [](double) { return pose_of({30, 0, 0}, 0); });
  for (const double apart_m : {0.0, 3.0, 7.0}) {
    Rig rig = one_laser("ideal", pose_of({0, 0, 1}, 0));
    rig.mounts.push_back(rig.mounts[0]);
    rig.mounts[1].name = "other";
    rig.mounts[1].X_BS = pose_of({apart_m, 0, 1}, 0);
    SensorSettings s = exact();
    s.crosstalk = 0.02;
    const Recording r = record(tunnel, stand, rig, {}, s, 1);
    double stray = 0, n = 0;
    for (const std::uint8_t fault : r.truth.scans[0].fault) ++n, stray += (fault & trouble::stray) != 0;
    const double share = 0.02 * std::max(0.0, 1 - apart_m / 6);
    EXPECT_NEAR(stray / n, share, 5 * std::sqrt(share / n)) << apart_m;
  }
}

TEST(Sensors, LoggedStampsErrAboutTheTrueOnesWithinTheJitter) {
  SensorSettings s;
  s.jitter_s = 0.002;
  const Recording r = record(ring_world(20, 4, 2, 5), round_the_ring(60), load_rig("cart4", 38400), {}, s, 3);
  for (size_t i = 0; i < 4; ++i) {
    const std::vector<double>&told = r.log.scans[i].stamp_s, &so = r.truth.scans[i].stamp_s;
    ASSERT_EQ(told.size(), so.size());
    double most = 0;
    for (size_t n = 0; n < so.size(); ++n) most = std::max(most, std::abs(told[n] - so[n]));
    EXPECT_LE(most, 0.002);
    EXPECT_GE(most, 0.0018);  // of 200 even draws none reaches the outer tenth with odds of 0.9^200 = 7e-10
  }
  s.jitter_s = 0;
  const Recording exact_stamps = record(ring_world(20, 4, 2, 5), round_the_ring(5), load_rig("cart4", 38400), {}, s, 3);
  EXPECT_EQ(exact_stamps.log.scans[0].stamp_s, exact_stamps.truth.scans[0].stamp_s);
}

TEST(Sensors, ARecordingComesBackFromItsFilesBitForBit) {
  const Recording r = record(ring_world(20, 4, 2, 1), round_the_ring(5), load_rig("cart4", 38400), {}, {}, 4);
  const std::string file = scratch("sensors_back.h5");
  save_log(file, r.log);
  const Log back = load_log(file);
  for (size_t i = 0; i < 4; ++i) {
    ASSERT_EQ(back.scans[i].range_m.size(), r.log.scans[i].range_m.size());
    for (size_t k = 0; k < back.scans[i].range_m.size(); ++k) {
      const float a = r.log.scans[i].range_m[k], b = back.scans[i].range_m[k];
      ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << a << " " << b;
    }
  }
}

TEST(Sensors, BeamsTellLabelPartPassageAndFaceOfTheRockThatTheyMeet) {
  World world = tunnel_world(30, 4, 2, 0.5);
  for (size_t f = 0; f < world.mesh.face.size(); ++f) world.mesh.passage.push_back(static_cast<int>(f % 5));
  const Drive stand = drive_of(0.5, [](double) { return pose_of({15, 0, 0}, 0); });
  const Recording r = record(world, stand, load_rig("cart4", 500000), {}, exact(), 1);
  for (const ScanTruth& truth : r.truth.scans)
    for (size_t k = 0; k < truth.range_m.size(); ++k) {
      ASSERT_GE(truth.face[k], 0);
      EXPECT_EQ(truth.label[k], static_cast<int>(world.mesh.label[truth.face[k]]));
      EXPECT_EQ(truth.part[k], world.mesh.part[truth.face[k]]);
      EXPECT_EQ(truth.passage[k], world.mesh.passage[truth.face[k]]);
    }
}

TEST(Sensors, ADarkMineIsSeenLessFarThanADustedOne) {
  const Drive stand = drive_of(1, [](double) { return pose_of({30, 0, 0}, 0); });
  for (float rho : {0.04f, 0.45f}) {
    World world = tunnel_world(60, 4, 2);
    world.mesh.reflectivity.assign(world.mesh.face.size(), rho);
    const Recording r = record(world, stand, one_laser("lms200", pose_of({0, 0, 1}, 0)), {}, {}, 1);
    // On a rib 2 m beside, the cosine of incidence falls as 2 m / r: half of the echoes are left where
    // r^2.98 = 2 m * rho / 0.0185 * (4 m)^1.98, at 4.3 m of coal and at 9.8 m of dust.
    const double limit_m = std::pow(2 * rho / 0.0185 * std::pow(4, 1.98), 1 / 2.98);
    double near = 0, seen_near = 0, far = 0, seen_far = 0;
    for (size_t k = 0; k < r.truth.scans[0].range_m.size(); ++k) {
      const double range_m = r.truth.scans[0].range_m[k];
      const bool seen = std::isfinite(r.log.scans[0].range_m[k]);
      if (range_m < 0.8 * limit_m) ++near, seen_near += seen;
      if (range_m > 1.15 * limit_m && range_m < 20) ++far, seen_far += seen;  // the ends are met head-on
    }
    EXPECT_GT(seen_near, 0.95 * near) << rho;
    EXPECT_LT(seen_far, 0.05 * far) << rho;  // 1.15^2.98 = e^0.42, four spreads below: one in sixty, fewer beyond
    EXPECT_GT(far, 100);
  }
}

TEST(Sensors, BadInputIsAnsweredByItsCause) {
  const World world = tunnel_world(20, 4, 2);
  const auto stand = [](double seconds, double z) {
    return drive_of(seconds, [z](double) { return pose_of({10, 0, z}, 0); });
  };
  const Rig rig = load_rig("cart4", 38400);
  EXPECT_THAT(error_of([&] { record(world, stand(1, 1.5), rig, {}, {}, 1); }),
              HasSubstr("inside the rock at (10.50, 0.00, 2.20)"));
  World flooded = world;
  flooded.mesh.label.assign(flooded.mesh.face.size(), Label::water);
  EXPECT_THAT(error_of([&] { record(flooded, stand(1, 1.5), rig, {}, {}, 1); }),
              HasSubstr("under water at (10.50, 0.00, 2.20)"));
  EXPECT_THAT(error_of([&] { record(world, stand(0.01, 0), rig, {}, {}, 1); }), HasSubstr("too short"));
  EXPECT_THAT(error_of([&] { record(world, Drive{}, rig, {}, {}, 1); }), HasSubstr("fewer than two poses"));
  SensorSettings s;
  s.jitter_s = 0.02;
  EXPECT_THAT(error_of([&] { record(world, stand(1, 0), rig, {}, s, 1); }), HasSubstr("jitter_s"));
}

}  // namespace
}  // namespace adit
