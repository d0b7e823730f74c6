// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/chance.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

// Eight beams side by side: straight lines of arithmetic that the compiler turns into vectors, each lane with the bits
// that it would have alone.
constexpr size_t lanes = 8;
using Words = std::uint32_t[lanes];
using Numbers = double[lanes];

constexpr double two52 = 4503599627370496.0;

// In (0, 1).
void units(const Words& w, Numbers& u) {
  for (size_t k = 0; k < lanes; ++k) {
    // A double of 2^52 and more has whole numbers in its lowest bits.
    const double whole = std::bit_cast<double>(std::bit_cast<std::uint64_t>(two52) | w[k]) - two52;
    u[k] = (whole + 0.5) * 0x1p-32;
  }
}

// log(u) = e log(2) + log(m), m in [1, 2); log(m / 1.5) = 2 artanh(s), s = (m - 1.5) / (m + 1.5), by its series up to
// s^17: |s| <= 1/5 leaves 1e-14.
void logs(const Numbers& u, Numbers& out) {
  for (size_t k = 0; k < lanes; ++k) {
    const auto bits = std::bit_cast<std::uint64_t>(u[k]);
    const double e = std::bit_cast<double>(std::bit_cast<std::uint64_t>(two52) | (bits >> 52)) - two52 - 1023;
    const double m = std::bit_cast<double>((bits & 0x000FFFFFFFFFFFFFU) | 0x3FF0000000000000U);
    const double s = (m - 1.5) / (m + 1.5), q = s * s;
    double sum = 1.0 / 17;
    for (const double n : {15.0, 13.0, 11.0, 9.0, 7.0, 5.0, 3.0, 1.0}) sum = sum * q + 1 / n;
    constexpr double log_1_5 = 0.405465108108164381978;
    out[k] = e * std::numbers::ln2 + log_1_5 + 2 * s * sum;
  }
}

// x / n to the last bit, n a whole number of at most 9 bits and `inverse` the double nearest to 1 / n: the remainder of
// the product is exact, and x / n never lies half way between two doubles. A processor divides far slower.
// Markstein, "Computation of elementary functions on the IBM RISC System/6000 processor", 1990.
inline double quotient(double x, double n, double inverse) {
  const double rough = x * inverse;
  return std::fma(std::fma(-rough, n, x), inverse, rough);
}

// Sine and cosine of 2 pi v, v in (0, 1), from those of half the angle from -pi / 2 to pi / 2 by Taylor's series.
template <bool with_sine>
void sines(const Numbers& v, Numbers& sine, Numbers& cosine) {
  for (size_t k = 0; k < lanes; ++k) {
    const double x = std::numbers::pi * (v[k] - 0.5), q = x * x;
    double s = 1, c = 1;
    const auto term = [&](double n) {
      const double of_s = n * (n + 1), of_c = n * (n - 1);
      s = 1 - quotient(s * q, of_s, 1 / of_s);
      if (with_sine) c = 1 - quotient(c * q, of_c, 1 / of_c);
    };
    // Written out: the compiler makes no vectors of a loop in a loop.
    term(20), term(18), term(16), term(14), term(12), term(10), term(8), term(6), term(4), term(2);
    s *= x;
    // Half a turn was taken off.
    sine[k] = -2 * s * c;
    cosine[k] = 2 * s * s - 1;
  }
}

// Box and Muller: two normal numbers of two even ones.
template <bool with_angle>
void normals(const Words (&w)[4], Numbers& range, Numbers& angle) {
  Numbers u, v, ln, sine, cosine;
  units(w[0], u);
  units(w[1], v);
  logs(u, ln);
  sines<with_angle>(v, sine, cosine);
  for (size_t k = 0; k < lanes; ++k) {
    const double r = std::sqrt(-2 * ln[k]);
    range[k] = r * cosine[k];
    if (with_angle) angle[k] = r * sine[k];
  }
}

struct Eight {
  Numbers range = {}, angle = {}, detect, drop;

  Eight(const Draws& draws, std::uint64_t scan, std::uint64_t first, Normals normal) {
    Words w[4];
    draws.eight_at(scan, first, w);
    if (normal == Normals::range) normals<false>(w, range, angle);
    if (normal == Normals::both) normals<true>(w, range, angle);
    units(w[2], detect);
    units(w[3], drop);
  }

  // Inlined, so that eight of them are copied as two registers.
  void put(size_t some, Chances& c, size_t at) const {
    std::copy_n(range, some, c.range.data() + at);
    std::copy_n(angle, some, c.angle.data() + at);
    std::copy_n(detect, some, c.detect.data() + at);
    std::copy_n(drop, some, c.drop.data() + at);
  }
};

}  // namespace

void draw_chances(const Draws& draws, std::uint64_t scan, size_t n, Normals normal, Chances& c, size_t at) {
  size_t k = 0;
  for (; k + lanes <= n; k += lanes) Eight(draws, scan, k, normal).put(lanes, c, at + k);
  if (k < n) Eight(draws, scan, k, normal).put(n - k, c, at + k);
}

Chance chance_at(const Draws& draws, std::uint64_t scan, std::uint64_t beam) {
  const Eight e(draws, scan, beam, Normals::both);
  return {e.range[0], e.angle[0], e.detect[0], e.drop[0]};
}

}  // namespace adit
