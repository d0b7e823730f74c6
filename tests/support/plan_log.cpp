// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/plan_log.h"

#include "base/parallel.h"
#include "base/rng.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double inf = std::numeric_limits<double>::infinity();
constexpr double lattice_m = 0.1;  // of the field whose zero line the ribs are
constexpr double margin_m = 3;

struct Box2 {
  Vec2 low{inf, inf}, high{-inf, -inf};
  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

double distance(const Vec2& p, const Segment& s) {
  const Vec2 d = s.b - s.a;
  const double t = std::clamp((p - s.a).dot(d) / std::max(d.squaredNorm(), 1e-12), 0.0, 1.0);
  return (p - s.a - t * d).norm();
}

// Normal numbers on a lattice, joined by a smooth step; the sum of squared weights is brought back to one.
double roughness(const Vec2& p, double scale_m, std::uint64_t seed) {
  const double u = p.x() / scale_m + 1e4, v = p.y() / scale_m + 1e4;
  const auto i = static_cast<std::uint64_t>(u), j = static_cast<std::uint64_t>(v);
  const auto step = [](double t) { return t * t * (3 - 2 * t); };
  const double fu = step(u - std::floor(u)), fv = step(v - std::floor(v));
  double sum = 0, squares = 0;
  for (int a = 0; a < 2; ++a)
    for (int b = 0; b < 2; ++b) {
      const double w = (a ? fu : 1 - fu) * (b ? fv : 1 - fv);
      sum += w * normal(seed, Draw::test, i + a, j + b);
      squares += w * w;
    }
  return sum / std::sqrt(squares);
}

// Distance to the nearest centre line less half a width, less the roughness: < 0 in the passages.
struct Field {
  Vec2 origin;
  int width, height;
  std::vector<double> value;
  double& at(int i, int j) { return value[static_cast<size_t>(j) * width + i]; }
  Vec2 node(int i, int j) const { return origin + lattice_m * Vec2(i, j); }
};

Field field_along(const std::vector<Segment>& lines, const PlanShape& shape, std::uint64_t seed) {
  Box2 box;
  for (const Segment& s : lines) box.add(s.a), box.add(s.b);
  const double reach = shape.width_m / 2 + 1;
  const Vec2 size = box.high - box.low + Vec2::Constant(2 * (reach + margin_m));
  Field f{box.low - Vec2::Constant(reach + margin_m),
          static_cast<int>(size.x() / lattice_m) + 1,
          static_cast<int>(size.y() / lattice_m) + 1,
          {}};
  f.value.assign(static_cast<size_t>(f.width) * f.height, 1.0);
  for (const Segment& s : lines) {
    Box2 near;
    near.add(s.a), near.add(s.b);
    const Vec2 low = (near.low - Vec2::Constant(reach) - f.origin) / lattice_m;
    const Vec2 high = (near.high + Vec2::Constant(reach) - f.origin) / lattice_m;
    for (int j = static_cast<int>(low.y()); j <= static_cast<int>(high.y()); ++j)
      for (int i = static_cast<int>(low.x()); i <= static_cast<int>(high.x()); ++i)
        f.at(i, j) = std::min(f.at(i, j), distance(f.node(i, j), s) - shape.width_m / 2);
  }
  if (shape.rough_rms_m > 0)
    parallel_for(f.height, [&](size_t j) {
      for (int i = 0; i < f.width; ++i)
        if (std::abs(f.at(i, static_cast<int>(j))) < 0.7)
          f.at(i, static_cast<int>(j)) -=
              shape.rough_rms_m * roughness(f.node(i, static_cast<int>(j)), shape.rough_scale_m, seed);
    });
  return f;
}

// Segments by the cells that they touch, for rays.
class RibIndex {
 public:
  explicit RibIndex(const Plan& plan) : ribs_(plan.ribs) {
    Box2 box;
    for (const Segment& s : ribs_) box.add(s.a), box.add(s.b);
    origin_ = box.low - Vec2::Constant(1);
    width_ = static_cast<int>((box.high.x() - origin_.x()) / cell_) + 2;
    height_ = static_cast<int>((box.high.y() - origin_.y()) / cell_) + 2;
    cells_.resize(static_cast<size_t>(width_) * height_);
    for (size_t s = 0; s < ribs_.size(); ++s) {
      Box2 near;
      near.add(ribs_[s].a), near.add(ribs_[s].b);
      const Vec2 low = (near.low - origin_) / cell_, high = (near.high - origin_) / cell_;
      for (int j = static_cast<int>(low.y()); j <= static_cast<int>(high.y()); ++j)
        for (int i = static_cast<int>(low.x()); i <= static_cast<int>(high.x()); ++i)
          cells_[static_cast<size_t>(j) * width_ + i].push_back(static_cast<int>(s));
    }
  }

