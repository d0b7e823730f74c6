// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/rng.h"

#include <cstdint>
#include <vector>

namespace adit {

/// A stationary, isotropic random field of zero mean as a sum of plane waves. Its spectrum is flat below 1 /
/// correlation_m and falls so that profiles are self-affine with the given Hurst exponent above (von Karman). The same
/// address gives the same field at any resolution: waves shorter than twice the mesh's edge are left out, the rest
/// stays. Sampling: Shinozuka, Deodatis, "Simulation of stochastic processes by spectral representation", Appl. Mech.
/// Rev. 1991.
class Waves {
 public:
  struct Spectrum {
    double rms, correlation_m;
    double hurst = 0.7;
    double shortest_m = 0;  // waves shorter than this are left out
    int waves = 96;
    double bound = 3;  // values are held within +-bound * rms
  };
  /// Fields of one draw are told apart by `which`. With `flat` the field depends on x and y alone.
  Waves(const Spectrum& spectrum, std::uint64_t seed, Draw draw, std::uint64_t which, bool flat);

  double operator()(const Vec3& p) const;
  double operator()(const Vec2& p) const { return (*this)(Vec3(p.x(), p.y(), 0)); }

 private:
  struct Wave {
    Vec3 k;  // rad/m
    double phase;
  };
  std::vector<Wave> waves_;
  double amplitude_, bound_;
};

}  // namespace adit
