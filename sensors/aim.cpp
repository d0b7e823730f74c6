// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/aim.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace adit {

// A few beams that leave within one stretch of the path, side by side: plain loops that the compiler turns into vectors.
struct Aim::Batch {
  static constexpr size_t size = 64;
  alignas(64) double time_s[size], error[size];
  alignas(64) double along[3][size], left[3][size];  // in B; then turned by the error
  alignas(64) double sine[size], versine[size], s[size];
  alignas(64) double p[3][size], d[3][size], l[3][size];  // in W
};

Aim::Aim(const MountFan& fan, const Vec3& p_BS, int interlace) : p_BS_(p_BS) {
  const size_t turns = static_cast<size_t>(interlace);
  for (size_t turn = 0; turn < turns; ++turn)
    for (size_t k = turn; k < fan.along.size(); k += turns) {
      order_.push_back(k);
      offset_s_.push_back(fan.offset_s[k]);
      along_.push_back(fan.along[k]);
      left_.push_back(fan.across[k]);
    }
}

void Aim::fill(Batch& batch, double time_s, std::span<const double> error_rad, size_t begin, size_t n) const {
  for (size_t k = 0; k < n; ++k) {
    batch.time_s[k] = time_s + offset_s_[begin + k];
    batch.error[k] = error_rad[order_[begin + k]];
    for (int i = 0; i < 3; ++i) {
      batch.along[i][k] = along_[begin + k][i];
      batch.left[i][k] = left_[begin + k][i];
    }
  }
  if (std::all_of(batch.error, batch.error + n, [](double e) { return e == 0; })) return;
  // The same few terms as for a stretch; an error beyond 5 degrees is refused by the settings, ten sigma are not drawn.
  for (size_t k = 0; k < n; ++k) {
    const double e = batch.error[k], q = e * e;
    const double s = e * (1 - q * (1.0 / 6) * (1 - q * (1.0 / 20) * (1 - q * (1.0 / 42) * (1 - q * (1.0 / 72)))));
    const double v =
        q * 0.5 * (1 - q * (1.0 / 12) * (1 - q * (1.0 / 30) * (1 - q * (1.0 / 56) * (1 - q * (1.0 / 90)))));
    for (int i = 0; i < 3; ++i) {
      const double a = batch.along[i][k], b = batch.left[i][k];
      batch.along[i][k] = (1 - v) * a + s * b;
      batch.left[i][k] = (1 - v) * b - s * a;
    }
  }
}

void Aim::carry(Batch& b, const Stretch& it, size_t n) const {
  const double from_s = it.from_s, span_s = it.span_s, whole = it.angle_rad;
  for (size_t k = 0; k < n; ++k) {
    b.s[k] = std::min(std::max((b.time_s[k] - from_s) / span_s, 0.0), 1.0);
    const Turned t = turned(b.s[k] * whole);
    b.sine[k] = t.sine;
    b.versine[k] = t.versine;
  }
  if (!it.turns_little())
    for (size_t k = 0; k < n; ++k) {
      b.sine[k] = std::sin(b.s[k] * whole);
      b.versine[k] = 1 - std::cos(b.s[k] * whole);
    }
  for (int i = 0; i < 3; ++i) {
    double R[3], RK[3], RKK[3];
    for (int j = 0; j < 3; ++j) R[j] = it.R(i, j), RK[j] = it.RK(i, j), RKK[j] = it.RKK(i, j);
    const double from = it.from[i], to = it.to[i], px = p_BS_.x(), py = p_BS_.y(), pz = p_BS_.z();
    for (size_t k = 0; k < n; ++k) {
      const double sine = b.sine[k], versine = b.versine[k], s = b.s[k];
      const double x = R[0] + sine * RK[0] + versine * RKK[0], y = R[1] + sine * RK[1] + versine * RKK[1],
                   z = R[2] + sine * RK[2] + versine * RKK[2];
      b.p[i][k] = x * px + y * py + z * pz + ((1 - s) * from + s * to);
      b.d[i][k] = x * b.along[0][k] + y * b.along[1][k] + z * b.along[2][k];
      b.l[i][k] = x * b.left[0][k] + y * b.left[1][k] + z * b.left[2][k];
    }
  }
}

void Aim::rays(double time_s, std::span<const double> error_rad, Motion& motion, RayColumns<double>& rays, size_t at,
               Directions* left) const {
  ADIT_CHECK(error_rad.size() == beams());
  Batch b;
  for (size_t begin = 0; begin < beams();) {
    const Stretch& stretch = motion.stretch_at(time_s + offset_s_[begin]);
    size_t n = 1;
    while (n < Batch::size && begin + n < beams() && time_s + offset_s_[begin + n] <= stretch.to_s()) ++n;
    fill(b, time_s, error_rad, begin, n);
    carry(b, stretch, n);
    for (size_t k = 0; k < n; ++k) {
      const size_t to = at + order_[begin + k];
      rays.x[to] = b.p[0][k], rays.y[to] = b.p[1][k], rays.z[to] = b.p[2][k];
      rays.dx[to] = b.d[0][k], rays.dy[to] = b.d[1][k], rays.dz[to] = b.d[2][k];
      if (left) left->x[to] = b.l[0][k], left->y[to] = b.l[1][k], left->z[to] = b.l[2][k];
    }
    begin += n;
  }
}

}  // namespace adit
