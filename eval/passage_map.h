// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/world.h"

#include <vector>

namespace adit {

/// Where a point is in the network of passages.
struct OnPassage {
  int passage;        // of the nearest centre line in plan
  double along_m;     // foot of the point on it, from junction a
  double distance_m;  // to it, in plan
};

/// The centre lines of a mine, asked for the nearest. The world must outlive it.
class PassageMap {
 public:
  explicit PassageMap(const World& world);

  bool empty() const { return segments_.empty(); }
  size_t size() const { return length_m_.size(); }
  /// Not for an empty map.
  OnPassage locate(const Vec2& p) const;
  /// Adds to `chain` (passages) the shortest way from a to b: +1 for a passage followed whole from its a to its b,
  /// parts as parts. The chain of a closed walk is whole numbers: which loops it goes round.
  void add_way(const OnPassage& a, const OnPassage& b, std::vector<double>& chain) const;

 private:
  struct Piece {
    Vec2 a, b;
    int passage;
    double from_m;  // along the passage at a
  };
  OnPassage foot(const Piece& piece, const Vec2& p) const;
  double to_end(const OnPassage& at, bool end_b) const;
  std::vector<std::pair<int, int>> way_between(int junction_a, int junction_b) const;

  const World* world_;
  std::vector<Piece> segments_;
  std::vector<double> length_m_;  // (passages)
  Vec2 origin_ = Vec2::Zero();
  int width_ = 0, height_ = 0;
  std::vector<std::vector<std::uint32_t>> cells_;  // segments that may be the nearest to a point of the cell
};

}  // namespace adit
