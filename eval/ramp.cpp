// SPDX-License-Identifier: BSD-3-Clause
#include "eval/ramp.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace adit {

namespace {

using Lab = std::array<double, 3>;  // L, a, b

// Msh of Moreland: magnitude, saturation angle, hue angle; polar Lab.
Lab lab_of_msh(double m, double s, double h) {
  return {m * std::cos(s), m * std::sin(s) * std::cos(h), m * std::sin(s) * std::sin(h)};
}

double channel(double linear) {
  const double v = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return std::clamp(255 * v, 0.0, 255.0);
}

Colour colour_of(const Lab& lab) {
  const auto f = [](double t) { return t > 6.0 / 29 ? t * t * t : 3 * 36.0 / 841 * (t - 4.0 / 29); };
  const double fy = (lab[0] + 16) / 116;
  const double x = 0.95047 * f(fy + lab[1] / 500), y = f(fy), z = 1.08883 * f(fy - lab[2] / 200);
  const double r = 3.2406 * x - 1.5372 * y - 0.4986 * z, g = -0.9689 * x + 1.8758 * y + 0.0415 * z,
               b = 0.0557 * x - 0.2040 * y + 1.0570 * z;
  return {static_cast<std::uint8_t>(std::lround(channel(r))), static_cast<std::uint8_t>(std::lround(channel(g))),
          static_cast<std::uint8_t>(std::lround(channel(b))), 255};
}

// s in [0, 1]. The ends are sRGB (59, 76, 192) and (180, 4, 38) in Msh; the middle is unsaturated at M = 88.
Colour diverging(double s) {
  constexpr double m = 80, saturation = 1.08, cool_hue = -1.1, warm_hue = 0.5, white = 88;
  const double hue_spin = saturation * std::sqrt(white * white - m * m) / (m * std::sin(saturation));
  const bool cool = s < 0.5;
  const double t = cool ? 2 * s : 2 - 2 * s;  // 0 at an end, 1 in the middle
  const double hue = cool ? cool_hue : warm_hue, hue_white = cool ? cool_hue - hue_spin : warm_hue + hue_spin;
  return colour_of(lab_of_msh(m + t * (white - m), saturation * (1 - t), hue + t * (hue_white - hue)));
}

// Knots of ColorBrewer's YlOrBr at even steps, without its palest.
Colour sequential(double s) {
  constexpr std::array<std::uint32_t, 8> knot = {0xFFF7BC, 0xFEE391, 0xFEC44F, 0xFE9929,
                                                 0xEC7014, 0xCC4C02, 0x993404, 0x662506};
  const double at = std::clamp(s, 0.0, 1.0) * (knot.size() - 1);
  const auto k = std::min<size_t>(static_cast<size_t>(at), knot.size() - 2);
  return mix(rgb(knot[k]), rgb(knot[k + 1]), at - static_cast<double>(k));
}

constexpr int steps = 1024;

const std::array<Colour, steps + 1>& table(Ramp::Kind kind) {
  const auto make = [](Colour (*of)(double)) {
    std::array<Colour, steps + 1> colours;
    for (int k = 0; k <= steps; ++k) colours[k] = of(static_cast<double>(k) / steps);
    return colours;
  };
  static const auto both = std::array{make(diverging), make(sequential)};
  return both[kind == Ramp::Kind::diverging ? 0 : 1];
}

}  // namespace

Colour Ramp::colour(double value) const {
  const double s = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return std::isnan(s) ? rgb(0x808080) : table(kind)[static_cast<size_t>(std::lround(s * steps))];
}

double Ramp::value(Colour colour) const {
  const auto& colours = table(kind);
  const auto distance = [&](const Colour& c) {
    const int r = c.r - colour.r, g = c.g - colour.g, b = c.b - colour.b;
    return r * r + g * g + b * b;
  };
  // The middle of the stretch of equally near colours.
  int first = 0, last = 0;
  for (int k = 1; k <= steps; ++k) {
    const int here = distance(colours[k]), best = distance(colours[first]);
    if (here < best) first = last = k;
    if (here == best) last = k;
  }
  return low + (high - low) * (first + last) / 2.0 / steps;
}

double round_down_125(double value) {
  const double decade = std::pow(10, std::floor(std::log10(value) + 1e-9));
  for (const double step : {5.0, 2.0})
    if (step * decade <= value * (1 + 1e-9)) return step * decade;
  return decade;
}

double round_range(std::vector<double> values, double q, double least, double most) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return least;
  for (double& v : values) v = std::abs(v);
  const auto k = static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + k, values.end());
  const double wanted = std::clamp(values[k], least, most);
  const double below = round_down_125(wanted);
  for (const double factor : {1.0, 2.0, 2.5, 5.0, 10.0}) {
    const double next = below * factor;
    if (next >= wanted * (1 - 1e-9) && std::abs(round_down_125(next) - next) < 1e-9 * next) return std::min(next, most);
  }
  return most;
}

}  // namespace adit
