// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/echo.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace adit {

Bundle make_bundle(int rays) {
  int rings = 0;
  while (1 + 3 * rings * (rings + 1) < rays) ++rings;
  if (rays < 1 || 1 + 3 * rings * (rings + 1) != rays)
    throw Error("sensors.sub_rays = " + std::to_string(rays) + ": must be 1, 7, 19 or 37 (an axis and rings about it)");
  Bundle bundle;
  double sum = 0;
  for (int ring = 0; ring <= rings; ++ring) {
    // Every ray stands for the same area of the disc; the power falls to a half at its rim.
    const double inner = ring == 0 ? 0 : 1 + 3 * ring * (ring - 1), outer = 1 + 3 * ring * (ring + 1);
    const double radius = ring == 0 ? 0 : std::sqrt((inner + outer) / 2 / rays);
    for (int k = 0; k < std::max(1, 6 * ring); ++k) {
      const double a = 2 * std::numbers::pi * (k + 0.5 * (ring % 2)) / std::max(1, 6 * ring);
      bundle.place.emplace_back(radius * std::cos(a), radius * std::sin(a));
      bundle.weight.push_back(std::exp2(-radius * radius));
      sum += bundle.weight.back();
    }
  }
  for (double& w : bundle.weight) w /= sum;
  return bundle;
}

bool Threshold::passes(double margin) const {
  if (always || std::isinf(margin)) return true;
  if (!(margin > 0)) return false;
  // P = 1 / (1 + margin^(-1 / spread)) > chance; most echoes are far from the threshold.
  const double x = std::log(margin) / spread;
  if (x > 24) return true;  // a chance of 32 bits is never so near to 1
  return 1 / (1 + std::exp(-x)) > chance;
}

namespace {

constexpr double gap_m = 0.15;  // between two surfaces rather than along a slanting one

struct Sum {
  double power = 0, range = 0, square = 0;
};

// Power falls with the square of the range; it is told as at the front of the pulse.
void add(Sum& sum, const Return& r, double front_m) {
  const double fall = front_m / r.range_m, p = r.power * fall * fall;
  const double behind = r.range_m - front_m;
  sum.power += p;
  sum.range += p * behind;
  sum.square += p * behind * behind;
}

void take(Echo& echo, const Sum& sum, double front_m, double margin) {
  const double mean = sum.range / sum.power;
  echo.noticed = true;
  echo.range_m = front_m + mean;
  echo.effective_reflectivity = sum.power;
  echo.margin = margin;
  echo.spread_m = std::sqrt(std::max(0.0, sum.square / sum.power - mean * mean));
}

int surfaces_of(std::span<const Return> sorted) {
  int n = sorted.empty() ? 0 : 1;
  for (size_t i = 1; i < sorted.size(); ++i) n += sorted[i].range_m - sorted[i - 1].range_m > gap_m;
  return n;
}

}  // namespace

namespace {

// The returns as one surface tells them; nothing where they are of more, or some of them is missing.
bool one_surface(std::span<const Return> returns, double& front_m) {
  double back_m = front_m = returns.empty() ? 0 : returns[0].range_m;
  bool all = !returns.empty();
  for (const Return& r : returns) {
    front_m = std::min(front_m, r.range_m);
    back_m = std::max(back_m, r.range_m);
    all = all && r.power > 0;
  }
  return all && back_m - front_m <= gap_m;
}

}  // namespace

Echo first_echo(std::span<Return> returns, const Threshold& threshold, double pulse_m) {
  Echo echo;
  if (double front_m = 0; pulse_m >= gap_m && one_surface(returns, front_m)) {
    // Most spots: nothing to sort, and what does not pass as a whole does not pass in parts.
    Sum sum;
    for (const Return& r : returns) add(sum, r, front_m);
    echo.surfaces = 1;
    echo.margin = threshold.margin(sum.power, front_m);
    if (threshold.passes(echo.margin)) take(echo, sum, front_m, echo.margin);
    return echo;
  }
  const auto end = std::partition(returns.begin(), returns.end(),
                                  [](const Return& r) { return std::isfinite(r.range_m) && r.power > 0; });
  const std::span<Return> got(returns.begin(), end);
  if (got.empty()) return echo;
  std::sort(got.begin(), got.end(), [](const Return& a, const Return& b) { return a.range_m < b.range_m; });
  echo.surfaces = surfaces_of(got);
  for (size_t first = 0; first < got.size() && !echo.noticed; ++first) {
    const double front_m = got[first].range_m;
    Sum sum;
    for (size_t i = first; i < got.size() && got[i].range_m <= front_m + pulse_m; ++i) add(sum, got[i], front_m);
    const double margin = threshold.margin(sum.power, front_m);
    if (threshold.passes(margin))
      take(echo, sum, front_m, margin);
    else
      echo.margin = std::max(echo.margin, margin);
  }
  return echo;
}

}  // namespace adit
