// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/fan.h"

#include <cmath>

namespace adit {

Ray spot_ray(const Ray& axis, const Vec3& across, const Vec3& above, const LaserModel& laser, const Bundle& bundle,
             size_t i) {
  const Vec3 off = bundle.place[i].x() * across + bundle.place[i].y() * above;  // in radii
  const double lean = laser.divergence_rad / 2;
  return {axis.origin + laser.spot_m / 2 * off,
          (axis.direction + lean * off) / std::sqrt(1 + lean * lean * bundle.place[i].squaredNorm())};
}

MountFan make_fan(const Mount& mount, const Bundle& bundle, const Hull& hull, double hull_reflectivity) {
  MountFan fan;
  const Eigen::Matrix3d R_BS = mount.X_BS.linear();
  const Vec3 above = R_BS.col(2);
  for (int k = 0; k < mount.laser.beams; ++k) {
    const double a = mount.laser.beam_angle_rad(k);
    fan.along.push_back(R_BS * Vec3(std::cos(a), std::sin(a), 0));
    fan.across.push_back(R_BS * Vec3(-std::sin(a), std::cos(a), 0));
    fan.offset_s.push_back(mount.laser.beam_offset_s(k));
    const Ray axis{mount.X_BS.translation(), fan.along.back()};
    for (size_t i = 0; i < bundle.place.size(); ++i) {
      const Ray ray = spot_ray(axis, fan.across.back(), above, mount.laser, bundle, i);
      fan.shadow.push_back(meet_hull(hull, ray.origin, ray.direction, hull_reflectivity));
      if (i == 0 && std::isfinite(fan.shadow.back().range_m)) fan.shadowed.push_back(static_cast<size_t>(k));
    }
  }
  return fan;
}

}  // namespace adit
