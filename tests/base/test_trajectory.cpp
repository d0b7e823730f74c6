// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/trajectory.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>

#include <filesystem>

namespace adit {
namespace {

const std::string folder = scratch("trajectory");

Trajectory two_poses() {
  return {{0, 2}, {pose_of({0, 0, 0}, 0), pose_of({4, 0, 2}, 1)}};
}

TEST(Trajectory, AtGivesThePoseBetweenAndTheEndsOutside) {
  const Trajectory t = two_poses();
  EXPECT_TRUE(t.at(0.5).isApprox(pose_of({1, 0, 0.5}, 0.25), 1e-12));
  EXPECT_TRUE(t.at(-1).isApprox(t.X_WB.front()));
  EXPECT_TRUE(t.at(9).isApprox(t.X_WB.back()));
  EXPECT_NEAR(t.length_m(), std::sqrt(20.0), 1e-12);
}

TEST(Trajectory, TumComesBack) {
  write_tum(folder + "/a.tum", two_poses());
  const Trajectory back = read_tum(folder + "/a.tum");
  ASSERT_EQ(back.size(), 2u);
  EXPECT_TRUE(back.X_WB[1].isApprox(two_poses().X_WB[1], 1e-9));  // nine digits are written
}

TEST(Trajectory, ABadLineIsNamed) {
  const auto error_of = [](const std::string& text) -> std::string {
    write_text(folder + "/b.tum", text);
    try {
      read_tum(folder + "/b.tum");
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  EXPECT_THAT(error_of("# head\n0 0 0 0 0 0 0 1\n1 0 0 nan 0 0 0 1\n"),
              ::testing::HasSubstr("b.tum:3: not a finite number"));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"), ::testing::HasSubstr("b.tum:2: the stamp does not grow"));
  EXPECT_THAT(error_of("1 2 3\n"), ::testing::HasSubstr("b.tum:1: expected"));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 2\n"), ::testing::HasSubstr("quaternion"));
  EXPECT_THAT(error_of(""), ::testing::HasSubstr("no pose"));
}

TEST(Files, AFailedWriteLeavesTheEarlierFileAndNoOther) {
  const std::string file = folder + "/kept/x.txt";
  write_text(file, "old");
  EXPECT_THROW(write_whole(file,
                           [](const std::string& temporary) {
                             write_text(temporary, "half");
                             throw Error("no more room", Fault::file);
                           }),
               Error);
  EXPECT_EQ(read_text(file), "old");
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder + "/kept")) ++files;
  EXPECT_EQ(files, 1);
  EXPECT_THROW(read_text(folder + "/absent"), Error);
}

}  // namespace
}  // namespace adit
