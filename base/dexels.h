// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/frames.h"
#include "base/mesh.h"

namespace adit {

/// A stretch of a column, metres.
struct Interval {
  double low_m, high_m;
};

/// A solid as vertical columns on a square grid: column (i, j) stands at origin + (i + 0.5, j + 0.5) * cell_m and holds the
/// heights, sorted and disjoint, at which its axis is inside. Exact along z, sampled in plan; the volume of a solid is the
/// sum of its intervals times cell_m^2. (Van Hook, "Real-time shaded NC milling display", SIGGRAPH 1986.)
struct Dexels {
  double cell_m = 0;
  Vec2 origin = Vec2::Zero();
  int width = 0, height = 0;
  std::vector<std::vector<Interval>> column;  // (height x width), row by row

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
  double volume_m3() const;
};

/// An empty solid that covers the box [low, high] in plan, its origin a multiple of cell_m: solids of the same cell size
/// share their columns.
Dexels empty_dexels(const Vec2& low, const Vec2& high, double cell_m);
/// The inside of a closed mesh (nonzero winding), over the columns of `like`.
Dexels dexels_of(const Mesh& mesh, const Dexels& like);
/// The union of many tetrahedra, corners in any order, over the columns of `like`.
Dexels dexels_of(std::span<const std::array<Vec3, 4>> tetrahedra, const Dexels& like);
/// Column by column; the same grid is required.
Dexels unite(const Dexels& a, const Dexels& b);
Dexels intersect(const Dexels& a, const Dexels& b);
Dexels subtract(const Dexels& a, const Dexels& b);

}  // namespace adit
