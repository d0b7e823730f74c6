// SPDX-License-Identifier: BSD-3-Clause
#include "eval/bound.h"

#include "base/parallel.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double open_m = 1;          // a bound of more than this leaves its direction open
constexpr double met_edge_on = 0.02;  // cosine below which a beam's range says nothing that noise would not drown

double noise_m(const LaserModel& laser) {
  return std::sqrt(laser.sigma_m * laser.sigma_m + laser.resolution_m * laser.resolution_m / 12);
}

// How far the end of the middle beam lies beyond the line through its neighbours' ends.
double bulge_m(const TrueBeam& before, const TrueBeam& at, const TrueBeam& after, const Vec3& normal_of_scan) {
  const Vec3 line = after.end() - before.end();
  const Vec3 side = normal_of_scan.cross(line).normalized();
  const double slope = side.dot(at.direction);
  return std::abs(slope) < met_edge_on ? none : std::abs(side.dot(at.end() - before.end()) / slope);
}

// Covariance of the body's pose in its own x, y and yaw, where the information leaves nothing open.
bool covariance_of(const ScanInformation& scan, const Pose& X_BS, Eigen::Matrix3d& C_B) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(scan.I);
  if (!(eigen.eigenvalues()[0] > 1 / (open_m * open_m))) return false;
  // A turn of the body moves the laser: in the plane, both errors in their own frame.
  const Pose2 mount = flatten(X_BS);
  Eigen::Matrix3d A = Eigen::Matrix3d::Identity();
  A.topLeftCorner<2, 2>() = Eigen::Rotation2Dd(mount.yaw_rad).toRotationMatrix();
  A(0, 2) = mount.y_m;
  A(1, 2) = -mount.x_m;
  C_B = A * scan.I.inverse() * A.transpose();
  return true;
}

struct Pair {
  bool counts = false, smooth = false;
  std::array<double, 3> bound{}, error{};  // variance of the bound, square of the error: x, y, yaw
};

struct Sums {
  std::array<double, 3> bound{}, error{};
  std::int64_t n = 0;
};

// Geometric mean over the axes, NaN where one lacks.
double add_sums(const MetricList& list, const Sums& sums, const std::string& why) {
  constexpr std::array<const char*, 3> axis{"along", "across", "yaw"};
  double product = 1;
  for (size_t k = 0; k < 3; ++k) {
    const double count = sums.n ? static_cast<double>(sums.n) : none;
    const double unit = k == 2 ? 180 / std::numbers::pi : 1;
    const std::string name = k == 2 ? "deg" : "m";
    const double bound = unit * std::sqrt(sums.bound[k] / count), measured = unit * std::sqrt(sums.error[k] / count);
    const double efficiency = measured > 1e-6 * bound ? bound / measured : none;  // else rounding is all there is
    const MetricList at = list.under(axis[k]);
    at.add("bound_" + name, bound, name, Better::lower, sums.n, why);
    at.add("measured_" + name, measured, name, Better::lower, sums.n, why);
    at.add("relative_efficiency", efficiency, "ratio", Better::higher, sums.n,
           sums.n ? "scan matching alone made no error" : why);
    product *= efficiency;
  }
  return std::isfinite(product) ? std::cbrt(product) : none;
}

}  // namespace

ScanInformation information_of(const TrueScans& scans, const Mesh& mesh, size_t laser, size_t scan) {
  ScanInformation out;
  const std::vector<TrueBeam> fan = scans.fan(laser, scan, 1);
  const Eigen::Matrix3d R_SW = scans.X_WS(laser, scan).linear().transpose();
  const Vec3 z_W = R_SW.row(2);
  const double sigma = noise_m(scans.mount(laser).laser);
  std::vector<double> bulges;
  for (size_t k = 0; k < fan.size(); ++k) {
    const TrueBeam& b = fan[k];
    if (!b.met) continue;
    const Vec3 n = R_SW * mesh.normal(static_cast<size_t>(b.face)), d = R_SW * b.direction;
    const double cosine = n.dot(d);
    if (std::abs(cosine) < met_edge_on) continue;
    const Vec3 g = -Vec3(n.x(), n.y(), b.range_m * (n.y() * d.x() - n.x() * d.y())) / cosine;
    out.I += g * g.transpose() / (sigma * sigma);
    ++out.beams;
    if (k == 0 || k + 1 == fan.size() || !fan[k - 1].met || !fan[k + 1].met) continue;
    const double bulge = bulge_m(fan[k - 1], b, fan[k + 1], z_W);
    if (std::isfinite(bulge)) bulges.push_back(bulge);
  }
  out.roughness_m = quantile(bulges, 0.5);
  return out;
}

