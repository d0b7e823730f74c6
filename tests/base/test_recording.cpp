// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/h5.h"
#include "base/recording.h"
#include "base/rng.h"
#include "tests/support/errors.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <limits>

namespace adit {
namespace {

using ::testing::HasSubstr;

constexpr float none = std::numeric_limits<float>::infinity();
constexpr float unread = std::numeric_limits<float>::quiet_NaN();

Rig two_lasers() {
  Rig rig{.name = "pair", .mounts = {}};
  for (int i = 0; i < 2; ++i) {
    Mount mount;
    mount.name = i == 0 ? "up" : "front";  // not in the order of the alphabet
    mount.laser = {.name = "a laser", .fov_rad = 3, .beams = 7 + i, .turn_s = 0.01, .interlace = 2, .interval_s = 0.2};
    mount.laser.range_max_m = 30;
    mount.laser.resolution_m = i == 0 ? 0.001 : 0;
    mount.laser.sigma_m = 0.005;
    mount.X_BS = pose_of({0.1, -0.2, 0.3}, 0.4, 0.5, 0.6);
    mount.phase_s = 0.01 * i;
    rig.mounts.push_back(mount);
  }
  return rig;
}

Log small_log(int scans) {
  Log log{two_lasers(), {}};
  for (const Mount& mount : log.rig.mounts) {
    Scans s;
    s.beams = mount.laser.beams;
    for (int i = 0; i < scans; ++i) {
      s.stamp_s.push_back(mount.phase_s + 0.2 * i);
      for (int k = 0; k < s.beams; ++k) {
        const double u = uniform(5, Draw::test, i, k);
        const double step = mount.laser.resolution_m > 0 ? 1e-3 : 1e-6;
        s.range_m.push_back(u < 0.1 ? none : u < 0.2 ? unread : static_cast<float>(std::round(u * 30 / step) * step));
      }
    }
    log.scans.push_back(s);
  }
  return log;
}

Truth small_truth() {
  Truth truth;
  truth.world = "0123abcd";
  truth.rig = two_lasers();
  truth.drive.end = DriveEnd::stuck;
  truth.drive.cause = "a wheel hangs at (3.0, 4.0)";
  truth.drive.driven_m = 17.25;
  truth.drive.route = {.line = {{0, 0}, {1, 0.5}}, .passages = {3, 1, 3}, .length_m = 20, .backwards = {{0, 1}}};
  truth.drive.ground = {0, 2, 1, 0};
  for (int i = 0; i < 50; ++i) {
    truth.drive.path.stamp_s.push_back(i / 120.0);
    truth.drive.path.X_WB.push_back(pose_of({0.01 * i, 1, 2}, 0.02 * i, 0.1, -0.1));
  }
  for (const Mount& mount : truth.rig.mounts) {
    ScanTruth s;
    s.stamp_s = {0.1, 0.3, 0.5, 0.8};
    for (int i = 0; i < 4 * mount.laser.beams; ++i) {
      s.range_m.push_back(i == 3 ? none : 0.37f * i);
      s.label.push_back(static_cast<std::uint8_t>(i % 7));
      s.part.push_back(i - 2);
      s.incidence_rad.push_back(0.01f * i);
      s.face.push_back(1000 * i - 1);
    }
    if (truth.scans.empty()) {  // the other laser's file lacks them
      s.surfaces.assign(s.range_m.size(), 2);
      s.fault.assign(s.range_m.size(), trouble::dust);
    }
    truth.scans.push_back(s);
  }
  return truth;
}

void expect_same(const Rig& a, const Rig& b) {
  EXPECT_EQ(a.name, b.name);
  ASSERT_EQ(a.mounts.size(), b.mounts.size());
  for (size_t i = 0; i < a.mounts.size(); ++i) {
    const Mount &m = a.mounts[i], &n = b.mounts[i];
    EXPECT_EQ(m.name, n.name);
    EXPECT_EQ(m.X_BS.matrix(), n.X_BS.matrix());
    EXPECT_EQ(m.phase_s, n.phase_s);
    EXPECT_EQ(m.laser.name, n.laser.name);
    EXPECT_EQ(m.laser.beams, n.laser.beams);
    EXPECT_EQ(m.laser.interlace, n.laser.interlace);
    EXPECT_EQ(m.laser.fov_rad, n.laser.fov_rad);
    EXPECT_EQ(m.laser.turn_s, n.laser.turn_s);
    EXPECT_EQ(m.laser.interval_s, n.laser.interval_s);
    EXPECT_EQ(m.laser.sigma_m, n.laser.sigma_m);
  }
}

TEST(Recording, ALogComesBackAsItWas) {
  const Log log = small_log(23);
  save_log(scratch("log.h5"), log);
  const Log back = load_log(scratch("log.h5"));
  expect_same(log.rig, back.rig);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(log.scans[i].beams, back.scans[i].beams);
    EXPECT_EQ(log.scans[i].stamp_s, back.scans[i].stamp_s);
    ASSERT_EQ(log.scans[i].range_m.size(), back.scans[i].range_m.size());
    for (size_t k = 0; k < log.scans[i].range_m.size(); ++k) {
      const float a = log.scans[i].range_m[k], b = back.scans[i].range_m[k];
      EXPECT_TRUE(a == b || (std::isnan(a) && std::isnan(b))) << a << " came back as " << b;
    }
  }
}

TEST(Recording, CodesComeBackAndOldFilesHaveNone) {
  Log log = small_log(3);
  constexpr Code codes[] = {Code::range,  Code::no_echo, Code::unreadable, Code::weak,
                            Code::beyond, Code::dazzled, Code::overflow,   Code::channel};
  Scans& s = log.scans[0];
  s.code.assign(s.range_m.size(), Code::range);
  s.range_m.assign(s.range_m.size(), 2);
  for (size_t i = 1; i < 8; ++i) {
    s.code[i] = codes[i];
    s.range_m[i] = i == 1 || i == 3 || i == 4 ? none : unread;  // nothing heard, or not readable
  }
  save_log(scratch("codes.h5"), log);
  const Scans back = load_log(scratch("codes.h5")).scans[0];
  EXPECT_EQ(back.code, s.code);
  for (size_t i = 0; i < s.range_m.size(); ++i)
    EXPECT_TRUE(back.range_m[i] == s.range_m[i] || (std::isnan(back.range_m[i]) && std::isnan(s.range_m[i]))) << i;
}

TEST(Recording, ALogOfNoScansComesBack) {
  save_log(scratch("none.h5"), small_log(0));
  EXPECT_EQ(load_log(scratch("none.h5")).scans[1].size(), 0u);
}

TEST(Recording, ATruthComesBackAsItWas) {
  const Truth truth = small_truth();
  save_truth(scratch("truth.h5"), truth);
  const Truth back = load_truth(scratch("truth.h5"));
  expect_same(truth.rig, back.rig);
  EXPECT_EQ(truth.world, back.world);
  EXPECT_EQ(truth.drive.end, back.drive.end);
  EXPECT_EQ(truth.drive.cause, back.drive.cause);
  EXPECT_EQ(truth.drive.driven_m, back.drive.driven_m);
  EXPECT_EQ(truth.drive.route.line, back.drive.route.line);
  EXPECT_EQ(truth.drive.route.passages, back.drive.route.passages);
  EXPECT_EQ(truth.drive.route.length_m, back.drive.route.length_m);
  ASSERT_EQ(back.drive.route.backwards.size(), 1u);
  EXPECT_EQ(back.drive.route.backwards[0].first, 0);
  EXPECT_EQ(back.drive.route.backwards[0].last, 1);
  EXPECT_EQ(truth.drive.ground, back.drive.ground);
  EXPECT_EQ(truth.drive.path.stamp_s, back.drive.path.stamp_s);
  for (size_t i = 0; i < truth.drive.path.size(); ++i)
    EXPECT_EQ(truth.drive.path.X_WB[i].matrix(), back.drive.path.X_WB[i].matrix());
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(truth.scans[i].stamp_s, back.scans[i].stamp_s);
    EXPECT_EQ(truth.scans[i].range_m, back.scans[i].range_m);
    EXPECT_EQ(truth.scans[i].label, back.scans[i].label);
    EXPECT_EQ(truth.scans[i].part, back.scans[i].part);
    EXPECT_EQ(truth.scans[i].incidence_rad, back.scans[i].incidence_rad);
    EXPECT_EQ(truth.scans[i].face, back.scans[i].face);
    EXPECT_EQ(truth.scans[i].surfaces, back.scans[i].surfaces);
    EXPECT_EQ(truth.scans[i].fault, back.scans[i].fault);
  }
}

