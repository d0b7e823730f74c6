// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/trajectory.h"

#include <cstdint>
#include <vector>

namespace adit {

/// A part of the path without a corner, driven for the first time.
struct Stretch {
  double from_s, to_s;
  double length_m = 0;
};

/// A path cut into stretches: a new one begins where the path turns by 45 degrees from the present one's mean direction,
/// and where it leaves one that it drove before. What comes within 1.2 m of an earlier stretch about parallel to it, either
/// way, belongs to that; stretches of less than 3 m are none.
class Stretches {
 public:
  /// @param X_MB  of the body; not empty
  explicit Stretches(const Trajectory& X_MB);

  const std::vector<Stretch>& all() const { return stretch_; }
  /// The stretch that passes nearest to a place in plan.
  int nearest(const Vec2& p_M) const;

 private:
  struct Sample {
    Vec2 p, direction;
    int stretch;
  };
  std::vector<Stretch> stretch_;
  std::vector<Sample> sample_;
  Vec2 origin_ = Vec2::Zero();
  int width_ = 0, height_ = 0;
  std::vector<std::vector<std::uint32_t>> bucket_;  // (height x width) samples

  template <typename Visit>
  void around(const Vec2& p, int ring, Visit&& visit) const;
  int driven_before(const Sample& here, size_t until) const;
  void keep(size_t sample);
  void drop_short();
};

}  // namespace adit
