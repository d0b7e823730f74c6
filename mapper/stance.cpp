// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/stance.h"

#include "base/parallel.h"

#include <algorithm>

namespace adit {
namespace {

struct Standing {
  Eigen::Matrix3d R_BS;
  double z_m;
};

Standing standing(const Pose& X_MB, const Mount& horizontal) {
  const Pose X_MS = X_MB * horizontal.X_BS;
  const double turn = flatten(horizontal.X_BS).yaw_rad - flatten(X_MS).yaw_rad;
  return {Eigen::AngleAxisd(turn, Vec3::UnitZ()).toRotationMatrix() * X_MS.linear(), X_MS.translation().z()};
}

}  // namespace

std::vector<Stance> stances_along(const Trajectory& X_MB, const std::vector<double>& stamp_s, const Mount& horizontal,
                                  double scan_s) {
  constexpr double least_s = 0.005;  // a laser whose beams all leave at once moves all the same
  scan_s = std::max(scan_s, least_s);
  std::vector<Stance> out(stamp_s.size());
  parallel_for(
      stamp_s.size(),
      [&](size_t i) {
        const Standing first = standing(X_MB.at(stamp_s[i]), horizontal);
        const Standing last = standing(X_MB.at(stamp_s[i] + scan_s), horizontal);
        out[i] = {first.R_BS, (last.R_BS - first.R_BS) / scan_s, first.z_m, (last.z_m - first.z_m) / scan_s};
      },
      256);
  return out;
}

}  // namespace adit
