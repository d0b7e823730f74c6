// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "tests/eval/exact_case.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>

namespace adit {
namespace {

using ::testing::HasSubstr;

std::string said_of(const std::function<void(ExactCase&)>& spoil) {
  ExactCase c = tunnel_case();
  spoil(c);
  try {
    score_of(c);
  } catch (const Error& e) {
    EXPECT_EQ(e.fault(), Fault::bad_input);
    return e.what();
  }
  return "scored";
}

TEST(Plausible, UnitsOtherThanMetresAreRecognisedAndSaid) {
  for (const auto& [factor, unit] : std::vector<std::pair<double, std::string>>{
           {1000, "millimetres"}, {100, "centimetres"}, {0.001, "kilometres"}}) {
    const auto scale = [&](Vec3& p) { p *= factor; };
    EXPECT_THAT(said_of([&](ExactCase& c) {
                  for (Pose& X : c.estimate.path.X_WB) X.translation() *= factor;
                }),
                ::testing::AllOf(HasSubstr("path"), HasSubstr(unit)));
    EXPECT_THAT(said_of([&](ExactCase& c) {
                  for (Vec3& p : c.estimate.points.p) scale(p);
                }),
                ::testing::AllOf(HasSubstr("points"), HasSubstr(unit)));
    EXPECT_THAT(said_of([&](ExactCase& c) {
                  for (Vec3& p : c.estimate.surface.vertex) scale(p);
                }),
                ::testing::AllOf(HasSubstr("surface"), HasSubstr(unit)));
  }
  EXPECT_THAT(said_of([](ExactCase& c) { c.estimate.grid.cell_m = 50; }), HasSubstr("cells of 50 m"));
}

TEST(Plausible, APathThatErrsByAThirdIsScored) {
  EXPECT_EQ(said_of([](ExactCase& c) {
              for (Pose& X : c.estimate.path.X_WB) X.translation() *= 0.67;
            }),
            "scored");
}

TEST(Plausible, ASurfaceInsideOutIsRefusedAndOneWithAHoleSaysWhy) {
  EXPECT_THAT(said_of([](ExactCase& c) {
                for (auto& f : c.estimate.surface.face) std::swap(f[0], f[1]);
              }),
              HasSubstr("inside out"));
  EXPECT_THAT(
      said_of([](ExactCase& c) { c.estimate.surface.vertex[0].x() = std::numeric_limits<double>::quiet_NaN(); }),
      HasSubstr("no number"));
  ExactCase half = tunnel_case();
  std::swap(half.estimate.surface.face[0][0], half.estimate.surface.face[0][1]);  // one face turned over
  EXPECT_THAT(score_of(half).find("volume.mapped_m3")->why, HasSubstr("open edges"));
}

TEST(Plausible, PointsThatAreNoNumbersAreLeftOutAndAllOfThemRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ExactCase c = tunnel_case();
  c.estimate.points.p[0].x() = nan;
  const Score score = score_of(c);
  EXPECT_EQ(score.find("map.se3.mae_m")->n, static_cast<std::int64_t>(c.estimate.points.size()) - 1);
  EXPECT_LT(value(score, "map.se3.mae_m"), 1e-9);
  EXPECT_THAT(said_of([&](ExactCase& all) {
                for (Vec3& p : all.estimate.points.p) p.setConstant(nan);
              }),
              HasSubstr("no point with finite"));
}

TEST(Plausible, PosesThatAreNoNumbersHaveNoTruthAndTooManyOfThemNoScore) {
  ExactCase c = tunnel_case();
  for (size_t i = 0; i < c.estimate.path.size(); i += 3)
    c.estimate.path.X_WB[i].translation().x() = std::numeric_limits<double>::quiet_NaN();
  try {
    score_of(c);
    FAIL() << "scored";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault(), Fault::not_comparable);
  }
}

TEST(Plausible, PointsInAnotherFrameThanThePathAreWarnedOf) {
  ExactCase c = tunnel_case();
  const Pose X = pose_of({3, 40, 0}, 1);
  for (Vec3& p : c.estimate.points.p) p = X * p;
  const Score score = score_of(c);
  ASSERT_EQ(score.warnings.size(), 2u);  // the other: the path is too straight for positions alone
  EXPECT_THAT(score.warnings[1], HasSubstr("frame of the path"));
  EXPECT_EQ(score_of(tunnel_case()).warnings.size(), 1u);
}

TEST(Plausible, AVolumeInLitresIsWarnedOf) {
  ExactCase c = tunnel_case();
  c.estimate.points = {};
  c.estimate.volume_m3 = 160e3;  // of 160 m3
  EXPECT_THAT(score_of(c).warnings.back(), HasSubstr("1000 times the mine's: is it told in m3"));
  c.estimate.volume_m3 = 160;
  EXPECT_EQ(score_of(c).warnings.size(), 1u);  // the path is too straight for positions alone
}

TEST(Plausible, CovariancesMustBeAsManyAsPoses) {
  EXPECT_THAT(said_of([](ExactCase& c) { c.estimate.covariance.assign(3, Eigen::MatrixXd::Identity(3, 3)); }),
              HasSubstr("3 covariances"));
}

}  // namespace
}  // namespace adit
