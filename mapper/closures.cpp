// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/closures.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace adit {
namespace {

constexpr double half_window_m = 0.5;  // either way, for the direction of travel
constexpr double thin_m = 0.5;         // spacing of the points that are searched
constexpr double slack_m = 0.5;        // along the path, where the joining line has no direction

Vec2 unit(double angle_rad) {
  return {std::cos(angle_rad), std::sin(angle_rad)};
}

/// Angle between two directions that may be driven either way, 0..pi/2.
double between_lines(double a_rad, double b_rad) {
  const double d = std::abs(wrap_angle(a_rad - b_rad));
  return std::min(d, std::numbers::pi - d);
}

/// The path thinned to points about half a metre apart, found by their place.
class ThinPath {
 public:
  ThinPath(const Chain& chain, const std::vector<Pose2>& X_MB, double cell_m) : cell_m_(cell_m) {
    for (size_t i = 0; i < X_MB.size(); ++i)
      if (scan_.empty() || chain.along_m[i] - chain.along_m[scan_.back()] >= thin_m) {
        cells_[cell(X_MB[i].position())].push_back(static_cast<int>(scan_.size()));
        scan_.push_back(static_cast<int>(i));
      }
  }
  int size() const { return static_cast<int>(scan_.size()); }
  int scan(int k) const { return scan_[k]; }

  /// Indices of points in the nine cells around p, rising.
  std::vector<int> around(const Vec2& p) const {
    std::vector<int> found;
    const auto [cx, cy] = cell(p);
    for (int x = cx - 1; x <= cx + 1; ++x)
      for (int y = cy - 1; y <= cy + 1; ++y)
        if (const auto it = cells_.find({x, y}); it != cells_.end())
          found.insert(found.end(), it->second.begin(), it->second.end());
    std::sort(found.begin(), found.end());
    return found;
  }

 private:
  std::pair<int, int> cell(const Vec2& p) const {
    return {static_cast<int>(std::floor(p.x() / cell_m_)), static_cast<int>(std::floor(p.y() / cell_m_))};
  }
  double cell_m_;
  std::vector<int> scan_;
  std::map<std::pair<int, int>, std::vector<int>> cells_;
};

struct Search {
  const Chain& chain;
  const std::vector<Pose2>& X_MB;
  const std::vector<double> direction_rad;
  const ThinPath thin;
  const EncounterCriteria& criteria;

  Vec2 position(double scan) const {
    const int i = static_cast<int>(scan);
    const double s = scan - i;
    return s > 0 ? Vec2((1 - s) * X_MB[i].position() + s * X_MB[i + 1].position()) : X_MB[i].position();
  }

  /// Where the path between scans a and b crosses the perpendicular of scan s; the end that is nearer to it if it does
  /// not.
  double foot_between(int s, int a, int b) const {
    const Vec2 p = X_MB[s].position(), t = unit(direction_rad[s]);
    double best = a, best_along_m = std::abs(t.dot(X_MB[a].position() - p));
    for (int i = a; i < b; ++i) {
      const double from = t.dot(X_MB[i].position() - p), to = t.dot(X_MB[i + 1].position() - p);
      if (from == to ? from == 0 : (from <= 0) != (to <= 0)) return i + from / (from - to);
      if (std::abs(to) < best_along_m) best = i + 1, best_along_m = std::abs(to);
    }
    return best;
  }

  bool accepts(int s, double foot) const {
    const int i = static_cast<int>(std::lround(foot));
    const Vec2 d = position(foot) - X_MB[s].position();
    if (d.norm() > criteria.near_m || chain.along_m[s] - chain.along_m[i] < criteria.gap_m) return false;
    if (between_lines(direction_rad[s], direction_rad[i]) > criteria.parallel_rad) return false;
    if (between_lines(X_MB[s].yaw_rad, X_MB[i].yaw_rad) > criteria.parallel_rad)
      return false;  // one of them is turning
    const double allowed_m = std::max(slack_m, d.norm() * std::sin(criteria.orthogonal_rad));
    return std::abs(unit(direction_rad[s]).dot(d)) <= allowed_m && std::abs(unit(direction_rad[i]).dot(d)) <= allowed_m;
  }

  Encounter encounter(int s, double foot) const {
    Encounter e{s, static_cast<int>(std::lround(foot)), foot, false, 0};
    e.opposite = std::abs(wrap_angle(direction_rad[s] - direction_rad[e.foot_scan])) > std::numbers::pi / 2;
    const Vec2 t = unit(direction_rad[s]);
    e.offset_m = Vec2(-t.y(), t.x()).dot(position(foot) - X_MB[s].position());
    return e;
  }

  /// The best foot on one run [first, last] of thinned points, if it fulfils the criteria.
  void try_run(int s, int first, int last, std::vector<Encounter>& found) const {
    const int end = last + 1 < thin.size() ? thin.scan(last + 1) : static_cast<int>(X_MB.size()) - 1;
    const double foot = foot_between(s, thin.scan(first), end);
    if (accepts(s, foot)) found.push_back(encounter(s, foot));
  }

  void search(int s, std::vector<Encounter>& found) const {
    const Vec2 p = X_MB[s].position();
    int first = -1, last = -1;
    for (int k : thin.around(p)) {
      const int i = thin.scan(k);
      if (chain.along_m[s] - chain.along_m[i] < criteria.gap_m ||
          (X_MB[i].position() - p).norm() > criteria.near_m + thin_m)
        continue;
      if (between_lines(direction_rad[s], direction_rad[i]) > criteria.parallel_rad) continue;
      if (first >= 0 && k > last + 1) try_run(s, first, last, found), first = -1;
      if (first < 0) first = k;
      last = k;
    }
    if (first >= 0) try_run(s, first, last, found);
  }
};

}  // namespace

std::vector<double> directions(const Chain& chain, const std::vector<Pose2>& X_MB) {
  const size_t n = X_MB.size();
  std::vector<double> direction_rad(n);
  size_t behind = 0, before = 0;
  for (size_t i = 0; i < n; ++i) {
    while (behind < i && chain.along_m[i] - chain.along_m[behind + 1] >= half_window_m) ++behind;
    while (before + 1 < n && chain.along_m[before] - chain.along_m[i] < half_window_m) ++before;
    const Vec2 d = X_MB[before].position() - X_MB[behind].position();
    direction_rad[i] = d.norm() > 0.5 * half_window_m ? std::atan2(d.y(), d.x()) : X_MB[i].yaw_rad;
  }
  return direction_rad;
}

std::vector<Encounter> find_encounters(const Chain& chain, const std::vector<Pose2>& X_MB, const std::vector<int>& from,
                                       const EncounterCriteria& criteria) {
  ADIT_CHECK(X_MB.size() == chain.along_m.size());
  const ThinPath thin(chain, X_MB, criteria.near_m + thin_m);
  const Search search{chain, X_MB, directions(chain, X_MB), thin, criteria};
  std::vector<Encounter> found;
  for (int s : from) search.search(s, found);
  return found;
}

}  // namespace adit
