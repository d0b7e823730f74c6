// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace adit {

/// A stretch of a column, metres.
struct Interval {
  double low_m, high_m;
};

/// A solid as vertical columns on a square grid: column (i, j) stands at origin + (i + 0.5, j + 0.5) * cell_m and holds
/// the heights, sorted and disjoint, at which its axis is inside. Exact along z, sampled in plan; the volume of a solid
/// is the sum of its intervals times cell_m^2. (Van Hook, "Real-time shaded NC milling display", SIGGRAPH 1986.)
struct Dexels {
  double cell_m = 0;
  Vec2 origin = Vec2::Zero();
  int width = 0, height = 0;
  std::vector<std::uint32_t>
      offset;                      // (height x width + 1), row by row: column c is interval[offset[c] .. offset[c + 1])
  std::vector<Interval> interval;  // of all columns, one after the other

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
  size_t columns() const { return static_cast<size_t>(height) * width; }
  std::span<const Interval> column(size_t c) const { return {interval.data() + offset[c], offset[c + 1] - offset[c]}; }
  std::span<const Interval> column(int i, int j) const { return column(index(i, j)); }
  /// Where the axis of a column stands in plan.
  Vec2 axis(int i, int j) const { return origin + cell_m * Vec2(i + 0.5, j + 0.5); }
  double volume_m3() const;
};

/// Four corners in any order.
using Tetrahedron = std::array<Vec3, 4>;
/// Cubic metres.
double enclosed_volume(const Tetrahedron& t);

/// An empty solid that covers the box [low, high] in plan, its origin a multiple of cell_m: solids of the same cell
/// size share their columns.
Dexels empty_dexels(const Vec2& low, const Vec2& high, double cell_m);
/// The inside of a closed mesh (nonzero winding), over the columns of `like`.
Dexels dexels_of(const Mesh& mesh, const Dexels& like);
/// The union of many tetrahedra over the columns of `like`.
Dexels dexels_of(std::span<const Tetrahedron> tetrahedra, const Dexels& like);
/// Column by column; the same grid is required.
Dexels unite(const Dexels& a, const Dexels& b);
Dexels intersect(const Dexels& a, const Dexels& b);
Dexels subtract(const Dexels& a, const Dexels& b);
/// A solid from the intervals of each column (columns x any number, in any order, overlapping or not).
Dexels dexels_of(const std::vector<std::vector<Interval>>& columns, const Dexels& like);

/// Unites tetrahedra that come in many batches, so that they need never be in memory all at once. Corners are snapped
/// to 2^-17 m in plan and the question "does this axis cross this face" is answered in integers, an axis that meets an
/// edge being moved by an infinitesimal step: tetrahedra that share faces leave neither gap nor overlap. Parts outside
/// of the grid are dropped; corners more than 4 km from its origin are an Error. The same solid in any order of adding.
class DexelUnion {
 public:
  explicit DexelUnion(const Dexels& like);
  ~DexelUnion();
  DexelUnion(DexelUnion&&) noexcept;
  DexelUnion& operator=(DexelUnion&&) noexcept;

  void add(std::span<const Tetrahedron> tetrahedra);
  Dexels solid() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
