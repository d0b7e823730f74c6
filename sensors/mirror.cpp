// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/mirror.h"

#include <cmath>
#include <numbers>

namespace adit {

double water_reflectance(double cosine) {
  constexpr double n = 1.33;
  const double c = std::abs(cosine), sine2 = (1 - c * c) / (n * n), t = std::sqrt(1 - sine2);
  const double across = (c - n * t) / (c + n * t), along = (t - n * c) / (t + n * c);
  return (across * across + along * along) / 2;
}

std::optional<Label> water_label() {
  const auto found = label_ids().find("water");
  if (found == label_ids().end()) return std::nullopt;
  return static_cast<Label>(found->second);
}

Meeting seen_in_water(const Caster& caster, const Ray& ray, const Meeting& met, double default_reflectivity) {
  static const double steep = std::cos(15 * std::numbers::pi / 180);
  if (met.cosine > steep) return met;
  const Vec3 normal = caster.mesh().normal(static_cast<size_t>(met.face));
  const Vec3 up = (ray.direction - 2 * ray.direction.dot(normal) * normal).normalized();
  // A little before the surface, or the mirrored ray would meet the water again.
  const Vec3 from = ray.origin + (met.range_m - 1e-4) * ray.direction;
  const Meeting beyond = meeting_of(caster.mesh(), caster.nearest(Ray{from, up}), default_reflectivity);
  const double share = water_reflectance(met.cosine);
  Meeting seen = met;
  seen.range_m = met.range_m + beyond.range_m;
  seen.reflectivity = beyond.reflectivity * share * share;
  seen.cosine = beyond.cosine;
  return seen;
}

}  // namespace adit
