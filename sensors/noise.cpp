// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/noise.h"

#include "base/rng.h"
#include "sensors/sick.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double degree = std::numbers::pi / 180;

}  // namespace

std::uint64_t scan_address(size_t mount, size_t scan) {
  return (std::uint64_t{mount} << 40) | scan;
}

float reading(const LaserModel& model, const Meeting& meeting, double bias_m, const SensorSettings& settings,
              const BeamAddress& at) {
  if (settings.drop_out > 0 && uniform(at.seed, Draw::beam_drop, at.scan, at.beam) < settings.drop_out)
    return std::numeric_limits<float>::quiet_NaN();
  if (!std::isfinite(meeting.range_m)) return std::numeric_limits<float>::infinity();
  const double effective = meeting.reflectivity * std::cos(meeting.incidence_rad);
  if (settings.detection) {
    const double chance = detection_chance(model, effective, meeting.range_m, settings.detection_spread);
    if (uniform(at.seed, Draw::beam_detect, at.scan, at.beam) >= chance) return std::numeric_limits<float>::infinity();
  }
  double range_m = meeting.range_m + bias_m;
  if (settings.noise) {
    double sigma_m = range_sigma_m(model, effective, meeting.range_m);
    if (settings.footprint)
      sigma_m = std::hypot(sigma_m, footprint_sigma_m(model, meeting.range_m, meeting.incidence_rad));
    range_m += sigma_m * normal(at.seed, Draw::beam_range, at.scan, at.beam);
  }
  return reported_range_m(model, range_m);
}

double device_bias_m(const LaserModel& model, size_t mount, const SensorSettings& settings, std::uint64_t seed) {
  return settings.bias ? model.bias_m * (2 * uniform(seed, Draw::laser_device, mount) - 1) : 0;
}

double beam_angle_error_rad(const SensorSettings& settings, const BeamAddress& at) {
  if (settings.beam_angle_deg == 0) return 0;
  return settings.beam_angle_deg * degree * normal(at.seed, Draw::beam_angle, at.scan, at.beam);
}

Rig true_rig(const Rig& nominal, const SensorSettings& settings, std::uint64_t seed) {
  Rig rig = nominal;
  for (size_t i = 0; i < rig.mounts.size(); ++i) {
    const auto draw = [&](std::uint64_t axis) { return normal(seed, Draw::mount_error, i, axis); };
    const double sd_rad = settings.mount_error_deg * degree, sd_m = settings.mount_error_m;
    if (sd_rad > 0 || sd_m > 0)
      rig.mounts[i].X_BS = rig.mounts[i].X_BS * pose_of(sd_m * Vec3(draw(0), draw(1), draw(2)), sd_rad * draw(3),
                                                        sd_rad * draw(4), sd_rad * draw(5));
    rig.mounts[i].phase_s = uniform(seed, Draw::laser_phase, i) * rig.mounts[i].laser.interval_s;
  }
  return rig;
}

}  // namespace adit
