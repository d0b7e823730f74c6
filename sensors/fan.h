// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/hull.h"
#include "base/rig.h"
#include "sensors/beam.h"
#include "sensors/echo.h"

#include <vector>

namespace adit {

/// The beams of a mount as they lie in B, fixed there for every scan.
struct MountFan {
  std::vector<Vec3> along, across;  // (beams) directions of the beam and, in the scan plane, to its left
  std::vector<double> offset_s;     // (beams) when each leaves
  // What each ray of each beam's bundle meets of its own vehicle. (beams x rays)
  std::vector<Meeting> shadow;
  std::vector<size_t> shadowed;  // beams whose axis meets it
};

MountFan make_fan(const Mount& mount, const Bundle& bundle, const Hull& hull, double hull_reflectivity);

/// The rays of a beam's spot: it leaves the window as wide as the spot and grows by the divergence.
/// @param across, above  unit vectors perpendicular to the beam
/// @param i              place in the bundle, 0 = the axis
Ray spot_ray(const Ray& axis, const Vec3& across, const Vec3& above, const LaserModel& laser, const Bundle& bundle,
             size_t i);

}  // namespace adit
