// SPDX-License-Identifier: BSD-3-Clause
#include "eval/path_error.h"

#include "base/error.h"

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double deg = std::numbers::pi / 180;
constexpr double rounding_m = 1e-6;  // a way that is a whole number of steps is not one step longer by its last bit

// The rotation R that maximises trace(R^T * H).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& H) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d S = Eigen::Matrix3d::Identity();
  if ((svd.matrixU() * svd.matrixV().transpose()).determinant() < 0) S(2, 2) = -1;
  return svd.matrixU() * S * svd.matrixV().transpose();
}

struct Means {
  Vec3 W = Vec3::Zero(), M = Vec3::Zero();
};

Means mean_positions(const PathMatch& m, size_t begin, size_t end) {
  Means mean;
  for (size_t i = begin; i < end; ++i) mean.W += m.X_WB[i].translation(), mean.M += m.X_MB[i].translation();
  mean.W /= static_cast<double>(end - begin);
  mean.M /= static_cast<double>(end - begin);
  return mean;
}

Pose laid(const Eigen::Matrix3d& R_WM, const Means& mean) {
  Pose X = Pose::Identity();
  X.linear() = R_WM;
  X.translation() = mean.W - R_WM * mean.M;
  return X;
}

double rms(double sum_of_squares, size_t n) {
  return n ? std::sqrt(sum_of_squares / static_cast<double>(n)) : none;
}

std::string distance_name(double d_m) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", d_m);
  return text;
}

}  // namespace

PathMatch associate(const Trajectory& truth, const Trajectory& estimate, const Pose& X_BN, double max_gap_s) {
  PathMatch match;
  match.asked = estimate.size();
  if (truth.empty()) return match;
  const std::vector<double> along = distance_along(truth);
  for (size_t i = 0; i < estimate.size(); ++i) {
    const double t = estimate.stamp_s[i];
    if (!truth.covers(t) || !estimate.X_WB[i].matrix().allFinite()) continue;
    const auto next = std::upper_bound(truth.stamp_s.begin(), truth.stamp_s.end(), t);
    const size_t b = std::min<size_t>(static_cast<size_t>(next - truth.stamp_s.begin()), truth.size() - 1);
    const size_t a = b ? b - 1 : 0;
    const double gap_s = truth.stamp_s[b] - truth.stamp_s[a];
    const bool on_a_pose = t == truth.stamp_s[a] || t == truth.stamp_s[b];
    if (gap_s > max_gap_s && !on_a_pose) continue;
    const double s = gap_s > 0 ? (t - truth.stamp_s[a]) / gap_s : 0;
    if (!on_a_pose) match.widest_s = std::max(match.widest_s, gap_s);
    match.index.push_back(i);
    match.stamp_s.push_back(t);
    match.along_m.push_back(along[a] + s * (along[b] - along[a]));
    match.X_WB.push_back(interpolate(truth.X_WB[a], truth.X_WB[b], s) * X_BN);
    match.X_MB.push_back(estimate.X_WB[i]);
  }
  return match;
}

PathMatch associate_nearest(const Trajectory& truth, const Trajectory& estimate, double max_diff_s) {
  constexpr size_t nobody = static_cast<size_t>(-1);
  PathMatch match;
  match.asked = std::min(truth.size(), estimate.size());
  std::vector<size_t> taker(truth.size(), nobody);
  const auto apart = [&](size_t t, size_t e) { return std::abs(truth.stamp_s[t] - estimate.stamp_s[e]); };
  size_t near = 0;
  for (size_t e = 0; e < estimate.size() && !truth.empty(); ++e) {
    if (!estimate.X_WB[e].matrix().allFinite()) continue;
    while (near + 1 < truth.size() && apart(near + 1, e) < apart(near, e)) ++near;
    if (apart(near, e) > max_diff_s) continue;
    if (taker[near] == nobody || apart(near, e) < apart(near, taker[near])) taker[near] = e;
  }
  const std::vector<double> along = distance_along(truth);
  for (size_t t = 0; t < truth.size(); ++t) {
    const size_t e = taker[t];
    if (e == nobody) continue;
    match.index.push_back(e);
    match.stamp_s.push_back(estimate.stamp_s[e]);
    match.along_m.push_back(along[t]);
    match.X_WB.push_back(truth.X_WB[t]);
    match.X_MB.push_back(estimate.X_WB[e]);
    match.widest_s = std::max(match.widest_s, apart(t, e));
  }
  return match;
}

