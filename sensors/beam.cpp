// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/beam.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

struct BoxHit {
  double range_m = std::numeric_limits<double>::infinity();
  int axis = -1;  // of the side that is met
};

// Kay and Kajiya, "Ray tracing complex scenes", SIGGRAPH 1986: the last entry into a slab, if before the first exit.
BoxHit enter(const Box& box, const Vec3& origin, const Vec3& direction) {
  double near = 0, far = std::numeric_limits<double>::infinity();
  int axis = -1;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) {
      if (origin[k] < box.min_B[k] || origin[k] > box.max_B[k]) return {};
      continue;
    }
    double in = (box.min_B[k] - origin[k]) / direction[k], out = (box.max_B[k] - origin[k]) / direction[k];
    if (in > out) std::swap(in, out);
    if (in > near) near = in, axis = k;
    far = std::min(far, out);
  }
  return near <= far && axis >= 0 ? BoxHit{near, axis} : BoxHit{};
}

}  // namespace

double Meeting::incidence_rad() const {
  return std::acos(std::min(cosine, 1.0));
}

Meeting meet_hull(const Hull& hull, const Vec3& origin_B, const Vec3& direction_B, double reflectivity) {
  Meeting nearest;
  for (const Box& box : hull) {
    const BoxHit hit = enter(box, origin_B, direction_B);
    if (hit.axis < 0 || hit.range_m >= nearest.range_m) continue;
    nearest.range_m = hit.range_m;
    nearest.cosine = std::abs(direction_B[hit.axis]);
    nearest.reflectivity = reflectivity;
    nearest.label = box.label;
  }
  return nearest;
}

}  // namespace adit
