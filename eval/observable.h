// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"
#include "eval/true_scans.h"

#include <cstdint>
#include <vector>

namespace adit {

/// The surface of a mine in patches: faces are cut into triangles with edges of at most patch_m, and triangles of one
/// label whose centres fall into the same cube of that edge are one patch. So patches are alike whatever the mesh's own
/// faces.
class Patches {
 public:
  /// @param X_WC  frame of the cubes; one that moves with the mine, so that patches do not depend on where W lies
  Patches(const Mesh& mesh, double patch_m, const Pose& X_WC);

  size_t size() const { return area_m2_.size(); }
  double area_m2(size_t patch) const { return area_m2_[patch]; }
  const Vec3& centre(size_t patch) const { return centre_[patch]; }
  Label label(size_t patch) const { return label_[patch]; }
  /// Of a point on a face.
  std::uint32_t at(std::int32_t face, const Vec3& p_W) const;
  /// Of a face that is one triangle, where the point does not matter.
  bool whole(std::int32_t face) const { return cuts_[face] == 1; }

 private:
  std::uint64_t triangle_of(std::int32_t face, double u, double v) const;

  const Mesh* mesh_;
  std::vector<std::uint32_t> cuts_;   // (faces) each edge is cut into so many: cuts^2 triangles
  std::vector<std::uint64_t> first_;  // (faces + 1) triangle
  std::vector<std::uint32_t> patch_;  // (triangles)
  std::vector<double> area_m2_;
  std::vector<Vec3> centre_;
  std::vector<Label> label_;
};

/// What of a mine its recording could show.
struct Observable {
  std::vector<std::uint8_t> patch_hits;  // (patches) noise-free beams that met it within incidence_rad, at most 255
  std::vector<std::uint8_t> face_hits;   // (faces) the same

  bool seen(std::uint32_t patch, int beams = 1) const { return patch_hits[patch] >= beams; }
};

Observable observable_surface(const Patches& patches, const TrueScans& scans, size_t faces, double incidence_rad);

}  // namespace adit
