// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground.h"

#include "base/error.h"

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

constexpr double cell_min_m = 0.5;

struct Span {
  long x0, x1, y0, y1;
};

}  // namespace

Floor::Floor(const Mesh& mesh) : mesh_(mesh) {
  std::vector<std::uint32_t> floor;
  for (size_t f = 0; f < mesh.face.size(); ++f)
    if (mesh.label.empty() || is_ground(mesh.label[f])) floor.push_back(static_cast<std::uint32_t>(f));
  if (floor.empty()) return;
  low_ = mesh.corner(floor[0], 0).head<2>();
  Vec2 high = low_;
  for (const std::uint32_t f : floor)
    for (int k = 0; k < 3; ++k) {
      low_ = low_.cwiseMin(mesh.corner(f, k).head<2>());
      high = high.cwiseMax(mesh.corner(f, k).head<2>());
    }
  // Never more squares than faces, so that the grid stays small beside the mesh.
  const Vec2 size = high - low_;
  cell_m_ = std::max(cell_min_m, std::sqrt(size.x() * size.y() / static_cast<double>(floor.size())));
  nx_ = static_cast<long>(size.x() / cell_m_) + 1;
  ny_ = static_cast<long>(size.y() / cell_m_) + 1;
  const auto span = [&](std::uint32_t f) {
    const Vec2 a = mesh.corner(f, 0).head<2>(), b = mesh.corner(f, 1).head<2>(), c = mesh.corner(f, 2).head<2>();
    const Vec2 from = (a.cwiseMin(b).cwiseMin(c) - low_) / cell_m_, to = (a.cwiseMax(b).cwiseMax(c) - low_) / cell_m_;
    return Span{static_cast<long>(from.x()), static_cast<long>(to.x()), static_cast<long>(from.y()),
                static_cast<long>(to.y())};
  };
  const auto each = [&](auto&& take) {
    for (const std::uint32_t f : floor) {
      const Span s = span(f);
      for (long y = s.y0; y <= s.y1; ++y)
        for (long x = s.x0; x <= s.x1; ++x) take(static_cast<size_t>(y * nx_ + x), f);
    }
  };
  begin_.assign(static_cast<size_t>(nx_ * ny_) + 1, 0);
  each([&](size_t square, std::uint32_t) { ++begin_[square + 1]; });
  for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  face_.resize(begin_.back());
  std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
  each([&](size_t square, std::uint32_t f) { face_[next[square]++] = f; });
}

std::optional<double> Floor::height_m(const Vec2& p_W) const {
  std::optional<double> height;
  const Vec2 at = (p_W - low_) / cell_m_;
  if (!(at.minCoeff() >= 0) || at.x() >= static_cast<double>(nx_) || at.y() >= static_cast<double>(ny_)) return height;
  const auto square = static_cast<size_t>(static_cast<long>(at.y()) * nx_ + static_cast<long>(at.x()));
  for (std::uint32_t i = begin_[square]; i < begin_[square + 1]; ++i) {
    const Vec3 a = mesh_.corner(face_[i], 0), b = mesh_.corner(face_[i], 1), c = mesh_.corner(face_[i], 2);
    const Vec2 ab = (b - a).head<2>(), ac = (c - a).head<2>(), ap = p_W - a.head<2>();
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area == 0) continue;
    const double s = (ap.x() * ac.y() - ap.y() * ac.x()) / area, t = (ab.x() * ap.y() - ab.y() * ap.x()) / area;
    constexpr double slack = 1e-12;  // a point on an edge belongs to both faces
    if (s < -slack || t < -slack || s + t > 1 + slack) continue;
    const double z = a.z() + s * (b - a).z() + t * (c - a).z();
    height = std::max(z, height.value_or(z));
  }
  return height;
}

GroundHeight height_of(const Floor& floor) {
  return [&floor](const Vec2& p_W, double) { return floor.height_m(p_W); };
}

Pose stand_on(const GroundHeight& ground, const Vehicle& vehicle, const Vec2& p_W, double yaw_rad) {
  const Eigen::Rotation2Dd R(yaw_rad);
  const auto height = [&](const Vec2& p_B, double radius_m, const std::string& what) {
    const Vec2 p = p_W + R * p_B;
    const std::optional<double> z = ground(p, radius_m);
    if (z) return *z;
    char text[200];
    std::snprintf(text, sizeof text,
                  "no floor at (%.2f, %.2f) m: %s %s would stand in rock; start in a passage, off its ribs", p.x(),
                  p.y(), vehicle.name.c_str(), what.c_str());
    throw Error(text);
  };
  Eigen::MatrixXd plane(vehicle.wheels.size(), 3);
  Eigen::VectorXd z(vehicle.wheels.size());
  for (size_t k = 0; k < vehicle.wheels.size(); ++k) {
    const Wheel& wheel = vehicle.wheels[k];
    plane.row(static_cast<Eigen::Index>(k)) << 1, wheel.position_B.x(), wheel.position_B.y();
    z[static_cast<Eigen::Index>(k)] = height(wheel.position_B, wheel.radius_m, wheel.name);
  }
  for (const Box& box : vehicle.solid)
    for (const double x : {box.min_B.x(), box.max_B.x()})
      for (const double y : {box.min_B.y(), box.max_B.y()}) height({x, y}, 0, box.name);
  const Vec3 fit = plane.colPivHouseholderQr().solve(z);  // height, slope along x, slope along y
  const double lift = std::max(0.0, (z - plane * fit).maxCoeff());
  return pose_of({p_W.x(), p_W.y(), fit[0] + lift}, yaw_rad, -std::atan(fit[1]), std::atan(fit[2]));
}

}  // namespace adit
