// SPDX-License-Identifier: BSD-3-Clause
#include "sim/struggle.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr int tries_max = 3;
constexpr double here_m = 1;                        // nearer than that it is the same place
constexpr double back_m = 0.4, back_more_m = 0.25;  // by which it is taken back, and more at each further try
constexpr double back_mps = 0.4, accelerate_mps2 = 0.8;
constexpr double past_m = 0.15;  // so far beyond the place it is free
constexpr double back_s = 6, on_s = 5;
constexpr double tightest = 1.2;  // 1/m, of the way back

}  // namespace

bool Struggle::again(double t_s, double along_m, const Motion& motion, bool against_rock, double walk_mps,
                     double run_mps) {
  if (along_m > first_m_ + here_m) tries_ = 0;
  if (tries_ == tries_max) return false;
  if (tries_ == 0) first_m_ = along_m;
  along_m_ = along_m;
  place_ = motion.X_WB.translation().head<2>();
  back_m_ = back_m + back_more_m * tries_++;
  walk_mps_ = walk_mps;
  on_mps_ = against_rock ? std::min(walk_mps, back_mps) : run_mps;
  phase_ = Phase::back;
  since_s_ = t_s;
  speed_mps_ = 0;
  return true;
}

std::optional<Intent> Struggle::want(double t_s, double step_s, double along_m, const Guide& guide,
                                     const Motion& motion) {
  if (phase_ == Phase::none) return std::nullopt;
  const double gone_m = (motion.X_WB.translation().head<2>() - place_).norm();
  if (phase_ == Phase::back && (gone_m >= back_m_ || t_s - since_s_ > back_s))
    phase_ = Phase::on, since_s_ = t_s, speed_mps_ = 0;
  if (phase_ == Phase::on && (along_m > along_m_ + past_m || t_s - since_s_ > on_s)) {
    phase_ = Phase::none;
    return std::nullopt;
  }
  const bool back = phase_ == Phase::back;
  speed_mps_ = std::min(speed_mps_ + accelerate_mps2 * step_s, back ? std::min(walk_mps_, back_mps) : on_mps_);
  Intent intent;
  intent.hold = false;
  intent.speed_mps = back == guide.backward ? speed_mps_ : -speed_mps_;
  return intent;
}

// On the way back it goes on turning the way that the route asks for.
double Struggle::curvature(double asked) const {
  return phase_ == Phase::back ? -std::clamp(asked, -tightest, tightest) : asked;
}

}  // namespace adit
