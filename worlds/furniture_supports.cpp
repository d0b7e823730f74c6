// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/furnisher.h"

#include <algorithm>
#include <cmath>

namespace adit {

// Rows along both ribs.
void Furnisher::add_posts(const Way& way) {
  std::uint64_t k = 1;
  for (double s = way.from_m; s < way.to_m; s += s_.post_spacing_m, k += 8) {
    for (int side = 0; side < 2; ++side) {
      ask(Label::post);
      const std::uint64_t j = k + 4 * static_cast<std::uint64_t>(side);
      const Spot spot = way.at(s + lot(posts, j, -0.1, 0.1));
      const double sign = side ? -1 : 1, radius = lot(posts, j + 1, 0.075, 0.1);
      const double off = free_m(space_, spot, sign, {0.1, 0.3, 0.5, 0.7, 0.9}) - lot(posts, j + 2, 0.28, 0.5);
      if (off - radius < lane(way, s) || !std::isfinite(off)) continue;
      put(Label::post, post(space_, spot.beside(sign * off), spot.along, radius), yaw_of(spot.along));
    }
  }
}

void Furnisher::add_crossbars(const Way& way) {
  std::uint64_t k = 1;
  for (double s = way.from_m + 0.3; s < way.to_m - 0.2; s += s_.crossbar_spacing_m, ++k) {
    ask(Label::crossbar);
    const Spot spot = way.at(s + lot(crossbars, k, -0.08, 0.08));
    const std::vector<double> shares{0.08, 0.3, 0.5, 0.7, 0.85, 0.97};
    const double left = free_m(space_, spot, 1, shares) - 0.12, right = -free_m(space_, spot, -1, shares) + 0.12;
    if (std::min(left, -right) - 0.3 < lane(way, s) || !(left - right < 30)) continue;
    put(Label::crossbar, crossbar(space_, spot, right, left), yaw_of(spot.left()));
  }
}

void Furnisher::add_cribs(const Way& way) {
  const int n = count(cribs, s_.cribs_per_100m, way);
  ask(Label::crib, n);
  for (int i = 0; i < n; ++i) {
    const std::uint64_t k = 1 + 8 * static_cast<std::uint64_t>(i);
    const double s = lot(cribs, k, way.from_m + 0.5, way.to_m - 0.5);
    const Spot spot = way.at(s);
    const double side = lot(cribs, k + 1, 0.75, 0.9), sign = lot(cribs, k + 2) < 0.5 ? -1 : 1;
    const double off = free_m(space_, spot, sign, {0.3, 0.5, 0.7, 0.9}) - 0.06 - 0.5 * side;
    if (off - 0.5 * side < lane(way, s) || !std::isfinite(off)) continue;
    const double turn = lot(cribs, k + 3, -0.12, 0.12);
    const Vec2 along = Eigen::Rotation2Dd(turn) * spot.along;
    put(Label::crib, crib(space_, spot.beside(sign * off), along, side), yaw_of(along));
  }
}

void Furnisher::add_bolts(const Way& way) {
  const double width = plan_.plan.passages[passage_].width_m;
  const int rows = std::max(1, static_cast<int>((width - 0.6) / s_.bolt_spacing_m) + 1);
  std::uint64_t k = 1;
  for (double s = way.from_m; s < way.to_m; s += s_.bolt_spacing_m)
    for (int r = 0; r < rows; ++r, k += 2) {
      ask(Label::bolt);
      const Spot spot = way.at(s + lot(bolts, k, -0.08, 0.08));
      const Vec2 p = spot.beside((r - 0.5 * (rows - 1)) * s_.bolt_spacing_m + lot(bolts, k + 1, -0.08, 0.08));
      put(Label::bolt, bolt(space_, p, spot.along), yaw_of(spot.along));
    }
}

}  // namespace adit
