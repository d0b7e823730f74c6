// SPDX-License-Identifier: BSD-3-Clause
#include "sim/ground.h"

#include "base/error.h"

#include <Eigen/LU>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {

std::optional<double> floor_height_m(const Mesh& floor, const Vec2& p_W) {
  std::optional<double> height;
  for (size_t f = 0; f < floor.face.size(); ++f) {
    const Vec3 a = floor.corner(f, 0), b = floor.corner(f, 1), c = floor.corner(f, 2);
    Eigen::Matrix2d sides;
    sides << (b - a).head<2>(), (c - a).head<2>();
    const double area = sides.determinant();
    if (area == 0) continue;
    const Vec2 s = sides.inverse() * (p_W - a.head<2>());
    if (s.minCoeff() < 0 || s.sum() > 1) continue;
    const double z = a.z() + s.x() * (b - a).z() + s.y() * (c - a).z();
    height = std::max(z, height.value_or(z));
  }
  return height;
}

Pose stand_on(const Mesh& floor, const Vehicle& vehicle, const Vec2& p_W, double yaw_rad) {
  const Eigen::Rotation2Dd R(yaw_rad);
  const auto height = [&](const Vec2& p_B, const std::string& what) {
    const Vec2 p = p_W + R * p_B;
    const std::optional<double> z = floor_height_m(floor, p);
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
    const Vec2 p_B = vehicle.wheels[k].position_B;
    plane.row(static_cast<Eigen::Index>(k)) << 1, p_B.x(), p_B.y();
    z[static_cast<Eigen::Index>(k)] = height(p_B, vehicle.wheels[k].name);
  }
  for (const Box& box : vehicle.solid)
    for (const double x : {box.min_B.x(), box.max_B.x()})
      for (const double y : {box.min_B.y(), box.max_B.y()}) height({x, y}, box.name);
  const Vec3 fit = plane.colPivHouseholderQr().solve(z);  // height, slope along x, slope along y
  const double lift = std::max(0.0, (z - plane * fit).maxCoeff());
  return pose_of({p_W.x(), p_W.y(), fit[0] + lift}, yaw_rad, -std::atan(fit[1]), std::atan(fit[2]));
}

}  // namespace adit