  /// Range to the first rib, +inf if none.
  double cast(const Vec2& p, double angle_rad) const {
    const Vec2 d(std::cos(angle_rad), std::sin(angle_rad));
    int i = static_cast<int>((p.x() - origin_.x()) / cell_), j = static_cast<int>((p.y() - origin_.y()) / cell_);
    const int di = d.x() > 0 ? 1 : -1, dj = d.y() > 0 ? 1 : -1;
    double tx = d.x() == 0 ? inf : (origin_.x() + (i + (di > 0)) * cell_ - p.x()) / d.x();
    double ty = d.y() == 0 ? inf : (origin_.y() + (j + (dj > 0)) * cell_ - p.y()) / d.y();
    while (i >= 0 && j >= 0 && i < width_ && j < height_) {
      const double leave = std::min(tx, ty);
      double nearest = inf;
      for (const int s : cells_[static_cast<size_t>(j) * width_ + i]) nearest = std::min(nearest, hit(p, d, ribs_[s]));
      if (nearest <= leave + 1e-9) return nearest;
      if (tx < ty)
        i += di, tx += cell_ / std::abs(d.x());
      else
        j += dj, ty += cell_ / std::abs(d.y());
    }
    return inf;
  }

 private:
  static double hit(const Vec2& p, const Vec2& d, const Segment& s) {
    const Vec2 e = s.b - s.a, q = s.a - p;
    const double det = e.x() * d.y() - e.y() * d.x();
    if (det == 0) return inf;
    const double t = (e.x() * q.y() - e.y() * q.x()) / det, u = (d.x() * q.y() - d.y() * q.x()) / det;
    return t > 0 && u >= 0 && u <= 1 ? t : inf;
  }

  const std::vector<Segment>& ribs_;
  double cell_ = 0.5;
  Vec2 origin_;
  int width_, height_;
  std::vector<std::vector<int>> cells_;
};

// The line with its corners rounded (quadratic Bezier), every centimetre.
std::vector<Vec2> rounded(const std::vector<Vec2>& line, double corner_m) {
  std::vector<Vec2> out;
  const auto straight = [&](const Vec2& a, const Vec2& b) {
    const int n = std::max(1, static_cast<int>((b - a).norm() / 0.01));
    for (int k = 0; k < n; ++k) out.push_back(a + (b - a) * k / n);
  };
  Vec2 from = line.front();
  for (size_t i = 1; i + 1 < line.size(); ++i) {
    const Vec2 before = line[i] - corner_m * (line[i] - line[i - 1]).normalized();
    const Vec2 after = line[i] + corner_m * (line[i + 1] - line[i]).normalized();
    straight(from, before);
    const int n = static_cast<int>(1.7 * corner_m / 0.01);
    for (int k = 0; k < n; ++k) {
      const double t = static_cast<double>(k) / n;
      out.push_back((1 - t) * (1 - t) * before + 2 * t * (1 - t) * line[i] + t * t * after);
    }
    from = after;
  }
  straight(from, line.back());
  return out;
}

// Where the cart is at a distance along the line, swaying.
class Path {
 public:
  Path(const std::vector<Vec2>& line, const TourSettings& s) : sway_m_(s.sway_m), at_(rounded(line, s.corner_m)) {
    along_.assign(at_.size(), 0);
    for (size_t i = 1; i < at_.size(); ++i) along_[i] = along_[i - 1] + (at_[i] - at_[i - 1]).norm();
  }
  double length_m() const { return along_.back(); }
  Pose2 at(double s_m) const {
    const Vec2 ahead = swayed(s_m + 0.15), behind = swayed(s_m - 0.15), p = swayed(s_m);
    return {p.x(), p.y(), std::atan2(ahead.y() - behind.y(), ahead.x() - behind.x())};
  }

 private:
  Vec2 on_line(double s_m) const {
    const double s = std::clamp(s_m, 0.0, along_.back());
    const size_t hi =
        std::clamp<size_t>(std::lower_bound(along_.begin(), along_.end(), s) - along_.begin(), 1, at_.size() - 1);
    const Vec2 step = at_[hi] - at_[hi - 1];
    return at_[hi - 1] + step * (s - along_[hi - 1]) / (along_[hi] - along_[hi - 1]) + step.normalized() * (s_m - s);
  }
  Vec2 swayed(double s_m) const {
    const Vec2 d = (on_line(s_m + 0.5) - on_line(s_m - 0.5)).normalized();
    return on_line(s_m) + sway_m_ * std::sin(s_m * 2 * pi / 7.3) * Vec2(-d.y(), d.x());
  }
  double sway_m_;
  std::vector<Vec2> at_;
  std::vector<double> along_;
};

// Distance driven at a time: the integral of the speed, standing still for the stop.
double driven_m(double t_s, const TourSettings& s) {
  const auto moved = [&](double t) {
    const double w = 2 * pi / 9;
    return s.speed_m_s * (t + s.speed_swing / w * (1 - std::cos(w * t)));
  };
  if (s.stop_at_m < 0 || moved(t_s) < s.stop_at_m) return moved(t_s);
  if (moved(t_s - s.stop_s) < s.stop_at_m) return s.stop_at_m;
  return moved(t_s - s.stop_s);
}

}  // namespace