Alignment align_first_pose(const PathMatch& match) {
  ADIT_CHECK(match.size() > 0);
  return {match.X_WB[0] * match.X_MB[0].inverse(), "the first pose alone (6 degrees of freedom, none of them fitted)",
          ""};
}

Pose align_mean_pose(const PathMatch& match, size_t begin, size_t end) {
  ADIT_CHECK(begin < end);
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  for (size_t i = begin; i < end; ++i) H += match.X_WB[i].linear() * match.X_MB[i].linear().transpose();
  return laid(nearest_rotation(H), mean_positions(match, begin, end));
}

Alignment align_se3(const PathMatch& match) {
  ADIT_CHECK(match.size() > 0);
  const Means mean = mean_positions(match, 0, match.size());
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero(), spread = Eigen::Matrix3d::Zero();
  for (size_t i = 0; i < match.size(); ++i) {
    const Vec3 w = match.X_WB[i].translation() - mean.W, m = match.X_MB[i].translation() - mean.M;
    H += w * m.transpose();
    spread += w * w.transpose();
  }
  const Vec3 variance = spread.jacobiSvd().singularValues() / static_cast<double>(match.size());
  if (std::sqrt(variance[1]) < 0.5)
    return {
        align_mean_pose(match, 0, match.size()), "mean position and mean orientation (6 degrees of freedom fitted)",
        "the path is too straight for positions alone to fix a rotation about it: se3 uses the mean orientation too"};
  return {laid(nearest_rotation(H), mean),
          "least squares over the positions, Umeyama without scale (6 degrees of freedom fitted)", ""};
}

Alignment align_yaw_xyz(const PathMatch& match) {
  ADIT_CHECK(match.size() > 0);
  const Means mean = mean_positions(match, 0, match.size());
  double along = 0, across = 0;
  for (size_t i = 0; i < match.size(); ++i) {
    const Vec3 w = match.X_WB[i].translation() - mean.W, m = match.X_MB[i].translation() - mean.M;
    along += w.x() * m.x() + w.y() * m.y();
    across += w.y() * m.x() - w.x() * m.y();
  }
  return {laid(rotation_of(std::atan2(across, along), 0, 0), mean),
          "least squares over the positions, turned about the vertical alone (4 degrees of freedom fitted)", ""};
}

std::vector<PoseError> pose_errors(const PathMatch& match, const Pose& X_WM) {
  std::vector<PoseError> errors;
  for (size_t i = 0; i < match.size(); ++i) {
    const Pose X = X_WM * match.X_MB[i];
    errors.push_back({match.stamp_s[i], match.along_m[i], match.X_WB[i], X.translation() - match.X_WB[i].translation(),
                      yaw_pitch_roll(match.X_WB[i].linear().transpose() * X.linear()), X});
  }
  return errors;
}

