// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapper/scan_points.h"

#include <cstdint>
#include <span>
#include <vector>

namespace adit {

/// A piece of rib as several scans saw it.
struct Surfel {
  Vec2 p, normal;               // in the map's frame A; the normal points into the void
  double sigma_normal_rad = 0;  // of its direction, by laser noise
};

/// Ribs around one place in some frame A: surfels on a fine grid, found by place.
class LocalMap {
 public:
  LocalMap() = default;
  /// @param X_AB pose of each scan's body in A; as many as scans. Surfels closer than cell_m with like normals are
  /// merged.
  LocalMap(std::span<const ScanPoints* const> scans, std::span<const Pose2> X_AB, double cell_m = 0.1);

  size_t size() const { return surfel_.size(); }
  const std::vector<Surfel>& surfels() const { return surfel_; }
  /// Index of the surfel nearest to p within radius_m (<= 1 m) whose normal lies within 60 degrees of `normal`; -1 if
  /// none.
  int nearest(const Vec2& p, const Vec2& normal, double radius_m) const;

 private:
  void index();
  std::vector<Surfel> surfel_;
  std::vector<std::int32_t> start_;  // (width x height + 1) of the surfels in a cell of the index
  Vec2 low_ = Vec2::Zero();
  int width_ = 0, height_ = 0;
};

}  // namespace adit
