// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/exhibit.h"

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// Places in a box, as numbers of 16 bits: what the page's view in space is made of.
struct Raster {
  Vec3 low = Vec3::Zero();
  double step_m = 1;

  static constexpr double most = 65535;
  bool holds(const Vec3& p) const;
  std::uint16_t at(double value, int axis) const;
};
/// Of everything that the run has in space.
Raster raster_of(const Exhibit& exhibit);

/// A mesh of at most some 100,000 faces: packed places (x of all vertices, then y, z), then `colours` bytes of one a
/// vertex, then the faces' corners.
struct SpaceMesh {
  size_t vertices = 0, faces = 0, roof = 0;  // first face of the roof
  bool coloured = false;                     // a byte a vertex: 0..254 over the ramp, 255 = no true surface near
  std::string bytes;
};
SpaceMesh map_in_space(const Exhibit& exhibit, const Raster& raster);
SpaceMesh mine_in_space(const Exhibit& exhibit, const Raster& raster);

/// Where the lasers' beams ended at moments along the path, as the map lays them.
struct SpaceBeams {
  std::vector<double> stamp_s;       // (moments)
  std::vector<std::uint16_t> count;  // (moments x lasers) beams
  std::vector<std::uint16_t> from;   // (moments x lasers x 3) the laser
  std::vector<std::uint16_t> to;     // (beams x 3)
};
SpaceBeams beams_in_space(const Exhibit& exhibit, const Raster& raster);

}  // namespace adit
