// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/occupancy.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>

namespace adit {
namespace {

// Votes are whole numbers, so that their sum does not hang on the order in which threads add them.
constexpr double vote_unit = 1e-3;
using Votes = std::vector<std::int32_t>;

struct Lattice {
  double cell_m;
  int i0, j0, width, height;  // cell (i, j) of the plane is (i - i0, j - j0) of the lattice
};

Lattice lattice_around(const std::vector<Pose2>& X_MB, double reach_m, double cell_m) {
  Vec2 low = X_MB.front().position(), high = low;
  for (const Pose2& X : X_MB) low = low.cwiseMin(X.position()), high = high.cwiseMax(X.position());
  const auto cell = [&](double x) { return static_cast<int>(std::floor(x / cell_m)); };
  const int i0 = cell(low.x() - reach_m), j0 = cell(low.y() - reach_m);
  return {cell_m, i0, j0, cell(high.x() + reach_m) - i0 + 1, cell(high.y() + reach_m) - j0 + 1};
}

// What one scan says of the cells about it, each cell once.
class Patch {
 public:
  Patch(double reach_m, double cell_m)
      : cell_m_(cell_m),
        half_(static_cast<int>(reach_m / cell_m) + 2),
        side_(2 * half_ + 1),
        vote_(static_cast<size_t>(side_) * side_, 0) {}

  void centre_on(const Vec2& p) {
    i0_ = static_cast<int>(std::floor(p.x() / cell_m_)) - half_;
    j0_ = static_cast<int>(std::floor(p.y() / cell_m_)) - half_;
  }

  /// Frees the cells from a up to, and not including, the one in which b lies.
  /// Amanatides, Woo, "A fast voxel traversal algorithm", Eurographics 1987.
  void free_between(const Vec2& a, const Vec2& b, std::int32_t vote) {
    constexpr double inf = std::numeric_limits<double>::infinity();
    const double ax = a.x() / cell_m_, ay = a.y() / cell_m_, bx = b.x() / cell_m_, by = b.y() / cell_m_;
    int i = static_cast<int>(std::floor(ax)), j = static_cast<int>(std::floor(ay));
    const int end_i = static_cast<int>(std::floor(bx)), end_j = static_cast<int>(std::floor(by));
    const double dx = bx - ax, dy = by - ay;
    const int step_i = dx > 0 ? 1 : -1, step_j = dy > 0 ? 1 : -1;
    const double across_x = dx != 0 ? 1 / std::abs(dx) : inf, across_y = dy != 0 ? 1 / std::abs(dy) : inf;
    double next_x = dx != 0 ? (i + (dx > 0) - ax) / dx : inf, next_y = dy != 0 ? (j + (dy > 0) - ay) / dy : inf;
    for (int left = std::abs(end_i - i) + std::abs(end_j - j); left > 0; --left) {
      set(i, j, vote, false);
      if (next_x < next_y)
        i += step_i, next_x += across_x;
      else
        j += step_j, next_y += across_y;
    }
  }

  /// An echo at p; a cell that is hit is not freed by the same scan.
  void hit(const Vec2& p, std::int32_t vote) {
    set(static_cast<int>(std::floor(p.x() / cell_m_)), static_cast<int>(std::floor(p.y() / cell_m_)), vote, true);
  }

  /// Adds the votes and begins anew.
  void cast_into(Votes& votes, const Lattice& to) {
    for (const std::int32_t at : touched_) {
      const int i = i0_ + at % side_ - to.i0, j = j0_ + at / side_ - to.j0;
      if (i >= 0 && j >= 0 && i < to.width && j < to.height)
        std::atomic_ref(votes[static_cast<size_t>(j) * to.width + i]).fetch_add(vote_[at], std::memory_order_relaxed);
      vote_[at] = 0;
    }
    touched_.clear();
  }

 private:
  void set(int i, int j, std::int32_t vote, bool over) {
    i -= i0_, j -= j0_;
    if (i < 0 || j < 0 || i >= side_ || j >= side_) return;
    std::int32_t& cell = vote_[static_cast<size_t>(j) * side_ + i];
    if (cell == 0) touched_.push_back(j * side_ + i);
    if (cell == 0 || (over && vote > cell)) cell = vote;
  }

