// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/parts.h"
#include "base/rng.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct Pair {
  Log log;
  Truth truth;
};

Rig rig_named(const std::string& name) {
  Rig rig{.name = name, .mounts = {}};
  for (const char* laser : {"up", "front"}) {
    Mount mount{.name = laser, .laser = load_laser("lms200", 0)};
    mount.tilt = {-0.3, 0.4, 10, true};
    rig.mounts.push_back(mount);
  }
  return rig;
}

// What the lasers of a rig tell from scan `begin` to scan `end`; arrays larger than a chunk of the file.
Pair piece(const Rig& rig, int begin, int end) {
  Pair p{{rig, {}}, {.world = "0123", .drive = {}, .rig = rig, .scans = {}}};
  for (int i = 12 * begin; i < 12 * end; ++i) {
    p.truth.drive.path.stamp_s.push_back(i / 120.0);
    p.truth.drive.path.X_WB.push_back(pose_of({0.01 * i, 1, 2}, 0.001 * i));
  }
  for (size_t laser = 0; laser < rig.mounts.size(); ++laser) {
    Scans s;
    ScanTruth t;
    s.beams = 361;
    for (int i = begin; i < end; ++i) {
      s.stamp_s.push_back(0.1 * i);
      t.stamp_s.push_back(0.1 * i + 1e-4);
      s.tilt_rad.push_back(0.01 * (i % 30));
      t.tilt_rad.push_back(0.01 * (i % 30));
      for (int k = 0; k < 361; ++k) {
        const double u =
            uniform(9, Draw::test, static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(k) + 1000 * laser);
        s.range_m.push_back(static_cast<float>(std::round(u * 8000) * 1e-3));
        s.code.push_back(Code::range);
        t.range_m.push_back(static_cast<float>(u * 8));
        t.label.push_back(static_cast<std::uint8_t>(k % 5));
        t.part.push_back(k);
        t.incidence_rad.push_back(static_cast<float>(u));
        t.face.push_back(i * k);
        t.passage.push_back(k % 3);
        t.surfaces.push_back(1);
        t.fault.push_back(0);
      }
    }
    p.log.scans.push_back(s);
    p.truth.scans.push_back(t);
  }
  return p;
}

std::string fresh(const std::string& name) {
  const std::string dir = scratch("parts_") + name;
  fs::remove_all(dir);
  return dir;
}

// Parts of 150, 0 and 250 scans.
void save_three(const std::string& dir) {
  const Rig rig = rig_named("pair");
  size_t n = 0;
  for (const auto& [from, to] : {std::pair{0, 150}, {150, 150}, {150, 400}}) {
    const Pair p = piece(rig, from, to);
    save_part(dir, n++, p.log, p.truth);
  }
}

TEST(Parts, JoinedTheyAreByteForByteTheWholeSavedAtOnce) {
  const std::string dir = fresh("join");
  save_three(dir);
  const Parts parts = find_parts(dir);
  EXPECT_THAT(parts.notes, IsEmpty());
  join_logs(dir + "/joined.h5", parts.logs);
  join_truths(dir + "/joined_truth.h5", parts.truths);
  const Pair whole = piece(rig_named("pair"), 0, 400);
  save_log(dir + "/whole.h5", whole.log);
  save_truth(dir + "/whole_truth.h5", whole.truth);
  EXPECT_TRUE(read_text(dir + "/joined.h5") == read_text(dir + "/whole.h5"));
  EXPECT_TRUE(read_text(dir + "/joined_truth.h5") == read_text(dir + "/whole_truth.h5"));
  const Log back = load_log(dir + "/joined.h5");
  EXPECT_EQ(back.scans[1].range_m, whole.log.scans[1].range_m);
  EXPECT_EQ(back.scans[1].tilt_rad, whole.log.scans[1].tilt_rad);
  EXPECT_EQ(back.rig.mounts[0].tilt.to_rad, 0.4);
  EXPECT_EQ(load_truth(dir + "/joined_truth.h5").scans[0].passage, whole.truth.scans[0].passage);
}

TEST(Parts, ADamagedOrForeignPartIsLeftOutAndNamed) {
  const std::string dir = fresh("damage");
  save_three(dir);
  const Pair other = piece(rig_named("another"), 400, 410);
  save_part(dir, 4, other.log, other.truth);
  std::string bytes = read_text(part_log(dir, 2));
  bytes[bytes.size() * 3 / 10] = static_cast<char>(bytes[bytes.size() * 3 / 10] ^ 1);  // in the ranges of one laser
  write_text(part_log(dir, 2), bytes);
  const Parts parts = find_parts(dir);
  EXPECT_EQ(parts.logs.size(), 2u);
  EXPECT_EQ(parts.truths.size(), 2u);
  ASSERT_EQ(parts.notes.size(), 3u);
  EXPECT_THAT(parts.notes[0], HasSubstr("log-0002.h5"));
  EXPECT_THAT(parts.notes[1], HasSubstr("part 3 is missing"));
  EXPECT_THAT(parts.notes[2], HasSubstr("another"));
}

TEST(Parts, AFolderWithoutAPartThatCanBeReadIsAnError) {
  const std::string dir = fresh("none");
  fs::create_directories(dir);
  EXPECT_FALSE(is_parts(dir));
  EXPECT_THROW(find_parts(dir), Error);
  write_text(part_log(dir, 0), "no HDF5");
  EXPECT_TRUE(is_parts(dir));
  EXPECT_THROW(find_parts(dir), Error);
}

TEST(Parts, RemovingThemLeavesWhatElseIsInTheFolder) {
  const std::string dir = fresh("remove");
  save_three(dir);
  write_text(dir + "/notes.txt", "mine");
  remove_parts(dir);
  EXPECT_FALSE(is_parts(dir));
  EXPECT_TRUE(fs::exists(dir + "/notes.txt"));
  fs::remove(dir + "/notes.txt");
  save_three(dir);
  remove_parts(dir);
  EXPECT_FALSE(fs::exists(dir));
}

}  // namespace
}  // namespace adit
