// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/hull.h"
#include "base/mesh.h"
#include "base/rig.h"
#include "rays/caster.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace adit {

/// What one beam truly met.
struct Meeting {
  double range_m = std::numeric_limits<double>::infinity();  // +inf: nothing
  double cosine = 1;                                         // of the incidence, between beam and surface normal
  double reflectivity = 0;
  Label label = Label::none;
  std::int32_t part = -1;
  std::int32_t face = -1;  // of the world's mesh; -1: the hull or nothing

  /// Between beam and surface normal, 0..pi/2.
  double incidence_rad() const;
  double effective_reflectivity() const { return reflectivity * cosine; }
};

/// What a ray of the world met, of which `hit` is known.
inline Meeting meeting_of(const Mesh& mesh, const Hit& hit, double default_reflectivity) {
  if (hit.face < 0) return {};
  const size_t f = static_cast<size_t>(hit.face);
  return {.range_m = hit.range_m,
          .cosine = std::abs(hit.cosine),
          .reflectivity = mesh.reflectivity.empty() ? default_reflectivity : mesh.reflectivity[f],
          .label = mesh.label.empty() ? Label::none : mesh.label[f],
          .part = mesh.part.empty() ? -1 : mesh.part[f],
          .face = hit.face};
}

/// What a ray in B meets of a vehicle's boxes. A box that holds the ray's origin is passed over.
Meeting meet_hull(const Hull& hull, const Vec3& origin_B, const Vec3& direction_B, double reflectivity);

}  // namespace adit
