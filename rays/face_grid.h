// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "rays/nearest_face.h"

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace adit {

/// The faces of a mesh by the cells of a grid that they reach into, for points that lie close to the surface: there it finds
/// the face that Caster::closest() finds, several times as fast.
class FaceGrid {
 public:
  /// The mesh must outlive the grid. Error for a mesh without faces.
  explicit FaceGrid(const Mesh& mesh);

  /// The edge of a cell, about that of a face.
  double reach_m() const { return cell_m_; }
  /// As Caster::closest() with a radius of reach_m().
  std::optional<Closest> closest(const Vec3& p, const std::optional<Vec3>& seen_along = {}) const;

 private:
  // Four planes of a face about the grid's middle: columns x, y, z, 1; rows its own plane and, square to it, those through
  // its edges, + outside. A line of the cache.
  struct alignas(64) Planes {
    Eigen::Matrix4f row;
  };

  const Mesh* mesh_;
  Vec3 low_, middle_;
  double cell_m_ = 0;
  std::array<int, 3> blocks_{};       // of 8 x 8 x 8 cells
  std::vector<std::uint32_t> block_;  // (blocks) which of those that hold something, or `nothing`
  std::vector<std::uint32_t> first_;  // (cells of such blocks + 1) in face_
  std::vector<std::uint32_t> face_;   // cell after cell
  std::vector<Planes> planes_;        // (faces)
  float slack_m_ = 0;                 // rounding of what the planes say

  void choose_cells(const Vec3& high);
  void sort_faces();
  std::uint32_t cell_at(int i, int j, int k) const;
  std::array<int, 6> cells_of(std::uint32_t face) const;
};

}  // namespace adit
