// SPDX-License-Identifier: BSD-3-Clause
#include "tests/mapper/open_loop.h"

#include "base/rng.h"
#include "mapper/closures.h"

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi, step_m = 0.15, corner_m = 2;

double between_lines(double a_rad, double b_rad) {
  const double d = std::abs(wrap_angle(a_rad - b_rad));
  return std::min(d, pi - d);
}

/// The polyline with its corners cut twice (Chaikin's rule on points near them), every step_m.
std::vector<Vec2> rounded(const std::vector<Vec2>& line) {
  std::vector<Vec2> coarse{line.front()};
  for (size_t i = 1; i + 1 < line.size(); ++i) {
    const Vec2 a = line[i] + corner_m * (line[i - 1] - line[i]).normalized(),
               b = line[i] + corner_m * (line[i + 1] - line[i]).normalized();
    for (int k = 0; k <= 8; ++k) {
      const double s = k / 8.0;
      coarse.push_back((1 - s) * (1 - s) * a + 2 * s * (1 - s) * line[i] + s * s * b);
    }
  }
  coarse.push_back(line.back());
  std::vector<Vec2> fine;
  double rest_m = 0;
  for (size_t i = 0; i + 1 < coarse.size(); ++i) {
    const double length_m = (coarse[i + 1] - coarse[i]).norm();
    for (; rest_m < length_m; rest_m += step_m)
      fine.push_back(coarse[i] + rest_m / length_m * (coarse[i + 1] - coarse[i]));
    rest_m -= length_m;
  }
  return fine;
}

std::vector<Pose2> true_path(const std::vector<Vec2>& line, std::uint64_t seed) {
  const std::vector<Vec2> p = rounded(line);
  const double a = 2 * pi * uniform(seed, Draw::test, 1), b = 2 * pi * uniform(seed, Draw::test, 2);
  std::vector<Vec2> swayed(p.size());
  for (size_t i = 0; i < p.size(); ++i) {
    const Vec2 t = (p[std::min(i + 1, p.size() - 1)] - p[i > 0 ? i - 1 : 0]).normalized();
    const double s = i * step_m, sway_m = 0.17 * std::sin(2 * pi * s / 17 + a) + 0.08 * std::sin(2 * pi * s / 7.3 + b);
    swayed[i] = p[i] + sway_m * Vec2(-t.y(), t.x());
  }
  std::vector<Pose2> X;
  for (size_t i = 0; i + 1 < p.size(); ++i) {
    const Vec2 t = swayed[i + 1] - swayed[i];
    X.push_back(
        {swayed[i].x(), swayed[i].y(), wrap_angle(std::atan2(t.y(), t.x()) + 0.02 * std::sin(2 * pi * i / 40.0))});
  }
  const Pose2 first = X.front().inverse();
  for (Pose2& x : X) x = first * x;
  return X;
}

Odometry odometry_of(const std::vector<Pose2>& X_true, const Drift& drift, std::uint64_t seed) {
  Odometry o;
  const double least = 1e-6;  // a perfect front end still states a finite information
  const double along = std::max(drift.along_m, least), across = std::max(drift.across_m, least),
               yaw = std::max(drift.yaw_rad, least);
  const Eigen::Matrix3d information =
      Eigen::Vector3d(1 / (along * along), 1 / (across * across), 1 / (yaw * yaw)).asDiagonal();
  for (size_t i = 0; i < X_true.size(); ++i) {
    Pose2 step = i > 0 ? X_true[i - 1].inverse() * X_true[i] : Pose2{};
    if (i > 0) {
      const Pose2 e{drift.along_m * normal(seed, Draw::test, 10, i) + drift.scale * step.x_m,
                    drift.across_m * normal(seed, Draw::test, 11, i), drift.yaw_rad * normal(seed, Draw::test, 12, i)};
      step = step * e;
    }
    o.stamp_s.push_back(0.2 * i);
    o.X_step.push_back(step);
    o.X_MB.push_back(i > 0 ? o.X_MB.back() * step : Pose2{});
    o.information.push_back(information);
  }
  return o;
}

