// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/furnisher.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double gauge_m = 1.067;

}  // namespace

// Ties, then rails over the highest of them.
void Furnisher::add_track(const Way& way) {
  constexpr double length = 3, gap = 0.6;
  const auto pieces = static_cast<int>((way.to_m - way.from_m) / length);
  for (int i = 0; i < pieces; ++i) {
    ask(Label::tie, 5);
    ask(Label::rail, 2);
    const double begin = way.from_m + i * length;
    const Spot from = way.at(begin + 0.01), to = way.at(begin + length - 0.01);
    std::vector<std::pair<double, double>> tops;  // along, height
    for (int j = 0; j < 5; ++j) {
      const std::uint64_t k = 1 + 16 * static_cast<std::uint64_t>(i) + 2 * static_cast<std::uint64_t>(j);
      const double s = begin + gap * (j + 0.5) + lot(track, k, -0.05, 0.05);
      Spot spot = way.at(s);
      spot.along = Eigen::Rotation2Dd(lot(track, k + 1, -0.05, 0.05)) * spot.along;
      double top = 0;
      if (put(Label::tie, tie(space_, spot, 0.85, &top), yaw_of(spot.left()))) tops.emplace_back(s - begin, top);
    }
    if (tops.size() < 2) continue;
    for (double side : {-0.5, 0.5}) add_rail(from.beside(side * gauge_m), to.beside(side * gauge_m), tops, length);
  }
}

// A straight bar over all of its ties and the floor, as low as it can lie.
void Furnisher::add_rail(const Vec2& from, const Vec2& to, const std::vector<std::pair<double, double>>& tops,
                         double length) {
  const auto a = space_.level(from), b = space_.level(to);
  if (!a || !b) return;
  const double slope = (tops.back().second - tops.front().second) / (tops.back().first - tops.front().first);
  double lift = -1e9;
  for (const auto& [s, z] : tops) lift = std::max(lift, z - slope * s);
  for (double share = 0; share <= 1; share += 0.05)
    if (const auto here = space_.level(from + share * (to - from)))
      lift = std::max(lift, here->floor_z - slope * share * length);
  for (double more : {0.004, 0.012, 0.03})
    if (put(Label::rail, rail(from, to, lift + more, lift + more + slope * length), yaw_of(to - from))) return;
}

void Furnisher::add_belt(const Way& way) {
  constexpr double length = 3;
  const double sign = lot(belts, 1) < 0.5 ? -1 : 1;
  for (double s = way.from_m + 0.5 * length; s + 0.5 * length < way.to_m; s += length) {
    ask(Label::belt);
    Spot spot = way.at(s);
    double off = 1e9;
    for (double ds : {-1.4, -0.7, 0.0, 0.7, 1.4})
      off = std::min(off, free_m(space_, way.at(s + ds), sign, {0.35, 0.45}) - 0.72);
    const double clear = std::max(lane(way, s - 0.5 * length), lane(way, s + 0.5 * length));
    if (off - 0.66 < clear || !std::isfinite(off)) continue;
    spot.p = spot.beside(sign * std::min(off, clear + 0.75));
    put(Label::belt, belt(space_, spot, length), yaw_of(spot.along));
  }
}

// Along a rib, hung from it: as near to it as its humps let it.
void Furnisher::add_line(const Way& way, What what) {
  const bool pipe = what == pipes;
  const double sign = lot(what, 1) < 0.5 ? -1 : 1, radius = pipe ? lot(what, 2, 0.04, 0.12) : lot(what, 2, 0.02, 0.035);
  const double share = pipe ? lot(what, 3, 0.55, 0.75) : 0.88;
  constexpr double step = 0.5;
  const auto n = static_cast<int>((way.to_m - way.from_m) / step);
  std::vector<double> room(static_cast<size_t>(std::max(0, n)) + 1);
  for (int i = 0; i <= n; ++i)
    room[i] = free_m(space_, way.at(way.from_m + i * step), sign, {share - 0.06, share, share + 0.05});
  const auto least = [&](int i) {
    double r = 1e9;
    for (int j = std::max(0, i - 2); j <= std::min(n, i + 2); ++j) r = std::min(r, room[j]);
    return r;
  };
  const auto point = [&](int i) -> std::optional<Vec3> {
    double off = 0;
    for (int j = i - 1; j <= i + 1; ++j) off += least(std::clamp(j, 0, n)) / 3;
    off -= radius + 0.05;
    const Spot spot = way.at(way.from_m + i * step);
    const Vec2 p = spot.beside(sign * off);
    const auto here = space_.level(spot.p);
    if (!here || off < lane() || off > 6) return std::nullopt;
    double z = here->floor_z + share * (here->roof_z - here->floor_z);
    if (!pipe) z -= 0.12 * std::sin(std::numbers::pi * std::fmod(i * step, 3.0) / 3.0);
    return Vec3(p.x(), p.y(), z);
  };
  constexpr int pieces = 6;  // of a length
  const Label label = pipe ? Label::pipe : Label::cable;
  for (int i = 0; i + pieces <= n; i += pieces) {
    ask(label);
    std::vector<Vec3> line;
    for (int j = i; j <= i + pieces; ++j)
      if (const auto p = point(j)) line.push_back(*p);
    if (line.size() != pieces + 1) continue;
    line.front() += 0.004 * (line[1] - line[0]).normalized();
    line.back() -= 0.004 * (line[pieces] - line[pieces - 1]).normalized();
    Bodies bodies{tube_along(line, radius, pipe ? 10 : 6)};
    bodies[0].material = pipe ? Material::steel : Material::none;
    put(label, std::move(bodies), yaw_of((line.back() - line.front()).head<2>()));
  }
}

void Furnisher::add_car(const Way& way, double s) {
  ask(Label::car);
  const Spot spot = way.at(s);
  double high = -1e9;
  for (double x : {-0.55, 0.0, 0.55})
    for (double y : {-0.535, 0.535})
      if (const auto here = space_.level(spot.beside(y) + x * spot.along)) high = std::max(high, here->floor_z);
  const auto back = space_.level(spot.p - spot.along), front = space_.level(spot.p + spot.along);
  if (!back || !front) return;
  const double pitch = std::atan2(front->floor_z - back->floor_z, 2);
  for (double lift : {0.01, 0.03, 0.06, 0.1})
    if (put(Label::car, car(spot, high + lift, pitch), yaw_of(spot.along), true)) return;
}

}  // namespace adit
