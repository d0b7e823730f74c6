// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "eval/relations.h"
#include "tests/support/scratch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;

std::string file_with(const std::string& name, const std::string& text) {
  const std::string file = scratch("relations_") + name;
  write_text(file, text);
  return file;
}

Pose planar(double x_m, double y_m, double yaw_rad) {
  Pose X = Pose::Identity();
  X.translation() = Vec3(x_m, y_m, 0);
  X.linear() = Eigen::AngleAxisd(yaw_rad, Vec3::UnitZ()).toRotationMatrix();
  return X;
}

double value(const Score& score, const std::string& name) {
  const Metric* m = score.find("relations." + name);
  EXPECT_NE(m, nullptr) << name;
  return m ? m->value : NAN;
}

TEST(Relations, APathThatKeepsThemScoresNothing) {
  const Trajectory path{{0, 1, 2}, {planar(5, 7, 1), planar(6, 9, 2), planar(4, 4, -3)}};
  const std::vector<Relation> relations{{0, 1, path.X_WB[0].inverse() * path.X_WB[1]},
                                        {0, 2, path.X_WB[0].inverse() * path.X_WB[2]}};
  const Score score = score_relations(relations, path, 0.01);
  EXPECT_NEAR(value(score, "translation_m"), 0, 1e-12);
  EXPECT_NEAR(value(score, "rotation_deg"), 0, 1e-5);  // acos near 1: the root of 1e-16
  EXPECT_EQ(value(score, "matched_share"), 1);
}

TEST(Relations, ATurnBeforeTheWayCostsPositionAndOneAfterItDoesNot) {
  const std::vector<Relation> ahead{{0, 1, planar(1, 0, 0)}};
  const Score before = score_relations(ahead, {{0, 1}, {planar(0, 0, 0), planar(0, 1, pi / 2)}}, 0.01);
  EXPECT_NEAR(value(before, "translation_m"), std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(value(before, "rotation_deg"), 90, 1e-9);
  const Score after = score_relations(ahead, {{0, 1}, {planar(0, 0, 0), planar(1, 0, pi / 2)}}, 0.01);
  EXPECT_NEAR(value(after, "translation_m"), 0, 1e-12);
  EXPECT_NEAR(value(after, "rotation_deg"), 90, 1e-9);
}

TEST(Relations, MeanAndDeviationAreThoseOfTheSample) {
  const Trajectory path{{0, 1, 2}, {planar(0, 0, 0), planar(1, 0, 0), planar(2, 0, 0)}};
  const std::vector<Relation> relations{{0, 1, planar(0.9, 0, 0)}, {1, 2, planar(0.7, 0, 0)}};
  const Score score = score_relations(relations, path, 0.01);  // off by 0.1 and 0.3 m
  EXPECT_NEAR(value(score, "translation_m"), 0.2, 1e-12);
  EXPECT_NEAR(value(score, "translation_sd_m"), std::sqrt(0.02), 1e-12);
  EXPECT_NEAR(value(score, "translation_sq_m2"), 0.05, 1e-12);
  EXPECT_NEAR(value(score, "translation_sq_sd_m2"), std::sqrt(2 * 0.04 * 0.04), 1e-12);
}

TEST(Relations, TurnsOfTenAndThirtyDegreesHaveTheMeanAndTheDeviationOfTheTwo) {
  const Trajectory path{{0, 1, 2}, {planar(0, 0, 0), planar(1, 0, pi / 18), planar(1, 0, pi / 18)}};
  const std::vector<Relation> relations{{0, 1, planar(1, 0, 0)}, {1, 2, planar(0, 0, pi / 6)}};
  const Score score = score_relations(relations, path, 0.01);
  EXPECT_NEAR(value(score, "rotation_deg"), 20, 1e-9);
  EXPECT_NEAR(value(score, "rotation_sd_deg"), std::sqrt(200.0), 1e-9);
  EXPECT_NEAR(value(score, "rotation_sq_deg2"), 500, 1e-9);
  EXPECT_NEAR(value(score, "rotation_sq_sd_deg2"), 800 / std::sqrt(2.0), 1e-9);
  for (const char* none : {"translation_m", "translation_sd_m", "translation_sq_m2", "translation_sq_sd_m2"})
    EXPECT_NEAR(value(score, none), 0, 1e-12) << none;
}

TEST(Relations, OneOfTwentyOneMayLackItsPose) {
  Trajectory path;
  std::vector<Relation> relations{{0, 99, planar(1, 0, 0)}};
  for (int i = 0; i <= 20; ++i) {
    path.stamp_s.push_back(i), path.X_WB.push_back(planar(i, 0, 0));
    if (i > 0) relations.push_back({i - 1.0, 1.0 * i, planar(1, 0, 0)});
  }
  const Score score = score_relations(relations, path, 0.01);
  EXPECT_NEAR(value(score, "matched_share"), 20.0 / 21, 1e-12);
  EXPECT_NEAR(value(score, "translation_sq_m2"), 0, 1e-12);
}

TEST(Relations, WithoutTheirPosesThereIsNoScore) {
  const Trajectory path{{0, 1}, {planar(0, 0, 0), planar(1, 0, 0)}};
  try {
    score_relations({{0, 1, planar(1, 0, 0)}, {0, 5, planar(1, 0, 0)}}, path, 0.13);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault(), Fault::not_comparable);
    EXPECT_NE(std::string(e.what()).find("1 of 2 relations"), std::string::npos) << e.what();
  }
}

TEST(Relations, AFileIsReadAndABadLineIsNamed) {
  const auto relations = read_relations(file_with("good", "# a comment\n1.5 2.5 1 2 3 0.1 0.2 0.3\n"));
  ASSERT_EQ(relations.size(), 1u);
  EXPECT_EQ(relations[0].to_s, 2.5);
  EXPECT_NEAR(std::atan2(relations[0].X.linear()(1, 0), relations[0].X.linear()(0, 0)), 0.3, 1e-12);
  for (const char* bad :
       {"0 1 0 0 0 0 0 0\n1 2 3\n", "0 1 0 0 0 0 0 0\n1 2 3 0 0 0 0 nan\n", "0 1 0 0 0 0 0 0\n1 2 3 0 0 0 0 0 9\n"})
    try {
      read_relations(file_with("bad", bad));
      FAIL() << bad;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find("relations_bad:2:"), std::string::npos) << e.what();
    }
}

TEST(Relations, GMappingsPublishedPosesScoreAsPublished) {
  const char* folder = std::getenv("ADIT_FR079");
  if (!folder) GTEST_SKIP() << "ADIT_FR079 names no folder with fr079.relations and gmapping_poses.txt";
  const std::string at = folder;
  const Score score =
      score_relations(read_relations(at + "/fr079.relations"), read_tum(at + "/gmapping_poses.txt"), 0.13);
  EXPECT_NEAR(value(score, "translation_m"), 0.0584, 0.00005);
  EXPECT_NEAR(value(score, "translation_sd_m"), 0.0419, 0.00005);
  EXPECT_NEAR(value(score, "rotation_deg"), 0.704, 0.0005);
}

}  // namespace
}  // namespace adit
