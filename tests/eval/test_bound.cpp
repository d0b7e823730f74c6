// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "eval/bound.h"
#include "rays/caster.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi, sigma = 0.01;

// One laser that stands at X_WS and fires `beams` over half a circle, `scans` times a second.
struct Standing {
  Mesh mesh;
  Truth truth;
  Standing(Mesh m, const Pose& X_WS, int beams, int scans) : mesh(std::move(m)) {
    Mount mount;
    mount.name = "front";
    mount.laser.fov_rad = pi;
    mount.laser.beams = beams;
    mount.laser.range_max_m = 50;
    mount.laser.sigma_m = sigma;
    truth.rig.mounts = {mount};
    const Caster caster(mesh);
    ScanTruth& s = truth.scans.emplace_back();
    for (int i = 0; i <= scans; ++i) {
      truth.drive.path.stamp_s.push_back(i);
      truth.drive.path.X_WB.push_back(X_WS);
      if (i == scans) break;
      s.stamp_s.push_back(i);
      for (int k = 0; k < beams; ++k) {
        const double a = mount.laser.beam_angle_rad(k);
        const Hit hit = caster.nearest({X_WS.translation(), X_WS.linear() * Vec3(std::cos(a), std::sin(a), 0)});
        s.range_m.push_back(static_cast<float>(hit.range_m));
        s.face.push_back(hit.face);
        s.label.push_back(3);
        s.part.push_back(0);
        s.incidence_rad.push_back(static_cast<float>(std::acos(std::min(1.0, hit.cosine))));
      }
    }
  }
};

Mesh room() {
  return box_mesh({-2, -3, 0}, {2, 3, 2});
}

double value(const std::vector<Metric>& metrics, const std::string& name) {
  for (const Metric& m : metrics)
    if (m.name == name) return m.value;
  ADD_FAILURE() << "no metric " << name;
  return NAN;
}

TEST(Bound, FiveBeamsInARoomTellWhatArithmeticSays) {
  // Beams at -90, -45, 0, 45, 90 deg. Straight onto a wall a beam tells its direction alone: y twice, x once. The slanted
  // two meet the wall at x = 2 after sqrt(8) m with cosine sqrt(1/2): (1, 0, -+2) / sqrt(1/2), whose squares are 2, 0, 8.
  const Standing s(room(), pose_of({0, 0, 1}, 0), 5, 1);
  const Eigen::Matrix3d I = information_of(TrueScans(s.truth, s.mesh), s.mesh, 0, 0).I * sigma * sigma;
  EXPECT_TRUE(I.isApprox(Vec3(5, 2, 16).asDiagonal().toDenseMatrix(), 1e-6)) << I;  // float ranges
}

TEST(Bound, APositionIsToldAsWellAsArithmeticSays) {
  ScanInformation scan;
  scan.I = Vec3(5, 2, 16).asDiagonal();
  EXPECT_NEAR(position_bound(scan).least_m, 1 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(position_bound(scan).most_m, 1 / std::sqrt(5.0), 1e-12);
  // A heading that has to be found too takes 4 * 4 / 16 from the 5 of x, and leaves y's 2 alone.
  scan.I(0, 2) = scan.I(2, 0) = 4;
  EXPECT_NEAR(position_bound(scan).least_m, 1 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(position_bound(scan).most_m, 1 / std::sqrt(4.0), 1e-12);
}

TEST(Bound, ATunnelWithoutEndLeavesTheWayAlongItOpen) {
  ScanInformation scan;
  scan.I = Vec3(0, 3e4, 16).asDiagonal();
  scan.I(0, 0) = 1e-13;  // rounding
  EXPECT_TRUE(std::isinf(position_bound(scan).least_m));
  EXPECT_NEAR(position_bound(scan).most_m, 1 / std::sqrt(3e4), 1e-12);
}

TEST(Bound, TheInformationIsThatOfTheRangesOwnDerivatives) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const auto u = [&](int k) { return 2 * uniform(seed, Draw::test, static_cast<std::uint64_t>(k)) - 1; };
    const Pose X = pose_of({u(0), u(1), 1}, 3 * u(2));
    const Standing s(room(), X, 37, 1);
    const Eigen::Matrix3d I = information_of(TrueScans(s.truth, s.mesh), s.mesh, 0, 0).I * sigma * sigma;
    const Caster caster(s.mesh);
    Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
    constexpr double h = 1e-5;
    const auto range_m = [&](int k, const Pose& at) {
      const double a = s.truth.rig.mounts[0].laser.beam_angle_rad(k);
      return caster.nearest({at.translation(), at.linear() * Vec3(std::cos(a), std::sin(a), 0)}).range_m;
    };
    for (int k = 0; k < 37; ++k) {
      const Vec3 g((range_m(k, X * pose_of({h, 0, 0}, 0)) - range_m(k, X * pose_of({-h, 0, 0}, 0))) / (2 * h),
                   (range_m(k, X * pose_of({0, h, 0}, 0)) - range_m(k, X * pose_of({0, -h, 0}, 0))) / (2 * h),
                   (range_m(k, X * pose_of({0, 0, 0}, h)) - range_m(k, X * pose_of({0, 0, 0}, -h))) / (2 * h));
      expected += g * g.transpose();
    }
    // A beam within 1e-5 of a corner would differ; none of the seeds has one.
    EXPECT_TRUE(I.isApprox(expected, 1e-4)) << "seed " << seed << "\n" << I << "\n" << expected;
  }
}

