// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace adit {

class Document;

/// A planar scanning laser as its sheet states it: what a mapper may know. How one is simulated is the sensors' matter.
struct LaserModel {
  std::string name;
  double fov_rad = 0;
  int beams = 0;            // equally spaced over fov_rad, both ends included, counter-clockwise about S's z
  double turn_s = 0;        // one turn of the mirror
  int interlace = 1;        // turns per scan: beam k is fired in turn k % interlace
  double interval_s = 0;    // from the start of one recorded scan to the next, by the link's rate
  double range_max_m = 0;   // of the mode
  double resolution_m = 0;  // of the reported range
  double sigma_m = 0;       // stated noise, 1 sd
  double bias_m = 0;        // stated systematic error, half the width of its band
  double spot_m = 0, divergence_rad = 0;  // beam diameter = spot + divergence * range
  double reflectivity_at_4m =
      0;  // least diffuse reflectivity seen up to 4 m, growing as range^reflectivity_exponent beyond
  double reflectivity_exponent = 0;

  // Least reflectivity by range as a chart; empty: the law of the two above.
  std::vector<double> chart_range_m = {}, chart_reflectivity = {};

  // What only a simulation asks for; a log does not hold it.
  double curve_m = 0;                      // error of a device that swings with the range, at most
  double energy_m = 0;                     // error between dark and bright targets, at most
  double warm_up_m = 0, warm_up_s = 3600;  // error of a cold device, and the time in which it fades
  bool codes = false;                      // tells why there is no range
  double latency_s = 0;                    // from a scan's begin until its telegram has arrived; 0: not stated

  /// Direction of beam k in the scan plane, 0 = S's x axis.
  double beam_angle_rad(int k) const { return -fov_rad / 2 + fov_rad * k / (beams - 1); }
  /// When beam k leaves after the scan's stamp.
  double beam_offset_s(int k) const;
  /// Least effective reflectivity, reflectivity * cos(incidence), that is noticed at a range: by the chart, straight
  /// between its points; without one flat up to 4 m, then growing by the model's power; 0 where the model states none.
  double least_reflectivity(double range_m) const;
};

/// A setting of a laser: names of its [[mode]], [[raster]] and [[sensitivity]] tables; empty = what the file states at
/// its top.
struct LaserChoice {
  std::string mode = {}, raster = {}, sensitivity = {};
};

/// A bundled laser by name, or one from a TOML file; baud > 0 sets interval_s by the serial link (SICK telegram
/// listing, table of skipped scans). Errors name file and key; a rate that the link cannot carry is an error, and so is a
/// mode, a raster or a sensitivity that the laser does not have.
LaserModel load_laser(const std::string& name_or_file, int baud, const LaserChoice& choice = {});

}  // namespace adit