TEST(Recording, TheSameRecordingGivesTheSameBytes) {
  const Log log = small_log(20000);  // several chunks, the last one not full
  save_log(scratch("a.h5"), log);
  save_log(scratch("b.h5"), log);
  EXPECT_TRUE(read_text(scratch("a.h5")) == read_text(scratch("b.h5")));
  save_truth(scratch("ta.h5"), small_truth());
  save_truth(scratch("tb.h5"), small_truth());
  EXPECT_TRUE(read_text(scratch("ta.h5")) == read_text(scratch("tb.h5")));
}

TEST(Recording, AFileCutAnywhereIsAnErrorThatNamesIt) {
  const std::string whole = scratch("whole.h5"), cut = scratch("cut.h5");
  save_log(whole, small_log(300));
  const std::string bytes = read_text(whole);
  for (double share : {0.0, 0.001, 0.01, 0.1, 0.5, 0.9, 0.9999}) {
    write_text(cut, bytes.substr(0, static_cast<size_t>(share * bytes.size())));
    EXPECT_THAT(error_of([&] { load_log(cut); }), HasSubstr("cut.h5: ")) << share;
  }
}

TEST(Recording, ADamagedScanIsAnErrorAndNeverAWrongRange) {
  const std::string file = scratch("damaged.h5");
  save_log(file, small_log(3000));
  const std::string bytes = read_text(file);
  int told = 0;
  for (int i = 1; i < 20; ++i) {
    std::string bad = bytes;
    bad[bytes.size() * i / 20] ^= 0x10;
    write_text(file, bad);
    told += error_of([&] { load_log(file); }) != "no error";
  }
  EXPECT_GE(told, 17);  // a flipped bit may fall on padding, which nobody reads
}

