// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int roll_count = 12;

Waves rough(const RoughnessSettings& r, double edge_m, std::uint64_t seed, std::uint64_t which, bool flat) {
  return {{r.rms_m, r.correlation_m, 0.7, 2 * edge_m}, seed, Draw::world_roughness, which, flat};
}

}  // namespace

Terrain::Terrain(const WorldSettings& s, const Vec2& middle, std::uint64_t seed)
    : mean_height_(s.height_m),
      roll_amplitude_(s.roll_m * std::sqrt(2.0 / roll_count)),
      mean_reflectivity_(s.reflectivity),
      middle_(middle),
      height_({s.height_sd_m, s.height_length_m / 4, 1.5, 5, 48, 2.5}, seed, Draw::world_height, 0, true),
      floor_(rough(s.floor, s.mesh_edge_m, seed, 0, true)),
      roof_(rough(s.roof, s.mesh_edge_m, seed, 1, true)),
      rib_(rough(s.rib, s.mesh_edge_m, seed, 2, false)),
      patches_({s.reflectivity_sd, 1.5, 0.7, 0.4, 48, 2.5}, seed, Draw::world_material, 0, false) {
  const double dip = 2 * pi * uniform(seed, Draw::world_roll, 0);
  grade_ = 0.01 * s.grade_percent * Vec2(std::cos(dip), std::sin(dip));
  const double shortest = std::min(s.roll_min_m, s.roll_max_m), longest = std::max(s.roll_min_m, s.roll_max_m);
  for (int i = 0; i < roll_count; ++i) {
    const double share = (i + uniform(seed, Draw::world_roll, 1, i)) / roll_count;
    const double k = 2 * pi / (shortest * std::pow(longest / shortest, share));
    const double angle = 2 * pi * uniform(seed, Draw::world_roll, 2, i);
    rolls_.push_back({k * Vec2(std::cos(angle), std::sin(angle)), 2 * pi * uniform(seed, Draw::world_roll, 3, i)});
  }
}

double Terrain::seam_z(const Vec2& p) const {
  const Vec2 q = p - middle_;
  double z = grade_.dot(q);
  for (const Roll& r : rolls_) z += roll_amplitude_ * std::cos(r.k.dot(q) + r.phase);
  return z;
}

double Terrain::height_m(const Vec2& p) const {
  return mean_height_ + height_(p);
}
double Terrain::floor_z(const Vec2& p) const {
  return seam_z(p) + floor_(p);
}
double Terrain::roof_z(const Vec2& p) const {
  return seam_z(p) + height_m(p) + roof_(p);
}

float Terrain::reflectivity(const Vec3& p) const {
  return static_cast<float>(std::clamp(mean_reflectivity_ + patches_(p), 0.02, 1.0));
}

}  // namespace adit
