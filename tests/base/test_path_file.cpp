// SPDX-License-Identifier: BSD-3-Clause
#include "base/cloud.h"
#include "base/files.h"
#include "base/grid.h"
#include "base/path_file.h"
#include "tests/support/errors.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>

#include <functional>

namespace adit {
namespace {

using ::testing::HasSubstr;

const std::string folder = scratch("path_file");

Trajectory bent() {
  return {{0.5, 1.5, 2}, {pose_of({1, 2, 3}, 0.1), pose_of({4, 5, 6}, 2, 0.3, -0.2), pose_of({7, 8, 9}, -3)}};
}

TEST(PathFile, KittiPosesComeBackWithTheStampsThatTheyAreGiven) {
  write_kitti_path(folder + "/p.txt", bent());
  write_text(folder + "/times.txt", "0.5\n1.5 # the second\n\n2\n");
  EXPECT_TRUE(is_kitti(folder + "/p.txt"));
  const Trajectory back = read_path(folder + "/p.txt", read_stamps(folder + "/times.txt"));
  ASSERT_EQ(back.size(), 3u);
  EXPECT_EQ(back.stamp_s, bent().stamp_s);
  for (size_t i = 0; i < 3; ++i) EXPECT_TRUE(back.X_WB[i].isApprox(bent().X_WB[i], 1e-12));
}

TEST(PathFile, TumIsToldByItsColumns) {
  write_tum(folder + "/p.tum", bent());
  EXPECT_FALSE(is_kitti(folder + "/p.tum"));
  EXPECT_EQ(read_path(folder + "/p.tum").size(), 3u);
  EXPECT_THAT(error_of([] { read_path(folder + "/p.tum", {1, 2, 3}); }), HasSubstr("stamps of their own"));
}

TEST(PathFile, ABadKittiFileIsNamedWithItsLine) {
  const std::string row = "1 0 0 0 0 1 0 0 0 0 1 0\n", file = folder + "/bad.txt";
  const auto said = [&](const std::string& text, const std::vector<double>& stamps) {
    write_text(file, text);
    return error_of([&] { read_path(file, stamps); });
  };
  EXPECT_THAT(said(row, {}), HasSubstr("have no stamps"));
  EXPECT_THAT(said(row + row, {1}), HasSubstr("has 2 poses, but there are 1 stamps"));
  EXPECT_THAT(said(row + "1 2 3\n", {1, 2}), HasSubstr("bad.txt:2: expected twelve"));
  EXPECT_THAT(said(row + "1 0 0 nan 0 1 0 0 0 0 1 0\n", {1, 2}), HasSubstr("bad.txt:2: not a finite number"));
  EXPECT_THAT(said("2 0 0 0 0 1 0 0 0 0 1 0\n", {1}), HasSubstr("no rotation"));
  write_text(folder + "/times.txt", "1\n1\n");
  EXPECT_THAT(error_of([] { read_stamps(folder + "/times.txt"); }), HasSubstr("times.txt:2: the stamp does not grow"));
}

TEST(PathFile, CovariancesComeBackAndMustBeThePaths) {
  std::vector<Eigen::MatrixXd> C;
  for (int i = 0; i < 3; ++i)
    C.push_back(Eigen::MatrixXd::Identity(6, 6) * (1 + i) + Eigen::MatrixXd::Constant(6, 6, 0.1));
  write_covariances(folder + "/c.txt", bent(), C);
  const auto back = read_covariances(folder + "/c.txt", bent());
  ASSERT_EQ(back.size(), 3u);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(back[i], C[i]);
  Trajectory longer = bent();
  longer.stamp_s.push_back(3);
  longer.X_WB.push_back(Pose::Identity());
  EXPECT_THAT(error_of([&] { read_covariances(folder + "/c.txt", longer); }),
              HasSubstr("has 3 covariances, the path 4"));
  longer.stamp_s[1] += 0.1;
  EXPECT_THAT(error_of([&] { read_covariances(folder + "/c.txt", longer); }), HasSubstr("c.txt:2: the stamp"));
}

TEST(Clouds, AnEmptyOneIsRefused) {
  write_text(
      folder + "/e.ply",
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n");
  EXPECT_THAT(error_of([] { read_cloud(folder + "/e.ply"); }), HasSubstr("no point in it"));
  write_pcd(folder + "/e.pcd", {});
  EXPECT_THAT(error_of([] { read_cloud(folder + "/e.pcd"); }), HasSubstr("no point in it"));
  write_pcd(folder + "/one.pcd", {{Vec3(1, 2, 3)}, {}, {}});
  EXPECT_EQ(read_cloud(folder + "/one.pcd").p.at(0), Vec3(1, 2, 3));
}

TEST(Grids, APictureWithoutItsYamlIsRefusedAndAPictureInWordsIsRead) {
  write_text(folder + "/g.pgm", "P2\n# words\n3 2\n255\n0 205 255\n255 255 0\n");
  EXPECT_THAT(error_of([] { read_grid(folder + "/g.pgm"); }), HasSubstr("name the yaml"));
  write_text(folder + "/g.yaml", "image: g.pgm\nresolution: 0.05\norigin:\n- -1.5\n- 2.0\n- 0\nnegate: 0\n");
  const Grid g = read_grid(folder + "/g.yaml");
  EXPECT_EQ(g.origin, Vec2(-1.5, 2));
  EXPECT_EQ(g.cell(0, 1), Grid::occupied);  // the top row is the farther one
  EXPECT_EQ(g.cell(1, 1), Grid::unknown);
  EXPECT_EQ(g.cell(0, 0), Grid::free);
}

}  // namespace
}  // namespace adit
