// SPDX-License-Identifier: BSD-3-Clause
#include "eval/closure_score.h"
#include "tests/eval/exact_case.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;

struct Said {
  std::vector<Metric> metrics;
  double operator()(const std::string& name) const {
    for (const Metric& m : metrics)
      if (m.name == name) return m.value;
    ADD_FAILURE() << "no metric " << name;
    return NAN;
  }
};

Said judged(const ExactCase& c, const std::vector<Closure>& closures) {
  const Caster caster(c.world.mesh);
  const PassageMap passages(c.world);
  const PathMatch match = associate(c.truth.drive.path, c.estimate.path, Pose::Identity(), 1);
  Said said;
  add_closures(MetricList(said.metrics), passages, caster, match, closures, {0.3, 0, 0.9}, ScoreSettings{}, "");
  return said;
}

// Index of the scan that is nearest to a distance along the path.
int scan_at(const ExactCase& c, double along_m) {
  const PathMatch match = associate(c.truth.drive.path, c.estimate.path, Pose::Identity(), 1);
  size_t best = 0;
  for (size_t i = 0; i < match.size(); ++i)
    if (std::abs(match.along_m[i] - along_m) < std::abs(match.along_m[best] - along_m)) best = i;
  return static_cast<int>(match.index[best]);
}

Closure place(int i, int j, double yaw_rad = 0) {
  Closure c;
  c.i = i;
  c.j = j;
  c.X_ij = {0, 0, yaw_rad};
  c.accepted = true;
  return c;
}

TEST(ClosureScore, ARightPlaceClosesTheRing) {
  const ExactCase& c = ring_case();
  // The second round begins after 64 m; 4 m into it the cart is where it was after 4 m.
  const Said said = judged(c, {place(scan_at(c, 4), scan_at(c, 68))});
  EXPECT_EQ(said("wrong"), 0);
  EXPECT_EQ(said("precision"), 1);
  EXPECT_EQ(said("loops_true"), 1);
  EXPECT_EQ(said("loops_by_closure"), 1);
  EXPECT_EQ(said("loops_closed"), 1);
  EXPECT_GT(said("recall"), 0.7);  // 5 m to either side of it, of about 10 m that are driven again
}

TEST(ClosureScore, WithoutAnyNothingIsFoundAndNoLoopTied) {
  const Said said = judged(ring_case(), {});
  EXPECT_EQ(said("recall"), 0);
  EXPECT_EQ(said("loops_true"), 1);
  EXPECT_EQ(said("loops_by_closure"), 0);
  EXPECT_TRUE(std::isnan(said("precision")));
}

TEST(ClosureScore, APathThatComesBackMetresOffHasNotClosedItsLoop) {
  ExactCase c = ring_case();
  const double turn_rad = 0.1 * pi / 180;  // too much, each scan; over 320 scans of a round 32 deg
  for (size_t i = 0; i < c.estimate.path.size(); ++i)
    c.estimate.path.X_WB[i] = pose_of(Vec3::Zero(), turn_rad * static_cast<double>(i)) * c.estimate.path.X_WB[i] *
                              pose_of({0.005 * static_cast<double>(i), 0, 0}, 0);
  const Said said = judged(c, {});
  EXPECT_EQ(said("loops_true"), 1);
  EXPECT_EQ(said("loops_closed"), 0);
}

TEST(ClosureScore, AcrossThePillarOrTheWrongWayRoundIsWrong) {
  const ExactCase& c = ring_case();
  const Said said = judged(c, {place(scan_at(c, 8), scan_at(c, 40)),        // the far side of the pillar
                               place(scan_at(c, 4), scan_at(c, 68), pi)});  // the right place, said to be opposite
  EXPECT_EQ(said("accepted"), 2);
  EXPECT_EQ(said("wrong"), 2);
  EXPECT_EQ(said("precision"), 0);
  EXPECT_EQ(said("recall"), 0);
  EXPECT_EQ(said("loops_by_closure"), 0);
}

TEST(ClosureScore, ARejectedOneCountsNeitherWay) {
  const ExactCase& c = ring_case();
  Closure wrong = place(scan_at(c, 8), scan_at(c, 40));
  wrong.accepted = false;
  wrong.ambiguous = true;
  const Said said = judged(c, {wrong});
  EXPECT_EQ(said("wrong"), 0);
  EXPECT_EQ(said("ambiguous"), 1);
}

TEST(ClosureScore, AMeasuredPoseIsHeldAgainstTheTrueOne) {
  const ExactCase& c = ring_case();
  Closure measured = place(scan_at(c, 4), scan_at(c, 67));
  measured.measured = true;
  const Trajectory& path = c.estimate.path;
  const Pose2 truth = flatten(path.X_WB[measured.i].inverse() * path.X_WB[measured.j]);
  measured.X_ij = {truth.x_m + 0.45, truth.y_m, truth.yaw_rad};
  EXPECT_EQ(judged(c, {measured})("wrong"), 0);
  measured.X_ij = {truth.x_m + 0.55, truth.y_m, truth.yaw_rad};  // by place it would still be right
  EXPECT_EQ(judged(c, {measured})("wrong"), 1);
  measured.X_ij = {truth.x_m, truth.y_m, truth.yaw_rad + 4 * pi / 180};
  EXPECT_EQ(judged(c, {measured})("wrong"), 1);
}

TEST(ClosureScore, ThereAndBackRevisitsButGoesRoundNothing) {
  const ExactCase c = drive_exactly(tunnel_world(40, 4, 2, 2), {{4, 0, 0}, {36, 0, 0}, {4, 0, 0}});
  const Said said = judged(c, {place(scan_at(c, 10), scan_at(c, 54), pi)});
  EXPECT_EQ(said("loops_true"), 0);
  EXPECT_EQ(said("loops_closed"), 0);
  EXPECT_EQ(said("wrong"), 0);
  EXPECT_GT(said("recall"), 0);
}

TEST(PassageMap, AWalkRoundTheRingFollowsEachPassageOnce) {
  const World world = ring_world(20, 4, 2, 2);
  const PassageMap map(world);
  std::vector<double> chain(map.size(), 0.0);
  const Vec2 stops[] = {{0, -8}, {8, 0}, {0, 8.5}, {-7.5, 0}, {0, -8}};
  for (int k = 0; k < 4; ++k) map.add_way(map.locate(stops[k]), map.locate(stops[k + 1]), chain);
  for (const double c : chain) EXPECT_NEAR(c, 1, 1e-12);
}

TEST(PassageMap, TheNearestCentreLineIsTheSameAsByTryingAll) {
  const World world = ring_world(40, 4, 2, 4);
  const PassageMap map(world);
  for (int i = 0; i < 400; ++i) {
    const Vec2 p(-25 + 50 * (i % 20) / 19.0 + 0.013, -25 + 50 * (i / 20) / 19.0 + 0.029);
    double best = 1e9;
    for (const Passage& passage : world.passages) {
      const Vec2 a = passage.centre_line.front().head<2>(), d = passage.centre_line.back().head<2>() - a;
      best = std::min(best, (a + std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0) * d - p).norm());
    }
    EXPECT_NEAR(map.locate(p).distance_m, best, 1e-12);
  }
}

}  // namespace
}  // namespace adit
