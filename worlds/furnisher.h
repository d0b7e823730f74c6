// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/fittings.h"
#include "worlds/furniture.h"

#include <vector>

namespace adit {

/// A passage's centre line by its length.
class Way {
 public:
  Way(const Drift& drift, double clear_a_m, double clear_b_m);
  double length_m() const { return at_.back(); }
  Spot at(double s) const;
  /// Where vehicles turn round: near its dead ends.
  bool turns(double s) const { return s < turn_a_m || s > length_m() - turn_b_m; }

 private:
  const std::vector<Vec2>& line_;
  std::vector<double> at_;

 public:
  double from_m, to_m;                // where things may stand
  double turn_a_m = 0, turn_b_m = 0;  // of its ends, where vehicles turn round
};

double yaw_of(const Vec2& v);

/// Puts things into a part of a mine. Every thing has its own random address: by what it is, its passage, its number.
class Furnisher {
 public:
  Furnisher(const FurniturePlan& plan, Space& space);
  Asked furnish(const std::vector<size_t>& passages);

 private:
  enum What : std::uint64_t { posts = 1, crossbars, cribs, bolts, track, belts, pipes, cables, blocks, pools, stones };

  double lot(What what, std::uint64_t k) const;
  double lot(What what, std::uint64_t k, double low, double high) const { return low + (high - low) * lot(what, k); }
  bool has(What what, double share) const { return lot(what, 0) < share; }
  int count(What what, double per_100m, const Way& way) const;
  double lane() const { return 0.5 * s_.lane_m; }
  double lane(const Way& way, double s) const;
  Way way_of(size_t passage) const;

  /// What is asked for and not put counts as left out.
  void ask(Label label, int n = 1) { asked_[{passage_, label}] += n; }
  bool put(Label label, Bodies bodies, double yaw, bool blocks = false);

  // Supports.
  void add_posts(const Way& way);
  void add_crossbars(const Way& way);
  void add_cribs(const Way& way);
  void add_bolts(const Way& way);

  // What runs along a passage, and what runs on it.
  void add_track(const Way& way);
  void add_rail(const Vec2& from, const Vec2& to, const std::vector<std::pair<double, double>>& tops, double length);
  void add_belt(const Way& way);
  void add_line(const Way& way, What what);
  void add_car(const Way& way, double s);

  // What fell or ran together.
  Loop block_outline(const Vec2& p, double radius, What what, std::uint64_t k) const;
  double block_size(What what, std::uint64_t k) const;
  bool put_block(const Vec2& p, double size, What what, std::uint64_t k);
  void add_blocks(const Way& way);
  void add_stones();
  double off_lanes(const Vec2& p) const;
  void add_beam(const Spot& spot);
  void add_pools(const Way& way);
  void add_pool(const Vec2& lowest, double depth);

  void add_stopping(const Spot& spot);
  void add_blocker(const Blocker& b, const Way& way);

  const FurniturePlan& plan_;
  const FurnitureSettings& s_;
  Space& space_;
  std::vector<int> degree_;
  std::vector<double> widest_;
  size_t passage_ = 0;
  Asked asked_;
};

}  // namespace adit
