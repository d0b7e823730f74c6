// SPDX-License-Identifier: BSD-3-Clause
#include "base/carmen.h"
#include "base/error.h"
#include "base/files.h"
#include "base/rng.h"
#include "tests/support/errors.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace adit {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

Log a_log(const LaserModel& laser) {
  Log log;
  log.rig.name = "one";
  log.rig.mounts.push_back({.name = "front", .laser = laser});
  Scans scans;
  scans.beams = laser.beams;
  for (int n = 0; n < 20; ++n) {
    scans.stamp_s.push_back(1.5 + 0.24 * n);
    for (int k = 0; k < laser.beams; ++k) {
      const double u = uniform(3, Draw::test, n, k);
      const float none = std::numeric_limits<float>::infinity(), unread = std::numeric_limits<float>::quiet_NaN();
      scans.range_m.push_back(u < 0.05 ? none : u < 0.1 ? unread : static_cast<float>(std::round(3e4 * u) * 1e-3));
    }
  }
  log.scans.push_back(scans);
  return log;
}

Truth a_truth(const Log& log) {
  Truth truth;
  truth.rig = log.rig;
  for (int i = 0; i < 100; ++i) {
    truth.drive.path.stamp_s.push_back(0.1 * i);
    truth.drive.path.X_WB.push_back(pose_of({0.1 * i, 2, 0.3}, 0.01 * i, 0.02, 0.01));
  }
  truth.scans.emplace_back();
  truth.scans[0].stamp_s = log.scans[0].stamp_s;
  return truth;
}

TEST(Carmen, ALogComesBackWithItsRangesStampsAndRasterInEitherStyle) {
  for (const char* raster : {"180/1", "180/0.5"})
    for (CarmenStyle style : {CarmenStyle::flaser, CarmenStyle::robotlaser}) {
      const Log log = a_log(load_laser("lms200", 38400, {"", raster}));
      write_carmen(scratch("a.log"), log, style);
      const CarmenLog back = read_carmen(scratch("a.log"));
      ASSERT_EQ(back.log.scans.size(), 1u);
      const LaserModel &told = log.rig.mounts[0].laser, &got = back.log.rig.mounts[0].laser;
      EXPECT_EQ(got.beams, told.beams);
      EXPECT_EQ(got.interlace, told.interlace);
      EXPECT_NEAR(got.fov_rad, told.fov_rad, 1e-6);
      EXPECT_NEAR(got.range_max_m, told.range_max_m, 1e-9);
      EXPECT_NEAR(back.log.rig.mounts[0].X_BS.linear()(1, 0), 0, 1e-6);  // straight ahead
      ASSERT_EQ(back.log.scans[0].size(), 20u);
      for (size_t n = 0; n < 20; ++n) EXPECT_NEAR(back.log.scans[0].stamp_s[n], log.scans[0].stamp_s[n], 1e-6);
      for (size_t k = 0; k < log.scans[0].range_m.size(); ++k) {
        const float a = log.scans[0].range_m[k], b = back.log.scans[0].range_m[k];
        if (std::isfinite(a))
          EXPECT_NEAR(a, b, 1e-5);  // three decimals, as told
        else
          EXPECT_EQ(b, INFINITY);  // the format has one word for both
      }
    }
}

TEST(Carmen, TruePosesComeBackInThePlane) {
  const Log log = a_log(load_laser("lms200", 38400));
  const Truth truth = a_truth(log);
  write_carmen(scratch("t.log"), log, CarmenStyle::flaser, &truth);
  const CarmenLog back = read_carmen(scratch("t.log"));
  ASSERT_EQ(back.true_path.size(), 20u);
  for (size_t n = 0; n < 20; ++n) {
    const Pose2 was = flatten(truth.drive.path.at(truth.scans[0].stamp_s[n])), is = flatten(back.true_path.X_WB[n]);
    EXPECT_NEAR(was.x_m, is.x_m, 1e-6);
    EXPECT_NEAR(was.y_m, is.y_m, 1e-6);
    EXPECT_NEAR(was.yaw_rad, is.yaw_rad, 1e-8);
  }
}