Plan plan_along(const std::vector<Segment>& centre_lines, const PlanShape& shape, std::uint64_t seed) {
  Field f = field_along(centre_lines, shape, seed);
  Plan plan;
  for (int j = 0; j + 1 < f.height; ++j)
    for (int i = 0; i + 1 < f.width; ++i) {
      // Marching squares: the zero crossings of the four sides, in the order of the sides.
      const std::array<Vec2, 4> p{f.node(i, j), f.node(i + 1, j), f.node(i + 1, j + 1), f.node(i, j + 1)};
      const std::array<double, 4> v{f.at(i, j), f.at(i + 1, j), f.at(i + 1, j + 1), f.at(i, j + 1)};
      std::vector<Vec2> cut;
      for (int k = 0; k < 4; ++k)
        if ((v[k] < 0) != (v[(k + 1) % 4] < 0))
          cut.push_back(p[k] + (p[(k + 1) % 4] - p[k]) * v[k] / (v[k] - v[(k + 1) % 4]));
      for (size_t k = 0; k + 1 < cut.size(); k += 2) plan.ribs.push_back({cut[k], cut[k + 1]});
    }
  return plan;
}

std::vector<Segment> panel_lines(int entries, int crosscuts, double pitch_m) {
  std::vector<Segment> lines;
  for (int k = 0; k < entries; ++k)
    lines.push_back({Vec2(0, k * pitch_m), Vec2((crosscuts - 1) * pitch_m, k * pitch_m)});
  for (int k = 0; k < crosscuts; ++k)
    lines.push_back({Vec2(k * pitch_m, 0), Vec2(k * pitch_m, (entries - 1) * pitch_m)});
  return lines;
}

Mount plan_mount(int beams, double interval_s, double noise_m) {
  Mount m;
  m.name = "front";
  m.laser.name = "planar";
  m.laser.fov_rad = pi;
  m.laser.beams = beams;
  m.laser.turn_s = 0.01332;
  m.laser.interlace = beams > 181 ? 2 : 1;
  m.laser.interval_s = interval_s;
  m.laser.range_max_m = 32;
  m.laser.resolution_m = 0.001;
  m.laser.sigma_m = noise_m;
  m.X_BS = pose_of({0.35, 0.02, 0.7}, 0.01);
  return m;
}

PlanLog drive_plan(const Plan& plan, const std::vector<Vec2>& line, const TourSettings& s, std::uint64_t seed) {
  const RibIndex ribs(plan);
  const Path path(line, s);
  PlanLog log;
  log.mount = plan_mount(s.beams, s.interval_s, s.noise_m);
  log.scans.beams = s.beams;
  const Pose2 X_BS = flatten(log.mount.X_BS);
  const auto X_WB = [&](double t_s) { return path.at(driven_m(t_s, s)); };
  for (double t = 0; driven_m(t, s) < path.length_m(); t += s.interval_s) {
    log.scans.stamp_s.push_back(t);
    log.X_WB.push_back(X_WB(t));
  }
  log.scans.range_m.resize(log.scans.size() * s.beams);
  parallel_for(
      log.scans.size(),
      [&](size_t i) {
        for (int k = 0; k < s.beams; ++k) {
          const double offset_s = s.moving_beams ? log.mount.laser.beam_offset_s(k) : 0;
          const Pose2 X_WS = X_WB(log.scans.stamp_s[i] + offset_s) * X_BS;
          double r = ribs.cast(X_WS.position(), X_WS.yaw_rad + log.mount.laser.beam_angle_rad(k));
          r += s.noise_m * normal(seed, Draw::beam_range, i, k);
          if (r > log.mount.laser.range_max_m) r = inf;
          if (uniform(seed, Draw::beam_drop, i, k) < s.drop_share) r = std::numeric_limits<double>::quiet_NaN();
          log.scans.range_m[i * s.beams + k] = static_cast<float>(r);
        }
      },
      16);
  return log;
}

PlanLog loop_tour(const PlanShape& shape, const TourSettings& settings, std::uint64_t seed) {
  const double d = 18;
  const Plan plan = plan_along(panel_lines(3, 3, d), shape, seed);
  const std::vector<Vec2> line{{2, 0},     {2 * d, 0}, {2 * d, d}, {0, d},         {0, 0},     {d, 0}, {d, 2 * d},
                               {0, 2 * d}, {0, d},     {2 * d, d}, {2 * d, 2 * d}, {d, 2 * d}, {d, 2}};
  return drive_plan(plan, line, settings, seed);
}

}  // namespace adit
