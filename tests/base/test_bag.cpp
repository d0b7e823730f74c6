// SPDX-License-Identifier: BSD-3-Clause
#include "base/bag.h"
#include "base/bag_format.h"
#include "base/error.h"
#include "base/files.h"
#include "base/rng.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>

namespace adit {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

Log some_log(int scans) {
  Log log{{.name = "pair", .mounts = {}}, {}};
  for (const char* name : {"front", "up"}) {
    Mount mount{.name = name, .laser = load_laser("lms200", 38400)};
    mount.X_BS = pose_of({0.5, 0.1, 0.7}, 0.2, name[0] == 'u' ? -1.5 : 0.0, 0.1);
    log.rig.mounts.push_back(mount);
    Scans s;
    s.beams = mount.laser.beams;
    for (int i = 0; i < scans; ++i) {
      s.stamp_s.push_back(0.013 + 0.24 * i + (name[0] == 'u' ? 0.05 : 0));
      for (int k = 0; k < s.beams; ++k) {
        const double u = uniform(5, Draw::test, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(k));
        s.range_m.push_back(u < 0.05 ? INFINITY : u < 0.1 ? NAN : static_cast<float>(std::round(u * 30000) * 1e-3));
      }
    }
    log.scans.push_back(s);
  }
  return log;
}

Truth truth_of(const Log& log) {
  Truth truth;
  truth.rig = log.rig;
  for (int i = 0; i < 400; ++i) {
    truth.drive.path.stamp_s.push_back(i / 120.0);
    truth.drive.path.X_WB.push_back(pose_of({0.01 * i, 0.02 * i, 0.1}, 0.01 * i, 0.05));
  }
  return truth;
}

bool same(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void expect_same_scans(const Log& a, const Log& b, size_t scans) {
  ASSERT_EQ(a.scans.size(), b.scans.size());
  for (size_t i = 0; i < a.scans.size(); ++i) {
    ASSERT_GE(a.scans[i].size(), scans);
    for (size_t n = 0; n < scans; ++n) {
      EXPECT_NEAR(a.scans[i].stamp_s[n], b.scans[i].stamp_s[n], 1e-9);  // nanoseconds
      for (size_t k = 0; k < 361; ++k)
        ASSERT_TRUE(same(a.scans[i][n][k], b.scans[i][n][k])) << i << " " << n << " " << k;
    }
  }
}

TEST(Bag, ALogComesBackWithItsScansMountsAndPath) {
  const Log log = some_log(14);
  const Truth truth = truth_of(log);
  write_bag(scratch("whole.bag"), log, &truth);
  const BagLog back = read_bag(scratch("whole.bag"));
  EXPECT_THAT(back.notes, IsEmpty());
  expect_same_scans(back.log, log, 14);
  for (size_t i = 0; i < 2; ++i) {
    const Mount &a = back.log.rig.mounts[i], &b = log.rig.mounts[i];
    EXPECT_EQ(a.name, b.name);
    EXPECT_TRUE(a.X_BS.isApprox(b.X_BS, 1e-7));  // its angles are floats
    EXPECT_EQ(a.laser.beams, b.laser.beams);
    EXPECT_EQ(a.laser.interlace, b.laser.interlace);
    EXPECT_NEAR(a.laser.fov_rad, b.laser.fov_rad, 1e-5);
    EXPECT_NEAR(a.laser.turn_s, b.laser.turn_s, 1e-8);
    EXPECT_NEAR(a.laser.interval_s, b.laser.interval_s, 1e-3);
  }
  ASSERT_GT(back.path.size(), 80u);  // 3.3 s at 30 Hz
  for (size_t i = 0; i < back.path.size(); ++i)
    EXPECT_TRUE(back.path.X_WB[i].isApprox(truth.drive.path.at(back.path.stamp_s[i]), 1e-6)) << i;
}

TEST(Bag, TheSameLogGivesTheSameBytes) {
  write_bag(scratch("a.bag"), some_log(5));
  write_bag(scratch("b.bag"), some_log(5));
  EXPECT_TRUE(read_text(scratch("a.bag")) == read_text(scratch("b.bag")));
}

TEST(Bag, OfABagWhoseEndIsCutOffTheScansBeforeAreReadAndItIsSaid) {
  const Log log = some_log(600);  // more than one chunk
  write_bag(scratch("long.bag"), log);
  const std::string bytes = read_text(scratch("long.bag"));
  ASSERT_GT(bytes.size(), size_t{1600000});
  write_text(scratch("cut.bag"), bytes.substr(0, 1200000));
  const BagLog back = read_bag(scratch("cut.bag"));
  ASSERT_EQ(back.notes.size(), 1u);
  EXPECT_THAT(back.notes[0], HasSubstr("cut off"));
  // 1.2 MB of some 1.6 KB a scan of each of two lasers, the broken chunk's whole messages among them.
  EXPECT_GT(back.log.scans[0].size(), 350u);
  EXPECT_LT(back.log.scans[0].size(), 400u);
  expect_same_scans(back.log, log, 350);
}

TEST(Bag, WhatIsNoBagIsAnErrorWithItsCause) {
  const auto error_of = [](const std::string& text) -> std::string {
    write_text(scratch("bad.bag"), text);
    try {
      read_bag(scratch("bad.bag"));
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of("FLASER 1 2 3"), HasSubstr("is not a ROS 1 bag"));
  EXPECT_THAT(error_of("#ROSBAG V1.2\n"), HasSubstr("version 1"));
  EXPECT_THAT(error_of("#ROSBAG V2.0\n"), HasSubstr("no message of sensor_msgs/LaserScan"));
  EXPECT_THROW(read_bag(scratch("absent.bag")), Error);
}

// Bits turned anywhere make an Error or notes, never a crash; the sanitizers look on.
TEST(Bag, DamageAnywhereIsSurvived) {
  write_bag(scratch("sound.bag"), some_log(4));
  const std::string sound = read_text(scratch("sound.bag"));
  for (std::uint64_t i = 0; i < 200; ++i) {
    std::string bytes = sound;
    bytes[random_bits(3, Draw::test, i) % bytes.size()] ^= static_cast<char>(1 + random_bits(4, Draw::test, i) % 255);
    write_text(scratch("damaged.bag"), bytes);
    try {
      read_bag(scratch("damaged.bag"));
    } catch (const Error&) {
    }
  }
}

bool ros_is_here() {
  return std::system(
             "/usr/bin/python3 -c 'import rosbag, sensor_msgs.msg, nav_msgs.msg, tf2_msgs.msg' >/dev/null 2>&1") == 0;
}

int python(const std::string& program) {
  write_text(scratch("ask.py"), program);
  return std::system(("/usr/bin/python3 " + scratch("ask.py") + " >" + scratch("ask.txt") + " 2>&1").c_str());
}

TEST(Bag, RossOwnToolsReadTheSameRangesAndKnowTheTypes) {
  if (!ros_is_here()) GTEST_SKIP() << "needs python3-rosbag and the messages: ci/setup --peers";
  const Log log = some_log(20);
  const Truth truth = truth_of(log);
  write_bag(scratch("ros.bag"), log, &truth);
  std::string program =
      "import rosbag, math, genpy.dynamic\n"
      "bag = rosbag.Bag('" +
      scratch("ros.bag") +
      "')\n"
      "info = bag.get_type_and_topic_info()\n"
      "assert info.topics['/front/scan'].message_count == 20, info\n"
      "for c in bag._get_connections():\n"
      "    made = genpy.dynamic.generate_dynamic(c.datatype, c.msg_def)[c.datatype]\n"
      "    assert made._md5sum == c.md5sum, (c.datatype, made._md5sum, c.md5sum)\n"
      "sum = 0.0; n = 0; bad = 0\n"
      "for topic, m, t in bag.read_messages(topics=['/front/scan']):\n"
      "    assert m.header.frame_id == 'front' and m.header.stamp == t\n"
      "    for r in m.ranges:\n"
      "        if math.isfinite(r): sum += r; n += 1\n"
      "        else: bad += 1\n"
      "tf = [m for _, m, _ in bag.read_messages(topics=['/tf_static'])][0]\n"
      "assert {x.child_frame_id for x in tf.transforms} == {'front', 'up'}\n"
      "odom = [m for _, m, _ in bag.read_messages(topics=['/truth/odom'])]\n"
      "assert abs(odom[-1].pose.pose.position.x - 3.99) < 1e-9, odom[-1]\n"
      "print('%d %d %.6f' % (n, bad, sum))\n";
  ASSERT_EQ(python(program), 0) << read_text(scratch("ask.txt"));
  double sum = 0;
  int n = 0, bad = 0;
  for (const float r : log.scans[0].range_m) std::isfinite(r) ? (sum += static_cast<double>(r), ++n) : ++bad;
  char expected[80];
  std::snprintf(expected, sizeof expected, "%d %d %.6f\n", n, bad, sum);
  EXPECT_EQ(read_text(scratch("ask.txt")), expected);
}

TEST(Bag, WhatRosPacksWithBz2AndLz4IsReadTheSame) {
  if (!ros_is_here()) GTEST_SKIP() << "needs python3-rosbag and the messages: ci/setup --peers";
  const Log log = some_log(20);
  write_bag(scratch("plain.bag"), log);
  for (const std::string packing : {"bz2", "lz4"}) {
    const std::string packed = scratch(packing + ".bag");
    ASSERT_EQ(python("import rosbag, sys\n"
                     "try: out = rosbag.Bag('" +
                     packed + "', 'w', compression='" + packing +
                     "')\n"
                     "except Exception as e: print(e); sys.exit(9)\n"
                     "for topic, m, t in rosbag.Bag('" +
                     scratch("plain.bag") +
                     "').read_messages(): out.write(topic, m, t)\n"
                     "out.close()\n"),
              0)
        << packing << ": " << read_text(scratch("ask.txt"));
    EXPECT_LT(std::filesystem::file_size(packed), std::filesystem::file_size(scratch("plain.bag")));
    expect_same_scans(read_bag(packed).log, log, 20);
  }
}

}  // namespace
}  // namespace adit