TEST(Bound, EfficiencyIsTheBoundOverWhatWasMeasured) {
  const Standing s(room(), pose_of({0, 0, 1}, 0), 5, 11);
  PathMatch match;
  std::vector<Pose2> open_loop;
  for (size_t i = 0; i < 11; ++i) {
    match.index.push_back(i);
    match.stamp_s.push_back(static_cast<double>(i));
    match.along_m.push_back(0);
    match.X_WB.push_back(s.truth.drive.path.X_WB[0]);
    match.X_MB.push_back(Pose::Identity());
    // Every step errs by 2 cm along, 1 cm across and 0.01 rad, forth and back.
    const Pose2 off = i % 2 ? Pose2{0.02, 0.01, 0.01} : Pose2{};
    open_loop.push_back(off);
  }
  match.asked = 11;
  std::vector<Metric> all;
  add_bound(MetricList(all), TrueScans(s.truth, s.mesh), s.mesh, 0, Pose::Identity(), match, open_loop, "");
  EXPECT_NEAR(value(all, "all.along.bound_m"), sigma * std::sqrt(2.0 / 5), 1e-6);
  EXPECT_NEAR(value(all, "all.across.bound_m"), sigma, 1e-6);
  EXPECT_NEAR(value(all, "all.yaw.bound_deg"), sigma * std::sqrt(2.0 / 16) * 180 / pi, 1e-5);
  EXPECT_NEAR(value(all, "all.along.measured_m"), 0.02, 2e-4);  // on the way back seen from the turned frame
  EXPECT_NEAR(value(all, "all.across.relative_efficiency"), 1, 0.02);
  EXPECT_NEAR(value(all, "all.yaw.relative_efficiency"), std::sqrt(2.0 / 16), 1e-3);
  EXPECT_NEAR(value(all, "relative_efficiency"), std::cbrt(std::sqrt(0.4) / 2 * 1 * std::sqrt(0.125)), 0.01);
}

TEST(Bound, ALaserOffTheBodysMiddleTellsTheBodyLessByItsLever) {
  const Standing s(room(), pose_of({0, 0, 1}, 0), 5, 2);
  PathMatch match;
  match.asked = 2;
  match.index = {0, 1};
  match.stamp_s = match.along_m = {0, 1};
  match.X_WB = match.X_MB = {Pose::Identity(), Pose::Identity()};
  std::vector<Metric> all;
  // One metre ahead of the body: its turn of sd sigma / 4 moves the body sideways by as much, beside sigma / sqrt 2.
  add_bound(MetricList(all), TrueScans(s.truth, s.mesh), s.mesh, 0, pose_of({1, 0, 0}, 0), match, {{}, {}}, "");
  EXPECT_NEAR(value(all, "all.across.bound_m"), sigma * std::sqrt(2 * (1.0 / 2 + 1.0 / 16)), 1e-6);
  EXPECT_NEAR(value(all, "all.along.bound_m"), sigma * std::sqrt(2.0 / 5), 1e-6);
}

TEST(Bound, ASmoothTunnelLeavesTheWayAlongItOpen) {
  // 91 beams that all end on the two sides: both ends are beyond the laser's range.
  const Standing s(box_mesh({-500, -2, 0}, {500, 2, 2}), pose_of({0, 0, 1}, 0), 91, 2);
  const ScanInformation scan = information_of(TrueScans(s.truth, s.mesh), s.mesh, 0, 0);
  EXPECT_NEAR(scan.I(0, 0), 0, 1e-9 * scan.I(1, 1));
  EXPECT_NEAR(scan.roughness_m, 0, 1e-4);  // ranges are floats
  PathMatch match;
  match.asked = 2;
  match.index = {0, 1};
  match.stamp_s = match.along_m = {0, 1};
  match.X_WB = match.X_MB = {Pose::Identity(), Pose::Identity()};
  std::vector<Metric> all;
  add_bound(MetricList(all), TrueScans(s.truth, s.mesh), s.mesh, 0, Pose::Identity(), match, {{}, {}}, "");
  EXPECT_TRUE(std::isnan(value(all, "relative_efficiency")));
}

}  // namespace
}  // namespace adit
