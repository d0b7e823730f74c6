// SPDX-License-Identifier: BSD-3-Clause
#include "tests/sim/terrain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {

World terrain_world(const Vec2& low, const Vec2& high, double cell_m,
                    const std::function<double(const Vec2&)>& height) {
  World world;
  world.name = "terrain";
  const int nx = std::max(1, static_cast<int>(std::lround((high.x() - low.x()) / cell_m)));
  const int ny = std::max(1, static_cast<int>(std::lround((high.y() - low.y()) / cell_m)));
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      const Vec2 p = low + Vec2((high.x() - low.x()) * i / nx, (high.y() - low.y()) * j / ny);
      world.mesh.vertex.push_back({p.x(), p.y(), height(p)});
    }
  const auto index = [&](int i, int j) { return static_cast<std::uint32_t>(j * (nx + 1) + i); };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {  // clockwise from above: out of the void, into the rock
      world.mesh.face.push_back({index(i, j), index(i + 1, j + 1), index(i + 1, j)});
      world.mesh.face.push_back({index(i, j), index(i, j + 1), index(i + 1, j + 1)});
    }
  world.mesh.label.assign(world.mesh.face.size(), Label::floor);
  world.mesh.part.assign(world.mesh.face.size(), 0);
  return world;
}

void add_wall(World& world, double x_m, double y_low_m, double y_high_m, double z_m) {
  const auto first = static_cast<std::uint32_t>(world.mesh.vertex.size());
  for (const double z : {z_m, z_m + 2})
    for (const double y : {y_low_m, y_high_m}) world.mesh.vertex.push_back({x_m, y, z});
  world.mesh.face.push_back({first, first + 1, first + 3});
  world.mesh.face.push_back({first, first + 3, first + 2});
  world.mesh.label.resize(world.mesh.face.size(), Label::rib);
  world.mesh.part.resize(world.mesh.face.size(), 7);
}

Route route_through(const std::vector<Vec2>& corners, double radius_m) {
  Route route;
  const auto straight_to = [&](const Vec2& to) {
    if (route.line.empty()) return route.line.push_back(to);
    const Vec2 from = route.line.back();
    const int n = std::max(1, static_cast<int>(std::ceil((to - from).norm() / 0.25)));
    for (int i = 1; i <= n; ++i) route.line.push_back(from + (to - from) * i / n);
  };
  straight_to(corners.front());
  for (size_t k = 1; k + 1 < corners.size(); ++k) {
    const Vec2 in = (corners[k] - corners[k - 1]).normalized(), out = (corners[k + 1] - corners[k]).normalized();
    const double turn = std::atan2(in.x() * out.y() - in.y() * out.x(), in.dot(out));
    const double cut = radius_m * std::tan(std::abs(turn) / 2), side = turn > 0 ? 1 : -1;
    const Vec2 begin = corners[k] - cut * in, centre = begin + side * radius_m * Vec2(-in.y(), in.x());
    straight_to(begin);
    const int n = static_cast<int>(std::ceil(radius_m * std::abs(turn) / 0.25));
    for (int i = 1; i <= n; ++i) route.line.push_back(centre + Eigen::Rotation2Dd(turn * i / n) * (begin - centre));
  }
  if (corners.size() > 1) straight_to(corners.back());
  for (size_t i = 1; i < route.line.size(); ++i) route.length_m += (route.line[i] - route.line[i - 1]).norm();
  return route;
}

Route three_point_route(double from_m, double turn_at_m, double radius_m) {
  Route route = route_through({{from_m, 0}, {turn_at_m, 0}}, 0);
  const double third = std::numbers::pi / 3;
  const int n = std::max(3, static_cast<int>(std::ceil(radius_m * third / 0.25)));
  Pose2 X_WA{turn_at_m, 0, 0};
  for (const double way : {1.0, -1.0, 1.0}) {
    const int first = static_cast<int>(route.line.size()) - 1;
    for (int k = 1; k <= n; ++k) {  // the nose turns left all the time
      const double phi = third / n, chord = way * 2 * radius_m * std::sin(phi / 2);
      X_WA = X_WA * Pose2{chord * std::cos(phi / 2), chord * std::sin(phi / 2), phi};
      route.line.push_back(X_WA.position());
    }
    if (way < 0) route.backwards.push_back({first, static_cast<int>(route.line.size()) - 1});
  }
  for (double x = turn_at_m - 0.25; x >= from_m; x -= 0.25) route.line.push_back({x, 0});
  route.length_m = 0;
  for (size_t i = 1; i < route.line.size(); ++i) route.length_m += (route.line[i] - route.line[i - 1]).norm();
  return route;
}

double cross_track_m(const Trajectory& path, const Route& route) {
  double worst = 0;
  for (const Pose& X_WB : path.X_WB) {
    const Vec2 p = X_WB.translation().head<2>();
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = 1; i < route.line.size(); ++i) {
      const Vec2 a = route.line[i - 1], d = route.line[i] - a;
      const double s = std::clamp((p - a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (p - a - s * d).norm());
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

}  // namespace adit
