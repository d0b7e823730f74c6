// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/spline.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

/// Index k with stamp[k] <= t < stamp[k + 1], held within the stamps.
size_t span_of(const std::vector<double>& stamp_s, double t_s) {
  const auto next = std::upper_bound(stamp_s.begin(), stamp_s.end(), t_s);
  const auto k = static_cast<size_t>(next - stamp_s.begin());
  return std::clamp<size_t>(k, 1, stamp_s.size() - 1) - 1;
}

}  // namespace

KnotClock::KnotClock(std::vector<double> stamp_s, const std::vector<bool>& moving, double knot_s, double rest_knot_s)
    : stamp_s_(std::move(stamp_s)), knot_(stamp_s_.size(), 0.0) {
  ADIT_CHECK(stamp_s_.size() >= 2 && moving.size() == stamp_s_.size());
  for (size_t k = 1; k < stamp_s_.size(); ++k)
    knot_[k] = knot_[k - 1] + (stamp_s_[k] - stamp_s_[k - 1]) / (moving[k - 1] ? knot_s : rest_knot_s);
  controls_ = static_cast<int>(std::floor(knot_.back())) + 4;
}

SplineWeights KnotClock::at(double t_s) const {
  const double t = std::clamp(t_s, stamp_s_.front(), stamp_s_.back());
  const size_t k = span_of(stamp_s_, t);
  const double share = (t - stamp_s_[k]) / (stamp_s_[k + 1] - stamp_s_[k]);
  const double u = knot_[k] + share * (knot_[k + 1] - knot_[k]);
  const int first = std::min(static_cast<int>(std::floor(u)), controls_ - 4);
  const double f = u - first, g = 1 - f;
  return {first,
          {g * g * g / 6, (3 * f * f * f - 6 * f * f + 4) / 6, (3 * g * g * g - 6 * g * g + 4) / 6, f * f * f / 6}};
}

PlanarMotion::PlanarMotion(std::vector<double> stamp_s, std::vector<Pose2> pose) : stamp_s_(std::move(stamp_s)) {
  ADIT_CHECK(stamp_s_.size() >= 2 && stamp_s_.size() == pose.size());
  for (const Pose2& X : pose) {
    const double before = value_.empty() ? X.yaw_rad : value_.back().z();
    value_.emplace_back(X.x_m, X.y_m, before + wrap_angle(X.yaw_rad - before));
  }
  const size_t n = value_.size();
  for (size_t k = 0; k < n; ++k) {
    const size_t a = k > 0 ? k - 1 : 0, b = std::min(k + 1, n - 1);
    slope_.push_back((value_[b] - value_[a]) / (stamp_s_[b] - stamp_s_[a]));
  }
}

Pose2 PlanarMotion::at(double t_s) const {
  const double t = std::clamp(t_s, stamp_s_.front(), stamp_s_.back());
  const size_t k = span_of(stamp_s_, t);
  const double span = stamp_s_[k + 1] - stamp_s_[k], s = (t - stamp_s_[k]) / span, r = 1 - s;
  const Vec3 v = r * r * (1 + 2 * s) * value_[k] + s * s * (1 + 2 * r) * value_[k + 1] +
                 span * (r * r * s * slope_[k] - s * s * r * slope_[k + 1]);
  return {v.x(), v.y(), wrap_angle(v.z())};
}

bool PlanarMotion::moves(size_t stamp) const {
  constexpr double window_s = 0.5, way_m = 0.03, turn_rad = std::numbers::pi / 180;
  const auto away = [&](size_t k) {
    const Vec3 d = value_[k] - value_[stamp];
    return d.head<2>().norm() > way_m || std::abs(d.z()) > turn_rad;
  };
  for (size_t k = stamp; k < value_.size() && stamp_s_[k] <= stamp_s_[stamp] + window_s; ++k)
    if (away(k)) return true;
  for (size_t k = stamp + 1; k-- > 0 && stamp_s_[k] >= stamp_s_[stamp] - window_s;)
    if (away(k)) return true;
  return false;
}

}  // namespace adit
