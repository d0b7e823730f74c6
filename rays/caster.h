// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"
#include "rays/nearest_face.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace adit {

struct Ray {
  Vec3 origin, direction;  // direction of unit length
  double far_m = 1e4;
};

struct Hit {
  double range_m;          // +inf: nothing met
  std::int32_t face = -1;  // of the mesh, -1: nothing met
  double cosine = 0;       // between the ray and the face's normal; > 0 where it is met from within the enclosed volume
};

/// Rays by their numbers, for those who fire millions: origins and directions of unit length, all to 10 km.
template <class T>
struct RayColumns {
  std::vector<T> x, y, z, dx, dy, dz;  // (n)

  size_t size() const { return x.size(); }
  void resize(size_t n) {
    for (std::vector<T>* column : {&x, &y, &z, &dx, &dy, &dz}) column->resize(n);
  }
};

/// What they meet, as in Hit. (n)
template <class T>
struct HitColumns {
  std::vector<T> range_m, cosine;
  std::vector<std::int32_t> face;

  void resize(size_t n) { range_m.resize(n), cosine.resize(n), face.resize(n); }
};

/// Asks a mesh what a ray meets first and what surface is nearest. Safe to ask from many threads; the same bits on any
/// number of them. The sole owner of Embree, its instruction set pinned.
class Caster {
 public:
  /// The mesh must outlive the caster. Error for a mesh without faces, or a processor without AVX2.
  explicit Caster(const Mesh& mesh);
  ~Caster();
  Caster(Caster&&) noexcept;
  Caster& operator=(Caster&&) noexcept;

  const Mesh& mesh() const;
  /// Exact: the face is found in floats, the range to its plane computed in doubles.
  Hit nearest(const Ray& ray) const;
  /// hits[i] belongs to rays[i]. Fastest where neighbours in the span are neighbours in space (beams of one fan in
  /// order).
  void nearest(std::span<const Ray> rays, std::span<Hit> hits) const;
  /// The same for rays [begin, end) of columns, `together` of them (16 at most) traced at a time in their order. Where a ray
  /// meets an edge, which of its faces is told may depend on its company; all else does not.
  /// @pre hits have the rays' size
  void nearest(const RayColumns<double>& rays, size_t begin, size_t end, size_t together,
               HitColumns<double>& hits) const;
  /// The same to the accuracy of floats, 5e-5 m a few hundred metres from the middle of the mesh: rays given about
  /// middle(), traced in their order.
  void glance(const RayColumns<float>& rays, HitColumns<float>& hits) const;
  const Vec3& middle() const;
  /// Nearest point of the surface within radius_m. With `seen_along` only faces that a beam in that direction can meet
  /// from within the enclosed volume count (normal . seen_along > 0), so that a thin wall does not lend its far face.
  std::optional<Closest> closest(const Vec3& p, double radius_m, const std::optional<Vec3>& seen_along = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace adit
