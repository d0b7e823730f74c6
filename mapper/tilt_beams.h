// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"
#include "mapper/spline.h"
#include "mapper/tilt.h"

#include <cstdint>
#include <vector>

namespace adit {

/// A beam that meets floor or roof.
struct TiltBeam {
  double at_s;
  Vec3 p_B, direction_B;  // the echo, and the way the beam went
  std::uint8_t laser;
  bool roof;
};

/// The roll at which a rib would be vertical, by one scan of one laser.
struct RibTilt {
  double at_s, roll_rad;
};

struct TiltData {
  std::vector<TiltBeam> beams;
  std::vector<RibTilt> ribs;
};

/// Beams of the vertical lasers, thinned, that meet what is flat (below 45 deg, judged by the neighbouring beams) as
/// floor or roof, and the slopes of ribs. Scans taken while the vehicle stands are thinned to about one in two seconds.
/// `motion` says when the vehicle stands; beams outside of its time are left out.
TiltData tilt_data(const Log& log, const PlanarMotion& motion, const TiltSettings& settings);

}  // namespace adit
