// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/aim.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>

namespace adit {

// A few beams that leave within one stretch of the path, side by side: plain loops that the compiler turns into vectors.
struct Aim::Batch {
  static constexpr size_t size = 64;
  const double *along[3], *left[3];                                // in B
  alignas(64) double turned_along[3][size], turned_left[3][size];  // the same where the beams err
  alignas(64) double sine[size], versine[size], s[size];
  alignas(64) double p[3][size], d[3][size], l[3][size];  // in W
};

Aim::Aim(const MountFan& fan, const Vec3& p_BS, int interlace) : p_BS_(p_BS) {
  const size_t turns = static_cast<size_t>(interlace);
  for (size_t turn = 0; turn < turns; ++turn)
    for (size_t k = turn; k < fan.along.size(); k += turns) {
      order_.push_back(k);
      offset_s_.push_back(fan.offset_s[k]);
      for (int i = 0; i < 3; ++i) {
        along_[i].push_back(fan.along[k][i]);
        left_[i].push_back(fan.across[k][i]);
      }
    }
}

// The beams as they err in the scan plane.
void Aim::turn(Batch& batch, std::span<const double> error_rad, size_t begin, size_t n) const {
  for (int i = 0; i < 3; ++i) batch.along[i] = along_[i].data() + begin, batch.left[i] = left_[i].data() + begin;
  alignas(64) double error[Batch::size];
  bool errs = false;
  for (size_t k = 0; k < n; ++k) {
    error[k] = error_rad[order_[begin + k]];
    errs = errs || error[k] != 0;
  }
  if (!errs) return;
  // The same few terms as for a stretch; an error beyond 5 degrees is refused by the settings, ten sigma are not drawn.
  for (size_t k = 0; k < n; ++k) {
    const double e = error[k], q = e * e;
    const double s = e * (1 - q * (1.0 / 6) * (1 - q * (1.0 / 20) * (1 - q * (1.0 / 42) * (1 - q * (1.0 / 72)))));
    const double v =
        q * 0.5 * (1 - q * (1.0 / 12) * (1 - q * (1.0 / 30) * (1 - q * (1.0 / 56) * (1 - q * (1.0 / 90)))));
    for (int i = 0; i < 3; ++i) {
      const double a = batch.along[i][k], b = batch.left[i][k];
      batch.turned_along[i][k] = (1 - v) * a + s * b;
      batch.turned_left[i][k] = (1 - v) * b - s * a;
    }
  }
  for (int i = 0; i < 3; ++i) batch.along[i] = batch.turned_along[i], batch.left[i] = batch.turned_left[i];
}

void Aim::carry(Batch& b, const Stretch& it, double time_s, size_t begin, size_t n, bool with_left) const {
  const double from_s = it.from_s, span_s = it.span_s, whole = it.angle_rad;
  const double* offset_s = offset_s_.data() + begin;
  for (size_t k = 0; k < n; ++k) {
    const double s = (time_s + offset_s[k] - from_s) / span_s, after = s > 0 ? s : 0;
    b.s[k] = after < 1 ? after : 1;
    const Turned t = turned(b.s[k] * whole);
    b.sine[k] = t.sine;
    b.versine[k] = t.versine;
  }
  if (!it.turns_little())
    for (size_t k = 0; k < n; ++k) {
      b.sine[k] = std::sin(b.s[k] * whole);
      b.versine[k] = 1 - std::cos(b.s[k] * whole);
    }
  const double *ax = b.along[0], *ay = b.along[1], *az = b.along[2];
  const double *lx = b.left[0], *ly = b.left[1], *lz = b.left[2];
  const double px = p_BS_.x(), py = p_BS_.y(), pz = p_BS_.z();
  for (int i = 0; i < 3; ++i) {
    double R[3], RK[3], RKK[3];
    for (int j = 0; j < 3; ++j) R[j] = it.R(i, j), RK[j] = it.RK(i, j), RKK[j] = it.RKK(i, j);
    const double from = it.from[i], to = it.to[i];
    const auto row = [&](size_t k, int j) { return R[j] + b.sine[k] * RK[j] + b.versine[k] * RKK[j]; };
    for (size_t k = 0; k < n; ++k) {
      const double x = row(k, 0), y = row(k, 1), z = row(k, 2), s = b.s[k];
      b.p[i][k] = x * px + y * py + z * pz + ((1 - s) * from + s * to);
      b.d[i][k] = x * ax[k] + y * ay[k] + z * az[k];
    }
    if (!with_left) continue;
    for (size_t k = 0; k < n; ++k) b.l[i][k] = row(k, 0) * lx[k] + row(k, 1) * ly[k] + row(k, 2) * lz[k];
  }
}

void Aim::rays(double time_s, std::span<const double> error_rad, Motion& motion, RayColumns<double>& rays,
               const Places& places, Directions* left) const {
  ADIT_CHECK(error_rad.size() == beams());
  Batch b;
  for (size_t begin = 0; begin < beams();) {
    const Stretch& stretch = motion.stretch_at(time_s + offset_s_[begin]);
    const double to_s = stretch.to_s();
    size_t n = 1;
    while (n < Batch::size && begin + n < beams() && time_s + offset_s_[begin + n] <= to_s) ++n;
    turn(b, error_rad, begin, n);
    carry(b, stretch, time_s, begin, n, left != nullptr);
    for (size_t k = 0; k < n; ++k) {
      const size_t to = places[order_[begin + k]];
      rays.x[to] = b.p[0][k], rays.y[to] = b.p[1][k], rays.z[to] = b.p[2][k];
      rays.dx[to] = b.d[0][k], rays.dy[to] = b.d[1][k], rays.dz[to] = b.d[2][k];
    }
    if (left)
      for (size_t k = 0; k < n; ++k) {
        const size_t to = places[order_[begin + k]];
        left->x[to] = b.l[0][k], left->y[to] = b.l[1][k], left->z[to] = b.l[2][k];
      }
    begin += n;
  }
}

}  // namespace adit