void add_ate(const MetricList& list, const std::vector<PoseError>& errors, const std::string& why) {
  const size_t n = errors.size();
  std::vector<double> size;
  double all = 0, xy = 0, z = 0, sum = 0, yaw = 0, pitch = 0, roll = 0;
  for (const PoseError& e : errors) {
    size.push_back(e.p_error_W.norm());
    sum += size.back();
    all += e.p_error_W.squaredNorm();
    xy += e.p_error_W.head<2>().squaredNorm();
    z += e.p_error_W.z() * e.p_error_W.z();
    yaw += e.error.yaw_rad * e.error.yaw_rad;
    pitch += e.error.pitch_rad * e.error.pitch_rad;
    roll += e.error.roll_rad * e.error.roll_rad;
  }
  const auto add = [&](const std::string& name, double value, const std::string& unit) {
    list.add(name, value, unit, Better::lower, static_cast<std::int64_t>(n), why);
  };
  add("ate_rmse_m", rms(all, n), "m");
  add("ate_xy_rmse_m", rms(xy, n), "m");
  add("ate_z_rmse_m", rms(z, n), "m");
  add("ate_mean_m", n ? sum / static_cast<double>(n) : none, "m");
  add("ate_median_m", quantile(size, 0.5), "m");
  add("ate_p95_m", quantile(size, 0.95), "m");
  add("ate_max_m", n ? *std::max_element(size.begin(), size.end()) : none, "m");
  add("yaw_rmse_deg", rms(yaw, n) / deg, "deg");
  add("pitch_rmse_deg", rms(pitch, n) / deg, "deg");
  add("roll_rmse_deg", rms(roll, n) / deg, "deg");
}

void add_rpe(const MetricList& list, const PathMatch& match, const std::vector<double>& distances_m,
             const std::string& why) {
  for (const double d : distances_m) {
    double squares = 0, percent = 0, turn = 0;
    std::int64_t pairs = 0;
    size_t j = 0;
    for (size_t i = 0; i < match.size(); ++i) {
      while (j < match.size() && match.along_m[j] - match.along_m[i] < d - rounding_m) ++j;
      if (j == match.size()) break;
      const Pose truth = match.X_WB[i].inverse() * match.X_WB[j], estimate = match.X_MB[i].inverse() * match.X_MB[j];
      const Pose error = truth.inverse() * estimate;
      const double apart = match.along_m[j] - match.along_m[i];
      squares += error.translation().squaredNorm();
      percent += 100 * error.translation().norm() / apart;
      turn += Eigen::AngleAxisd(error.linear()).angle() / deg / apart;
      ++pairs;
    }
    const double count = pairs ? static_cast<double>(pairs) : none;
    const std::string name = "rpe_" + distance_name(d) + "m_";
    const std::string reason =
        !why.empty() ? why : "no two poses lie " + distance_name(d) + " m apart along the true path";
    list.add(name + "m", std::sqrt(squares / count), "m", Better::lower, pairs, reason);
    list.add(name + "percent", percent / count, "percent", Better::lower, pairs, reason);
    list.add(name + "deg_per_m", turn / count, "deg/m", Better::lower, pairs, reason);
  }
}

void add_length(const MetricList& list, const PathMatch& match, const std::string& why) {
  std::vector<double> truth{0}, estimate{0}, along;  // cumulated over the chords
  size_t last = 0;
  for (size_t i = 0; i < match.size(); ++i) {
    if (along.empty()) {
      along.push_back(match.along_m[i]);
    } else if (match.along_m[i] - match.along_m[last] >= 1 - rounding_m) {
      truth.push_back(truth.back() + (match.X_WB[i].translation() - match.X_WB[last].translation()).norm());
      estimate.push_back(estimate.back() + (match.X_MB[i].translation() - match.X_MB[last].translation()).norm());
      along.push_back(match.along_m[i]);
      last = i;
    }
  }
  const auto chords = static_cast<std::int64_t>(truth.size()) - 1;
  const double ratio = chords > 0 ? estimate.back() / truth.back() : none;
  double worst = none;
  for (size_t i = 0, j = 0; i < along.size(); ++i) {
    while (j < along.size() && along[j] - along[i] < 50 - rounding_m) ++j;
    if (j == along.size()) break;
    const double r = (estimate[j] - estimate[i]) / (truth[j] - truth[i]);
    if (!(std::abs(r - 1) <= std::abs(worst - 1))) worst = r;
  }
  const std::string reason = !why.empty() ? why : "the path is too short";
  list.add("length_ratio", ratio, "ratio", Better::higher, chords, reason);
  list.add("length_error_percent", 100 * (ratio - 1), "percent", Better::lower, chords, reason);
  list.add("length_ratio_worst_50m", worst, "ratio", Better::higher, chords, reason);
}

}  // namespace adit
