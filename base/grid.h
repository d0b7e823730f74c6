// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// What is known of the cells of a plane. Row 0 is the lowest y; cell (i, j) covers origin + [i, i+1) x [j, j+1) *
/// cell_m.
struct Grid {
  enum Cell : std::uint8_t { unknown, free, occupied };
  double cell_m = 0;
  Vec2 origin = Vec2::Zero();  // lower left corner
  int width = 0, height = 0;
  std::vector<float> log_odds;  // (height x width), > 0 occupied; 0 never seen

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
  Cell cell(int i, int j) const;
  Vec2 centre(int i, int j) const { return origin + cell_m * Vec2(i + 0.5, j + 0.5); }
};

/// ROS map_server: FILE.pgm (255 free, 0 occupied, 205 unknown) and FILE.yaml beside it.
void write_grid(const std::string& pgm_file, const Grid& grid);
/// Reads a map_server yaml with its picture; cells come back as log odds of -1, 0, +1 times a constant.
Grid read_grid(const std::string& yaml_file);

}  // namespace adit
