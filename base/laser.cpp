// SPDX-License-Identifier: BSD-3-Clause
#include "base/laser.h"

#include "base/config.h"
#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace adit {

double LaserModel::beam_offset_s(int k) const {
  // Turn k % interlace; within a turn the mirror sweeps 360 deg in turn_s, the field of view at even speed.
  return (k % interlace) * turn_s + (beam_angle_rad(k) + fov_rad / 2) / (2 * std::numbers::pi) * turn_s;
}

double LaserModel::least_reflectivity(double range_m) const {
  return reflectivity_at_4m * std::pow(std::max(range_m / 4, 1.0), reflectivity_exponent);
}

LaserModel load_laser(const std::string& name_or_file, int baud) {
  const Document file = Document::find("sensors/lasers", name_or_file);
  LaserModel m;
  double fov_deg = 180, turn_ms = 13.32, resolution_mm = 1, sigma_mm = 5, bias_mm = 0, spot_mm = 0, divergence_mrad = 0;
  m.beams = 361;
  m.range_max_m = 30;
  std::vector<int> bauds, skips;
  constexpr double most = 1e9;
  file.read({{"name", &m.name, "how reports call it"},
             {"fov_deg", &fov_deg, "field of view", 1, 360},
             {"beams", &m.beams, "per scan, both ends of the field of view included", 2, 100000},
             {"turn_ms", &turn_ms, "one turn of the mirror", 0.01, 10000},
             {"interlace", &m.interlace, "turns that make one scan", 1, 16},
             {"bauds", &bauds, "rates of the serial link"},
             {"skips", &skips, "scans lost between two that are sent, for each of bauds"},
             {"range_max_m", &m.range_max_m, "largest range that can be told", 0.1, 10000},
             {"resolution_mm", &resolution_mm, "step of the reported range", 0, 1000},
             {"sigma_mm", &sigma_mm, "noise of one range, 1 sd", 0, most},
             {"bias_mm", &bias_mm, "systematic error of a device, half width of its band", 0, most},
             {"spot_mm", &spot_mm, "beam diameter at the window", 0, most},
             {"divergence_mrad", &divergence_mrad, "growth of the diameter", 0, 1000},
             {"reflectivity_at_4m", &m.reflectivity_at_4m, "least diffuse reflectivity that is seen up to 4 m", 0, 100},
             {"reflectivity_exponent", &m.reflectivity_exponent, "its growth with range beyond", 0, 10}});
  if (m.name.empty()) m.name = name_or_file;
  if (bauds.size() != skips.size()) file.fail("skips", "must have one number for each of 'bauds'");
  m.fov_rad = fov_deg * std::numbers::pi / 180;
  m.turn_s = turn_ms * 1e-3;
  m.resolution_m = resolution_mm * 1e-3;
  m.sigma_m = sigma_mm * 1e-3;
  m.bias_m = bias_mm * 1e-3;
  m.spot_m = spot_mm * 1e-3;
  m.divergence_rad = divergence_mrad * 1e-3;
  const double scan_s = m.turn_s * m.interlace;
  m.interval_s = scan_s;
  if (baud > 0 && !bauds.empty()) {
    std::string known;
    bool found = false;
    for (size_t i = 0; i < bauds.size(); ++i) {
      known += (i ? ", " : "") + std::to_string(bauds[i]);
      if (bauds[i] != baud) continue;
      found = true;
      // A scan is on the link while `skips` mirror scans pass unheard.
      m.interval_s = scan_s * (1 + skips[i]);
    }
    if (!found) file.fail("bauds", "has no rate of " + std::to_string(baud) + " Bd; it has " + known);
  }
  return m;
}

}  // namespace adit
