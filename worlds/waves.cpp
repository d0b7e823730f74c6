// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/waves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;

Vec3 direction(double u, double v, bool flat) {
  if (flat) return {std::cos(2 * pi * v), std::sin(2 * pi * v), 0};
  const double z = 2 * u - 1, r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(2 * pi * v), r * std::sin(2 * pi * v), z};
}

}  // namespace

Waves::Waves(const Spectrum& s, std::uint64_t seed, Draw draw, std::uint64_t which, bool flat)
    : amplitude_(s.rms * std::sqrt(2.0 / s.waves)), bound_(s.bound * s.rms) {
  const double k_max = s.shortest_m > 0 ? 2 * pi / s.shortest_m : 1e9;
  for (int i = 0; i < s.waves; ++i) {
    const std::uint64_t at = which << 32 | static_cast<std::uint64_t>(i);
    // One wave for each equal share of the variance: the share of waves below k is 1 - (1 + (k l)^2)^-H.
    const double share = (i + uniform(seed, draw, at, 0)) / s.waves;
    const double k = std::sqrt(std::pow(1 - share, -1 / s.hurst) - 1) / s.correlation_m;
    if (k > k_max) continue;
    waves_.push_back({k * direction(uniform(seed, draw, at, 1), uniform(seed, draw, at, 2), flat),
                      2 * pi * uniform(seed, draw, at, 3)});
  }
}

double Waves::operator()(const Vec3& p) const {
  double sum = 0;
  for (const Wave& w : waves_) sum += std::cos(w.k.dot(p) + w.phase);
  return std::clamp(amplitude_ * sum, -bound_, bound_);
}

}  // namespace adit
