// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/chain.h"
#include "mapper/places.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

constexpr double step_m = 0.2;
constexpr int scans_a_pass = 200;

/// A rib at y = side * rib_m(x): no two stretches of it are alike.
double rib_m(double x_m, double side) {
  return 2 + 0.25 * std::sin(1.1 * x_m + side) + 0.2 * std::sin(2.3 * x_m + 0.013 * x_m * x_m);
}

/// What a laser at (x, 0) that looks along x sees of both ribs.
ScanPoints ribs_seen_from(double x_m) {
  ScanPoints s;
  for (const double side : {-1.0, 1.0})
    for (double ahead_m = 0.5; ahead_m < 9; ahead_m += 0.1) {
      const double x = x_m + ahead_m, slope = (rib_m(x + 1e-4, side) - rib_m(x - 1e-4, side)) / 2e-4;
      s.p_B.emplace_back(ahead_m, side * rib_m(x, side));
      s.normal_B.push_back(Vec2(slope, -side).normalized());
      s.sigma_m.push_back(0.005), s.sigma_normal_rad.push_back(0.005), s.z_m.push_back(0);
      s.beam.push_back(static_cast<int>(s.beam.size()));
    }
  return s;
}

/// A passage driven twice, the same way. On the first pass the steps within (11, 16) m come out as 0.4 of what they are, as
/// a prediction does that has lost its speed, and are told to be open by a metre.
struct TwoPasses {
  std::vector<ScanPoints> scans;
  std::vector<double> x_m;  // true
  Odometry odometry;

  TwoPasses() {
    for (int pass = 0; pass < 2; ++pass)
      for (int k = 0; k < scans_a_pass; ++k) x_m.push_back(k * step_m + 0.07 * pass);
    Pose2 X;
    for (size_t i = 0; i < x_m.size(); ++i) {
      const bool predicted = i < scans_a_pass && x_m[i] > 11 && x_m[i] < 16;
      const double step = i == 0 ? 0 : (x_m[i] - x_m[i - 1]) * (predicted ? 0.4 : 1);
      X = X * Pose2{step, 0, 0};
      odometry.stamp_s.push_back(static_cast<double>(i));
      odometry.X_MB.push_back(X);
      odometry.X_step.push_back({step, 0, 0});
      odometry.information.push_back(1e6 * Eigen::Matrix3d::Identity());
      scans.push_back(ribs_seen_from(x_m[i]));
    }
    odometry.degenerate.push_back({11 / step_m, 16 / step_m, 1.0});
  }

  /// How far off the truth the second passage of a scan is laid to the first.
  double error_m(int i, const PlaceSettings& settings) const {
    const Chain chain = chain_of(odometry, 1);
    const MatchPlaces match = match_by_scans(scans, chain, odometry, settings, {});
    const PlacePair pair{i, i + scans_a_pass, {0.2, 0.05, 0.01}, 0.3, 0.1};
    const PlaceMatch m = match({pair}).front();
    return m.found ? (m.X_ij.position() - Vec2(x_m[pair.j] - x_m[pair.i], 0)).norm() : 1e3;
  }
};

TEST(Places, AStretchOfUnknownLengthIsNoPartOfAPlace) {
  const TwoPasses way;
  PlaceSettings all;
  all.rigid_m = 1000;
  // Before the stretch, just behind it, and within: ribs are exact, what is left is the blend of the map, some millimetres.
  for (const int i : {52, 81, 65}) EXPECT_LT(way.error_m(i, {}), 0.02) << "scan " << i;
  // The same behind the stretch with all that lies within its reach.
  EXPECT_GT(way.error_m(81, all), 0.1);
}

TEST(Places, WhereTheWayIsKnownAPlaceIsMadeOfAllAroundIt) {
  const TwoPasses way;
  PlaceSettings all;
  all.rigid_m = 1000;
  EXPECT_EQ(way.error_m(130, {}), way.error_m(130, all));
  EXPECT_LT(way.error_m(130, {}), 0.02);
}

}  // namespace
}  // namespace adit