  double cell_m_;
  int half_, side_;
  std::vector<std::int32_t> vote_;
  std::vector<std::int32_t> touched_;
  int i0_ = 0, j0_ = 0;
};

std::int32_t votes_of(double odds) {
  return static_cast<std::int32_t>(std::lround(odds / vote_unit));
}

// How much an echo counts for a rib: fully up to near_m, then less, a quarter at the end.
double trust_at(double range_m, const OccupancySettings& s, const ScanPointSettings& points) {
  if (range_m <= s.near_m) return 1;
  return 1 - 0.75 * std::min(1.0, (range_m - s.near_m) / std::max(1e-3, points.range_max_m - s.near_m));
}

void look(std::span<const float> range_m, const BeamFan& fan, const Pose2& X_MB, const Twist2& twist,
          const OccupancySettings& s, const ScanPointSettings& points, Patch& patch) {
  const ScanPoints ribs = scan_points(range_m, fan, twist, points);
  size_t next = 0;  // of the ribs' points, which come in the order of the beams
  for (size_t k = 0; k < range_m.size(); ++k) {
    const double r = range_m[k];
    const bool on_rib = next < ribs.size() && ribs.beam[next] == static_cast<std::int32_t>(k);
    if (std::isnan(r) || r < points.range_min_m) continue;
    const Pose2 X_MS = X_MB * pose_after(twist, fan.offset_s[k]);
    const double clear_m = std::isinf(r) ? std::min(s.no_echo_m, points.range_max_m) : std::min(r, points.range_max_m);
    const Vec2 from = X_MS * fan.origin_B, to = X_MS * Vec2(fan.origin_B + clear_m * fan.direction_B[k]);
    patch.free_between(from, to, -votes_of(s.free_odds));
    if (on_rib) {
      patch.hit(to, votes_of(s.hit_odds * trust_at(r, s, points)));
      ++next;
    }
  }
}

// Scans that are worth looking at: the first, and each that moved or turned since the last.
std::vector<size_t> scans_worth(const std::vector<Pose2>& X_MB, double step_m) {
  std::vector<size_t> out{0};
  for (size_t i = 1; i < X_MB.size(); ++i) {
    const Pose2 moved = X_MB[out.back()].inverse() * X_MB[i];
    if (moved.position().norm() >= step_m || std::abs(moved.yaw_rad) >= 0.05) out.push_back(i);
  }
  return out;
}

Grid grid_of(const Votes& votes, const Lattice& on, double most_odds) {
  int low_i = on.width, low_j = on.height, high_i = -1, high_j = -1;
  for (int j = 0; j < on.height; ++j)
    for (int i = 0; i < on.width; ++i)
      if (votes[static_cast<size_t>(j) * on.width + i] != 0) {
        low_i = std::min(low_i, i), high_i = std::max(high_i, i);
        low_j = std::min(low_j, j), high_j = std::max(high_j, j);
      }
  Grid grid;
  grid.cell_m = on.cell_m;
  if (high_i < 0) return grid;
  grid.origin = on.cell_m * Vec2(on.i0 + low_i, on.j0 + low_j);
  grid.width = high_i - low_i + 1, grid.height = high_j - low_j + 1;
  grid.log_odds.resize(static_cast<size_t>(grid.width) * grid.height);
  for (int j = 0; j < grid.height; ++j)
    for (int i = 0; i < grid.width; ++i) {
      const double odds = vote_unit * votes[static_cast<size_t>(j + low_j) * on.width + i + low_i];
      grid.log_odds[grid.index(i, j)] = static_cast<float>(std::clamp(odds, -most_odds, most_odds));
    }
  return grid;
}

}  // namespace

Fields fields(OccupancySettings& s) {
  return {{"cell_m", &s.cell_m, "side of a cell", 0.01, 10},
          {"step_m", &s.step_m, "way between scans that are used", 0, 10},
          {"near_m", &s.near_m, "echoes beyond count less and less for ribs", 0, 1000},
          {"no_echo_m", &s.no_echo_m, "a beam without echo frees the cells up to here", 0, 1000},
          {"free_odds", &s.free_odds, "taken off the log odds of a cell that is crossed", 0.001, 100},
          {"hit_odds", &s.hit_odds, "added to the log odds of a cell where an echo ends", 0.004, 100},
          {"most_odds", &s.most_odds, "bound of the log odds", 0.1, 1000}};
}

Grid map_grid(const Scans& scans, const Mount& mount, const std::vector<Pose2>& X_MB, const OccupancySettings& settings,
              const ScanPointSettings& points, const Progress& progress) {
  ADIT_CHECK(scans.size() == X_MB.size());
  if (X_MB.empty()) return {settings.cell_m, Vec2::Zero(), 0, 0, {}};
  const BeamFan fan = fan_of(mount);
  const double reach_m = points.range_max_m + fan.origin_B.norm() + 1;
  const Lattice lattice = lattice_around(X_MB, reach_m, settings.cell_m);
  const std::vector<Twist2> twists = twists_of(scans.stamp_s, X_MB);
  const std::vector<size_t> used = scans_worth(X_MB, settings.step_m);
  Votes votes(static_cast<size_t>(lattice.width) * lattice.height, 0);
  parallel_chunks(used.size(), 64, [&](size_t begin, size_t end) {
    Patch patch(reach_m, settings.cell_m);
    for (size_t k = begin; k < end; ++k) {
      const size_t i = used[k];
      patch.centre_on(X_MB[i].position());
      look(scans[i], fan, X_MB[i], twists[i], settings, points, patch);
      patch.cast_into(votes, lattice);
    }
  });
  progress("draw the grid", 1, 1);
  return grid_of(votes, lattice, settings.most_odds);
}

}  // namespace adit
