// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapper/scan_points.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace adit {

/// A piece of rib as several scans saw it.
struct Surfel {
  Vec2 p, normal;               // in the map's frame A; the normal points into the void
  double z_m = 0;               // height in M
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
  /// The rib near a point: the surface that the surfels about it make together, each weighed by its closeness, so that
  /// it changes smoothly from place to place (Kolluri, "Provably good moving least squares", SODA 2005).
  struct Rib {
    double distance_m;  // of p from the surface, along its normal
    Vec2 normal;
    double sigma_normal_rad;
    double nearest_m;  // to the nearest surfel, in plan
    double sigma_m;    // of the distance, 1 sd, by what the surfels at other heights do not tell
  };
  /// Surfels within radius_m (<= 1 m) of p in plan whose normals lie within 60 degrees of `normal` count, those at its height
  /// most; none: no rib. A rib that was seen at other heights alone is an upright one, with its doubt.
  /// @param blend_m reach of the blend of surfels, farther where they lie sparsely; wider blurs the rock (drift 0.05 % at
  ///                0.25 m, 0.03 % at 0.12 m)
  std::optional<Rib> rib_near(const Vec2& p, double z_m, const Vec2& normal, double radius_m,
                              double blend_m = 0.12) const;

 private:
  void index();
  std::vector<Surfel> surfel_;
  std::vector<std::int32_t> start_;  // (width x height + 1) of the surfels in a cell of the index
  Vec2 low_ = Vec2::Zero();
  int width_ = 0, height_ = 0;
};

}  // namespace adit