TEST(Recording, AFileOfAnotherKindIsNamedForWhatItIs) {
  const std::string text = scratch("text.h5"), truth = scratch("t.h5"), foreign = scratch("foreign.h5");
  write_text(text, "FLASER 180 0.5 0.6\n");
  save_truth(truth, small_truth());
  H5Writer other(foreign, foreign);
  other.close();
  EXPECT_THAT(error_of([&] { load_log(text); }), HasSubstr("text.h5: is not an HDF5 file"));
  EXPECT_THAT(error_of([&] { load_log(truth); }), HasSubstr("t.h5: is an adit truth, an adit log is needed"));
  EXPECT_THAT(error_of([&] { load_log(foreign); }), HasSubstr("foreign.h5: is an HDF5 file, but not an adit log"));
  EXPECT_THAT(error_of([&] { load_log(scratch("absent.h5")); }), HasSubstr("absent.h5: no such file"));
  EXPECT_THAT(error_of([&] { load_log(scratch("")); }), HasSubstr("is a folder"));
}

TEST(Recording, AFileThatCannotBeWrittenIsAnErrorAndLeavesNothing) {
  const std::string blocked = scratch("blocked");
  write_text(blocked, "a file where a folder is needed");
  EXPECT_THROW(save_log(blocked + "/log.h5", small_log(1)), Error);
  Log log = small_log(1);
  log.rig.mounts[0].name = "a/b";
  EXPECT_THAT(error_of([&] { save_log(scratch("name.h5"), log); }), HasSubstr("a/b"));
  EXPECT_FALSE(std::filesystem::exists(scratch("name.h5")));
}

}  // namespace
}  // namespace adit
