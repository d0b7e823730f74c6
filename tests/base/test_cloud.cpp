// SPDX-License-Identifier: BSD-3-Clause
#include "base/cloud.h"
#include "base/error.h"
#include "base/files.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <sstream>

namespace adit {
namespace {

using ::testing::HasSubstr;

// A laser of three beams that drives along x at 1 m/s beside a wall at y = 2.
struct Driven {
  Log log;
  Truth truth;
};
Driven driven() {
  Driven d;
  LaserModel laser{.name = "three", .fov_rad = M_PI, .beams = 3, .turn_s = 0.1, .interval_s = 0.5};
  laser.range_max_m = 30;
  d.log.rig = {.name = "one", .mounts = {{.name = "front", .laser = laser, .X_BS = pose_of({0, 0, 1}, 0)}}};
  Scans scans;
  scans.beams = 3;
  ScanTruth truth;
  for (int n = 0; n < 4; ++n) {
    scans.stamp_s.push_back(0.5 * n + 0.001);  // the log's clock errs
    truth.stamp_s.push_back(0.5 * n);
    scans.range_m.insert(scans.range_m.end(), {std::numeric_limits<float>::infinity(), 5, 2});
    truth.label.insert(truth.label.end(), {0, 4, 3});
    truth.part.insert(truth.part.end(), {-1, 7, 9});
  }
  d.log.scans = {scans};
  d.truth.rig = d.log.rig;
  d.truth.scans = {truth};
  for (int i = 0; i < 40; ++i) {
    d.truth.drive.path.stamp_s.push_back(0.1 * i);
    d.truth.drive.path.X_WB.push_back(pose_of({0.1 * i, 0, 0}, 0));
  }
  return d;
}

PointCloud few() {
  PointCloud c;
  for (int i = 0; i < 5; ++i) {
    c.p.emplace_back(0.5 * i, -i, 0.25);
    c.stamp_s.push_back(10 + 1e-7 * i);
    c.laser.push_back(static_cast<std::uint8_t>(i % 3));
  }
  return c;
}

TEST(Cloud, EachBeamIsLaidFromWhereItsLaserTrulyWas) {
  const Driven d = driven();
  const LabelledCloud cloud = true_cloud(d.log, d.truth);
  ASSERT_EQ(cloud.points.size(), 8u);
  for (size_t n = 0; n < 4; ++n) {
    const double ahead_s = 0.5 * n + 0.025, left_s = 0.5 * n + 0.05;  // a quarter and half of a turn
    EXPECT_LT((cloud.points.p[2 * n] - Vec3(ahead_s + 5, 0, 1)).norm(), 1e-9);
    EXPECT_LT((cloud.points.p[2 * n + 1] - Vec3(left_s, 2, 1)).norm(), 1e-9);
    EXPECT_EQ(cloud.label[2 * n + 1], 3);
    EXPECT_EQ(cloud.part[2 * n], 7);
  }
  EXPECT_EQ(true_cloud(d.log, d.truth, 2).points.size(), 4u);
}

TEST(Cloud, PcdComesBackBitForBitButForFloats) {
  PointCloud c = few();
  c.sigma_m.assign(c.size(), 0.25F);
  write_pcd(scratch("a.pcd"), c);
  const PointCloud back = read_pcd(scratch("a.pcd"));
  ASSERT_EQ(back.size(), c.size());
  for (size_t i = 0; i < c.size(); ++i) EXPECT_EQ(back.p[i], c.p[i]);  // halves and quarters are floats
  EXPECT_EQ(back.stamp_s, c.stamp_s);
  EXPECT_EQ(back.laser, c.laser);
  EXPECT_EQ(back.sigma_m, c.sigma_m);
}

TEST(Cloud, AsciiPcdWithForeignFieldsIsRead) {
  write_text(
      scratch("b.pcd"),
      "# .PCD v.7\nVERSION .7\nFIELDS rgb x y z n\nSIZE 4 4 4 4 4\nTYPE U F F F F\nCOUNT 1 1 1 1 3\nWIDTH 2\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ascii\n7 1 2 3 0 0 1\n8 4 5 6.5 0 0 1\n");
  const PointCloud c = read_pcd(scratch("b.pcd"));
  ASSERT_EQ(c.size(), 2u);
  EXPECT_EQ(c.p[1], Vec3(4, 5, 6.5));
  EXPECT_TRUE(c.stamp_s.empty());
}

TEST(Cloud, BadPcdIsNamedByItsCause) {
  const auto error_of = [](const std::string& text) -> std::string {
    write_text(scratch("bad.pcd"), text);
    try {
      read_pcd(scratch("bad.pcd"));
    } catch (const Error& e) {
      return e.what();
    }
    return "no error";
  };
  write_pcd(scratch("whole.pcd"), few());
  const std::string whole = read_text(scratch("whole.pcd"));
  EXPECT_THAT(error_of(whole.substr(0, whole.size() - 3)), HasSubstr("bad.pcd: is cut short"));
  EXPECT_THAT(error_of("ply\n"), HasSubstr("no DATA line"));
  EXPECT_THAT(error_of("FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nPOINTS 1\nDATA ascii\n1 2\n"),
              HasSubstr("needs a field z"));
  EXPECT_THAT(error_of("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nPOINTS 1\nDATA binary_compressed\n"),
              HasSubstr("binary_compressed is not read"));
}

template <class T>
std::vector<T> values_in(const std::string& file) {
  const std::string bytes = read_text(file);
  std::vector<T> values(bytes.size() / sizeof(T));
  std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
  return values;
}

TEST(Cloud, AKittiFolderHoldsPointsLabelsAndPosesThatGiveTheCloudAgain) {
  const Driven d = driven();
  const std::string dir = scratch("kitti");
  EXPECT_EQ(write_kitti(dir, d.log, d.truth), 4u);
  const LabelledCloud cloud = true_cloud(d.log, d.truth);
  std::istringstream poses(read_text(dir + "/poses.txt")), times(read_text(dir + "/times.txt"));
  for (size_t n = 0; n < 4; ++n) {
    Pose X = Pose::Identity();
    for (int k = 0; k < 12; ++k) poses >> X.matrix()(k / 4, k % 4);
    double t = -1;
    times >> t;
    EXPECT_NEAR(t, 0.5 * n, 1e-6);
    const auto points = values_in<float>(dir + "/velodyne/00000" + std::to_string(n) + ".bin");
    const auto labels = values_in<std::uint32_t>(dir + "/labels/00000" + std::to_string(n) + ".label");
    ASSERT_EQ(points.size(), 8u);
    ASSERT_EQ(labels.size(), 2u);
    for (size_t i = 0; i < 2; ++i) {
      const Vec3 p = X * Vec3(points[4 * i], points[4 * i + 1], points[4 * i + 2]);
      EXPECT_LT((p - cloud.points.p[2 * n + i]).norm(), 1e-6);
      EXPECT_EQ(labels[i] & 0xffff, cloud.label[2 * n + i]);
      EXPECT_EQ(static_cast<int>(labels[i] >> 16) - 1, cloud.part[2 * n + i]);
    }
  }
}

TEST(Cloud, ALogAndAForeignTruthAreRefused) {
  Driven d = driven();
  d.truth.scans[0].stamp_s.pop_back();
  EXPECT_THROW(true_cloud(d.log, d.truth), Error);
}

}  // namespace
}  // namespace adit
