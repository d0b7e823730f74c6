// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"

#include <cstdint>
#include <optional>

namespace adit {

struct Closest {
  Vec3 point;
  std::int32_t face;
  double distance_m;
};

/// The face nearest to a point, of those that are offered one by one: exact, whatever finds the candidates. Of faces that
/// share the nearest edge or corner it is the one that p looks at most squarely, which tells on which side p lies; of equal
/// ones the first in the mesh. With `seen_along` only faces with normal . seen_along > 0 count.
class NearestFace {
 public:
  /// Only within radius_m. The mesh must outlive it.
  NearestFace(const Mesh& mesh, const Vec3& p, double radius_m, const std::optional<Vec3>& seen_along);

  /// @return whether it is the nearest so far
  bool offer(std::uint32_t face);
  /// Distance of the nearest so far, or the radius.
  double best_m() const { return best_m_; }
  std::optional<Closest> found() const;

 private:
  const Mesh& mesh_;
  Vec3 p_;
  std::optional<Vec3> seen_along_;
  double best_m_;
  Vec3 point_;
  std::int32_t face_ = -1;

  double facing(std::int32_t face, const Vec3& at) const;
  bool beats(std::int32_t face, const Vec3& at) const;
};

}  // namespace adit