PositionBound position_bound(const ScanInformation& scan) {
  Eigen::Matrix2d I = scan.I.topLeftCorner<2, 2>();
  const Eigen::Vector2d with_yaw = scan.I.topRightCorner<2, 1>();
  if (scan.I(2, 2) > 0) I -= with_yaw * with_yaw.transpose() / scan.I(2, 2);
  const Eigen::Vector2d told = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(I).eigenvalues();
  const double least = 1e-12 * std::max(told[1], 1.0);  // less is rounding
  const auto deviation = [&](double information) {
    return information > least ? 1 / std::sqrt(information) : HUGE_VAL;
  };
  return {deviation(told[0]), deviation(told[1])};
}

void add_bound(const MetricList& list, const TrueScans& scans, const Mesh& mesh, int laser, const Pose& X_BS,
               const PathMatch& match, const std::vector<Pose2>& open_loop, const std::string& why) {
  std::string reason = why;
  if (reason.empty() && laser < 0) reason = "the rig has no horizontal laser";
  if (reason.empty() && open_loop.size() != match.asked) reason = "the estimate has no path of scan matching alone";
  const auto l = static_cast<size_t>(std::max(0, laser));
  if (reason.empty() && scans.scans(l) != match.asked)
    reason = "the path of scan matching alone has not one pose for each scan";
  if (reason.empty() && !(noise_m(scans.mount(l).laser) > 0))
    reason = "the laser's sheet states no noise: nothing bounds it";
  const size_t n = reason.empty() && match.size() > 1 ? match.size() - 1 : 0;
  std::vector<Pair> pairs(n);
  parallel_for(
      n,
      [&](size_t k) {
        if (match.index[k + 1] != match.index[k] + 1) return;
        const ScanInformation scan = information_of(scans, mesh, l, match.index[k]);
        Eigen::Matrix3d C;
        if (!covariance_of(scan, X_BS, C)) return;
        const Pose2 truth = flatten(match.X_WB[k].inverse() * match.X_WB[k + 1]);
        const Pose2 error = truth.inverse() * (open_loop[match.index[k]].inverse() * open_loop[match.index[k + 1]]);
        pairs[k] = {true,
                    scan.roughness_m < noise_m(scans.mount(l).laser),
                    {2 * C(0, 0), 2 * C(1, 1), 2 * C(2, 2)},
                    {error.x_m * error.x_m, error.y_m * error.y_m, error.yaw_rad * error.yaw_rad}};
      },
      16);
  Sums all, smooth, rough;
  for (const Pair& p : pairs) {
    if (!p.counts) continue;
    for (Sums* s : {&all, p.smooth ? &smooth : &rough}) {
      for (size_t k = 0; k < 3; ++k) s->bound[k] += p.bound[k], s->error[k] += p.error[k];
      ++s->n;
    }
  }
  const auto because = [&](const char* what) { return reason.empty() ? std::string(what) : reason; };
  const double efficiency =
      add_sums(list.under("all"), all, because("no two scans in sequence tell all three of their motion"));
  add_sums(list.under("smooth"), smooth, because("no scan met smooth walls"));
  add_sums(list.under("rough"), rough, because("no scan met rough walls"));
  list.add(
      "relative_efficiency", efficiency, "ratio", Better::higher, all.n,
      all.n ? "scan matching alone made no error" : because("no two scans in sequence tell all three of their motion"));
}

}  // namespace adit
