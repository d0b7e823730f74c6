// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/rematch.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <numbers>

namespace adit {
namespace {

// Every so many metres of the way one scan, and each scan's last one before it.
struct Keys {
  std::vector<size_t> scan;        // (keys) index of the scan
  std::vector<size_t> first_scan;  // (keys + 1) the scans from one key up to the next
};

Keys keys_along(const std::vector<Pose2>& X_MB, double step_m) {
  Keys keys;
  double since_m = step_m;
  for (size_t i = 0; i < X_MB.size(); ++i) {
    if (i > 0)
      since_m += (X_MB[i].position() - X_MB[i - 1].position()).norm() +
                 0.5 * std::abs(wrap_angle(X_MB[i].yaw_rad - X_MB[i - 1].yaw_rad));
    if (since_m < step_m) continue;
    keys.scan.push_back(i), keys.first_scan.push_back(i);
    since_m = 0;
  }
  keys.first_scan.push_back(X_MB.size());
  return keys;
}

// The keys nearest to a place, in the order of time.
std::vector<size_t> keys_around(const Vec2& p, const Keys& keys, const std::vector<Pose2>& X_MB,
                                const RematchSettings& s) {
  std::vector<std::pair<double, size_t>> near;
  for (const size_t i : keys.scan) {
    const double d = (X_MB[i].position() - p).norm();
    if (d <= s.reach_m) near.emplace_back(d, i);
  }
  std::sort(near.begin(), near.end());
  if (near.size() > static_cast<size_t>(s.key_scans)) near.resize(s.key_scans);
  std::vector<size_t> out;
  for (const auto& [d, i] : near) out.push_back(i);
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

Fields fields(RematchSettings& s) {
  return {{"prior_sigma_m", &s.prior_sigma_m, "how far an aligned pose may be moved, 1 sd", 1e-4, 10},
          {"prior_sigma_deg", &s.prior_sigma_deg, "how far an aligned pose may be turned, 1 sd", 1e-3, 90},
          {"key_step_m", &s.key_step_m, "way between the scans of which maps are made", 0.01, 10},
          {"key_scans", &s.key_scans, "most scans in one map", 2, 1000},
          {"reach_m", &s.reach_m, "they lie within", 0.5, 100}};
}

std::vector<Pose2> rematch(const std::vector<ScanPoints>& scans, const std::vector<Pose2>& X_MB,
                           const RematchSettings& settings, const MatchSettings& match, const Progress& progress) {
  ADIT_CHECK(scans.size() == X_MB.size());
  const Keys keys = keys_along(X_MB, settings.key_step_m);
  const double m = settings.prior_sigma_m, rad = settings.prior_sigma_deg * std::numbers::pi / 180;
  const Eigen::Matrix3d sure = Vec3(1 / (m * m), 1 / (m * m), 1 / (rad * rad)).asDiagonal();
  std::vector<Pose2> out = X_MB;
  parallel_for(keys.scan.size(), [&](size_t k) {
    std::vector<const ScanPoints*> around;
    std::vector<Pose2> poses;
    for (const size_t i : keys_around(X_MB[keys.scan[k]].position(), keys, X_MB, settings))
      if (i != keys.scan[k]) around.push_back(&scans[i]), poses.push_back(X_MB[i]);
    const LocalMap map(around, poses);
    for (size_t i = keys.first_scan[k]; i < keys.first_scan[k + 1]; ++i) {
      const Match placed = match_scan(scans[i], map, X_MB[i], match, PosePrior{X_MB[i], sure});
      if (placed.converged) out[i] = placed.X_AB;
    }
  });
  progress("match scans to the aligned map", 1, 1);
  return out;
}

}  // namespace adit