OpenLoop walk(const std::vector<Vec2>& line, const Drift& drift, std::uint64_t seed) {
  OpenLoop loop;
  loop.X_true = true_path(line, seed);
  loop.odometry = odometry_of(loop.X_true, drift, seed);
  return loop;
}

}  // namespace

OpenLoop walk_panel(int side, double pitch_m, int legs, const Drift& drift, std::uint64_t seed) {
  std::vector<Vec2> line{{0, 0}, {pitch_m, 0}};
  int x = 1, y = 0, dx = 1, dy = 0;
  for (int leg = 1; leg < legs; ++leg) {
    for (std::uint64_t attempt = 0;; ++attempt) {
      const int turn = static_cast<int>(3 * uniform(seed, Draw::test, 3, leg * 1000 + attempt)) - 1;
      const int nx = turn == 0 ? dx : -turn * dy, ny = turn == 0 ? dy : turn * dx;
      if (x + nx < 0 || y + ny < 0 || x + nx >= side || y + ny >= side) continue;
      dx = nx, dy = ny, x += dx, y += dy;
      break;
    }
    line.push_back(pitch_m * Vec2(x, y));
  }
  return walk(line, drift, seed);
}

OpenLoop walk_ring(double side_m, int laps, const Drift& drift, std::uint64_t seed) {
  std::vector<Vec2> line{{side_m / 2, 0}};
  for (int lap = 0; lap < laps; ++lap)
    for (const Vec2& corner : {Vec2(1, 0), Vec2(1, 1), Vec2(0, 1), Vec2(0, 0)}) line.push_back(side_m * corner);
  line.push_back({side_m / 2, 0});
  return walk(line, drift, seed);
}

double ate_m(const std::vector<Pose2>& X_true, const std::vector<Pose2>& X) {
  Vec2 from = Vec2::Zero(), to = Vec2::Zero();
  for (size_t i = 0; i < X.size(); ++i) from += X[i].position() / X.size(), to += X_true[i].position() / X.size();
  double cosine = 0, sine = 0, sum = 0;
  for (size_t i = 0; i < X.size(); ++i) {
    const Vec2 a = X[i].position() - from, b = X_true[i].position() - to;
    cosine += a.dot(b);
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const Eigen::Rotation2Dd R(std::atan2(sine, cosine));
  for (size_t i = 0; i < X.size(); ++i)
    sum += (R * (X[i].position() - from) - (X_true[i].position() - to)).squaredNorm();
  return std::sqrt(sum / X.size());
}

int wrong_places(const std::vector<Closure>& closures, const std::vector<Pose2>& X_true) {
  int wrong = 0;
  for (const Closure& c : closures)
    if (c.accepted)
      wrong += (X_true[c.i].position() - X_true[c.j].position()).norm() > 3 ||
               between_lines(X_true[c.i].yaw_rad, X_true[c.j].yaw_rad) > pi / 6;
  return wrong;
}

double recall(const std::vector<Closure>& closures, const std::vector<Pose2>& X_true) {
  std::vector<double> way_m(X_true.size(), 0);
  for (size_t i = 1; i < X_true.size(); ++i)
    way_m[i] = way_m[i - 1] + (X_true[i].position() - X_true[i - 1].position()).norm();
  int met = 0, closed = 0;
  double next_m = 0;
  for (size_t j = 0; j < X_true.size(); ++j) {
    if (way_m[j] < next_m) continue;
    next_m = way_m[j] + 5;
    bool meets = false, has = false;
    for (size_t i = 0; i < j && way_m[i] < way_m[j] - 20 && !meets; ++i)
      meets = (X_true[i].position() - X_true[j].position()).norm() < 2.0 &&
              between_lines(X_true[i].yaw_rad, X_true[j].yaw_rad) < pi / 12;
    for (const Closure& c : closures) has = has || (c.accepted && std::abs(way_m[c.j] - way_m[j]) < 5);
    met += meets;
    closed += meets && has;
  }
  return met > 0 ? double(closed) / met : 1;
}

}  // namespace adit