TEST(Carmen, LinesOfRealLogsAreRead) {
  // As CARMEN and its forerunners wrote them: an even count leaves out the last beam; remissions and turn axis came later.
  write_text(scratch("real.clf"),
             "# CARMEN Logfile\n"
             "PARAM robot_length 0.6 976052857.1 nohost 0\n"
             "FLASER 4 1.0 2.00 81.91 3.50 0.5 0.1 0.2 1.5 -0.25 0.7 976052857.337 nohost 0.250\n"
             "ODOM 0 0 0 0 0 0 976052857.4 nohost 0.3\n"
             "FLASER 4 1.0 2.00 3.0 3.50 0.5 0.1 0.2 1.6 -0.25 0.7 976052857.837 nohost 0.750\r\n");
  const CarmenLog old = read_carmen(scratch("real.clf"));
  EXPECT_EQ(old.log.scans[0].beams, 4);
  EXPECT_NEAR(old.log.rig.mounts[0].laser.fov_rad, 135 * M_PI / 180, 1e-9);
  EXPECT_NEAR(flatten(old.log.rig.mounts[0].X_BS).yaw_rad, -22.5 * M_PI / 180, 1e-9);
  EXPECT_EQ(old.log.scans[0][0][2], INFINITY);
  EXPECT_EQ(old.log.scans[0][0][3], 3.5F);
  EXPECT_NEAR(old.log.scans[0].stamp_s[1], 976052857.837, 1e-6);  // of the message, not of the logger
  EXPECT_NEAR(old.odometry.X_WB[1].translation().x(), 1.6, 1e-12);
  const std::string head = "ROBOTLASER1 0 -1.570796 3.141593 1.570796 81.92 0.01 0 3 1 2 81.92 ";
  const std::string poses = "1 2 0.1 3 4 0.2 0 0 0.5 0.3 ", stamps = "976052857.3 host 0.5\n";
  for (const std::string& middle : {poses, "0 " + poses + "0 ", "3 7 8 9 " + poses + "1e8 "}) {
    write_text(scratch("new.clf"), head + middle + stamps);
    const CarmenLog log = read_carmen(scratch("new.clf"));
    EXPECT_EQ(log.log.scans[0][0][1], 2.0F) << middle;
    EXPECT_EQ(log.log.scans[0][0][2], INFINITY);
    EXPECT_NEAR(log.odometry.X_WB[0].translation().y(), 4, 1e-12) << middle;
  }
}

TEST(Carmen, BadLinesAreLeftOutCountedAndTheFirstIsNamed) {
  const std::string good = "FLASER 2 1 2 0 0 0 0 0 0 1 h 1\n", next = "FLASER 2 1 2 0 0 0 0 0 0 7 h 7\n";
  for (const auto& [bad, why] : {std::pair<std::string, std::string>{"FLASER 2 1 2 0 0 0\n", "this line is cut short"},
                                 {"FLASER 2 1 x 0 0 0 0 0 0 2 h 2\n", "has 'x' where a number"},
                                 {"FLASER 99 1 2 0 0 0 0 0 0 2 h 2\n", "count of 99"},
                                 {"FLASER 3 1 2 3 0 0 0 0 0 0 2 h 2\n", "another raster"},
                                 {"FLASER 2 1 2 0 0 0 0 0 0 0.5 h 2\n", "does not grow"},
                                 {good, "does not grow"}}) {
    write_text(scratch("bad.log"), good + bad + next);
    const CarmenLog log = read_carmen(scratch("bad.log"));
    EXPECT_EQ(log.log.scans[0].stamp_s, (std::vector<double>{1, 7})) << bad;
    EXPECT_EQ(log.log.scans[0].range_m.size(), 4u) << bad;
    ASSERT_EQ(log.notes.size(), 1u) << bad;
    EXPECT_THAT(log.notes[0], HasSubstr("1 line is left out, the first: ")) << bad;
    EXPECT_THAT(log.notes[0], HasSubstr("bad.log:2: this line ")) << bad;
    EXPECT_THAT(log.notes[0], HasSubstr(why));
  }
  write_text(scratch("cut.log"), good + "FLASER 2 1 2 0 0 0 0");  // as a logger leaves it that is stopped
  EXPECT_THAT(read_carmen(scratch("cut.log")).notes, ElementsAre(HasSubstr("cut.log:2: this line is cut short")));
}

TEST(Carmen, WhereMostLinesAreBadOrNoneIsOfALaserItIsAnError) {
  write_text(scratch("none.log"), "# nothing\n");
  EXPECT_THAT(error_of([] { read_carmen(scratch("none.log")); }), HasSubstr("none.log: has no FLASER"));
  const std::string good = "FLASER 2 1 2 0 0 0 0 0 0 1 h 1\n", bad = "FLASER 2 1 2\n";
  write_text(scratch("most.log"), good + bad + bad);
  EXPECT_THAT(error_of([] { read_carmen(scratch("most.log")); }),
              HasSubstr("most.log:2: this line is cut short; so are"));
}

TEST(Carmen, RangesThatAreNotNumbersAreNoEchoOrUnreadable) {
  write_text(scratch("nan.log"), "FLASER 3 nan 2 inf 0 0 0 0 0 0 1 h 1\n");
  const CarmenLog log = read_carmen(scratch("nan.log"));
  EXPECT_TRUE(std::isnan(log.log.scans[0][0][0]));
  EXPECT_EQ(log.log.scans[0][0][1], 2.0F);
  EXPECT_EQ(log.log.scans[0][0][2], INFINITY);
  EXPECT_TRUE(log.notes.empty());
}

TEST(Carmen, ARigWithoutAHorizontalLaserCannotBeWritten) {
  Log log = a_log(load_laser("lms200", 38400));
  log.rig.mounts[0].X_BS = pose_of(Vec3::Zero(), 0, M_PI / 2);
  EXPECT_THROW(write_carmen(scratch("none.log"), log, CarmenStyle::flaser), Error);
}

}  // namespace
}  // namespace adit
