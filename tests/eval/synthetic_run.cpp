// SPDX-License-Identifier: BSD-3-Clause
#include "tests/eval/synthetic_run.h"

#include "base/rng.h"
#include "rays/caster.h"
#include "tests/support/shapes.h"

#include <cmath>
#include <numbers>

namespace adit {

namespace {

constexpr double outer_m = 44, width_m = 4, height_m = 2.2;

Vec3 undulating(const Vec3& p) {
  Vec3 q = p;
  q.z() += 0.25 * std::sin(0.35 * p.x()) * std::cos(0.21 * p.y()) + 0.03 * std::sin(5 * p.x() + 3 * p.y() + 4 * p.z());
  q.x() += 0.05 * std::sin(2.1 * p.y() + 1.3 * p.z());
  q.y() += 0.05 * std::sin(1.9 * p.x() + 2.3 * p.z());
  return q;
}

// The middle line of the ring, corners rounded, by the way along it.
Pose2 on_ring(double s_m) {
  const double half = (outer_m - width_m) / 2, r = 2.5, straight = 2 * (half - r), bend = r * std::numbers::pi / 2;
  const double s = std::fmod(s_m, 4 * (straight + bend));
  const int side = static_cast<int>(s / (straight + bend));
  const double along = s - side * (straight + bend);
  Pose2 X{-(half - r), -half, 0};
  if (along <= straight) {
    X.x_m += along;
  } else {
    const double a = (along - straight) / r;
    X = {half - r + r * std::sin(a), -half + r * (1 - std::cos(a)), a};
  }
  return Pose2{0, 0, side * std::numbers::pi / 2} * X;
}

// What the map makes of a true place: bent by a smooth field.
Vec3 bent(const Vec3& p, double drift_m) {
  const double far = (p.x() + outer_m / 2) / outer_m;
  return p + drift_m * Vec3(0.2 * far * std::sin(0.2 * p.y()), far * far, 0.3 * std::sin(0.15 * p.x() + 0.1 * p.y()));
}

void drive(SyntheticRun& run, const Caster& caster) {
  const double length = 2 * 4 * (outer_m - width_m) - 8;
  Trajectory& path = run.truth.drive.path;
  for (int k = 0; k * 0.25 <= length; ++k) {
    const Pose2 X = on_ring(0.25 * k);
    const Hit down = caster.nearest(Ray{Vec3(X.x_m, X.y_m, 1.2), -Vec3::UnitZ(), 10});
    path.stamp_s.push_back(0.25 * k);
    path.X_WB.push_back(pose_of(Vec3(X.x_m, X.y_m, 1.2 - down.range_m), X.yaw_rad, 0.05 * std::sin(0.1 * k)));
  }
  run.truth.drive.route.length_m = run.truth.drive.driven_m = length;
}

void sense(SyntheticRun& run, const Caster& caster, double drift_m) {
  const int beams = 120;
  Mount mount;
  mount.name = "front";
  mount.laser.fov_rad = std::numbers::pi;
  mount.laser.beams = beams;
  mount.laser.interlace = 1;
  mount.X_BS = pose_of(Vec3(0, 0, 1), 0);
  run.log.rig.name = "synthetic";
  run.log.rig.mounts = {mount};
  Scans scans;
  scans.beams = beams;
  const Trajectory& path = run.truth.drive.path;
  Estimate& e = run.estimate;
  for (size_t i = 0; i < path.size(); ++i) {
    scans.stamp_s.push_back(path.stamp_s[i]);
    for (int k = 0; k < beams; ++k) {
      const double a = mount.laser.beam_angle_rad(k);
      const Vec3 eye = path.X_WB[i] * Vec3(0, 0, 1),
                 level = path.X_WB[i].rotation() * Vec3(std::cos(a), std::sin(a), 0);
      scans.range_m.push_back(static_cast<float>(caster.nearest(Ray{eye, level, 100}).range_m));
      // A ring of beams around the body, floor and roof and ribs.
      const double turn = 2 * a;
      const Vec3 round = path.X_WB[i].rotation() * Vec3(0, std::cos(turn), std::sin(turn));
      const Hit hit = caster.nearest(Ray{eye, round, 100});
      if (hit.face < 0) continue;
      const Vec3 noise = 0.01 * normal(1, Draw::test, i, k) * round;
      const Vec3 true_p = eye + hit.range_m * round;
      e.points.p.push_back(path.X_WB.front().inverse() * (bent(true_p, drift_m) + noise));
      e.points.stamp_s.push_back(path.stamp_s[i]);
      e.points.laser.push_back(0);
    }
  }
  run.log.scans = {scans};
}

void map(SyntheticRun& run, double drift_m) {
  const Trajectory& path = run.truth.drive.path;
  const Pose X_MW = path.X_WB.front().inverse();
  Estimate& e = run.estimate;
  e.method = "by hand";
  e.path.stamp_s = path.stamp_s;
  for (size_t i = 0; i < path.size(); ++i) {
    Pose X = path.X_WB[i];
    X.translation() = bent(X.translation(), drift_m);
    e.path.X_WB.push_back(X_MW * X);
    e.planar.push_back(flatten(e.path.X_WB.back()));
    const double s = static_cast<double>(i) / static_cast<double>(path.size());
    e.open_loop.push_back(Pose2{0, 0, 0.35 * s * s} * e.planar.back());
  }
  e.surface = run.world.mesh;
  for (Vec3& p : e.surface.vertex) p = X_MW * bent(p, drift_m);
  for (int round = 0; round < 3; ++round) {
    AlignmentRound r;
    for (size_t i = 0; i < path.size(); i += 20) r.nodes.push_back((round ? e.planar : e.open_loop)[i].position());
    const int half = static_cast<int>(r.nodes.size()) / 2;
    for (int i = 0; i + half < static_cast<int>(r.nodes.size()); i += 3 - round)
      r.correspondences.emplace_back(i, i + half);
    e.rounds.push_back(r);
  }
  e.converged = true;
  const int n = static_cast<int>(path.size());
  for (int i = 0; i + n / 2 < n; i += 40) e.closures.push_back({i, i + n / 2, {}, false, i % 120 != 0, false});
  e.grid.cell_m = 0.2;
  e.grid.width = e.grid.height = 260;
  const Vec3 corner = X_MW * Vec3(-outer_m / 2 - 4, -outer_m / 2 - 4, 0);
  e.grid.origin = corner.head<2>();
  for (int j = 0; j < e.grid.height; ++j)
    for (int i = 0; i < e.grid.width; ++i) {
      const Vec2 c = e.grid.centre(i, j);
      const Vec3 p = X_MW.inverse() * Vec3(c.x(), c.y(), 0);
      const double ring = std::max(std::abs(p.x()), std::abs(p.y())),
                   in = std::min(outer_m / 2 - ring, ring - (outer_m / 2 - width_m));
      e.grid.log_odds.push_back(in > 0.2 ? -3.f : in > -0.1 ? 3.f : 0.f);
    }
  e.volume_m3 = run.world.numbers.volume_m3 * 0.98;
}

void score(SyntheticRun& run, const Caster& caster) {
  Score& s = run.score;
  s.X_WM_se3 = s.X_WM_first_pose = run.truth.drive.path.X_WB.front();
  Vec3 worst = Vec3::Zero();
  float most = 0;
  for (const Vec3& p_M : run.estimate.points.p) {
    const Vec3 p = s.X_WM_se3 * p_M;
    const auto near = caster.closest(p, 3);
    s.point_error_m.push_back(near ? static_cast<float>(-run.world.mesh.normal(near->face).dot(p - near->point)) : NAN);
    s.point_label.push_back(near ? static_cast<std::uint8_t>(run.world.mesh.label[near->face]) : 0);
    if (std::abs(s.point_error_m.back()) > most) most = std::abs(s.point_error_m.back()), worst = p;
  }
  for (size_t i = 0; i < run.estimate.path.size(); ++i) {
    const Pose& X = run.truth.drive.path.X_WB[i];
    s.poses.push_back({run.estimate.path.stamp_s[i],
                       0.25 * static_cast<double>(i),
                       X,
                       s.X_WM_se3 * run.estimate.path.X_WB[i].translation() - X.translation(),
                       {0, 0, 0}});
  }
  s.worst = {{worst, 1, 900, -0.3, 0.31}, {Vec3(12, 20, 0), 2, 800, 0.2, 0.22}};
  s.face_hits.assign(run.world.mesh.face.size(), 3);
  for (size_t f = 0; f < s.face_hits.size(); f += 5) s.face_hits[f] = 0;
  s.passages = {{0, 9000, 0.01, 0.03, 0.1}, {1, 9000, -0.1, 0.2, 0.4}};
  s.metrics = {{"trajectory.se3.ate_xy_rmse_m", 0.214, "m", Better::lower, 1264, ""},
               {"map.se3.mae_m", 0.061, "m", Better::lower, 151000, ""},
               {"map.se3.bias_m", -0.004, "m", Better::lower, 151000, ""},
               {"map.se3.f_10cm", 0.83, "share", Better::higher, 151000, ""},
               {"volume.error_percent", -2.1, "percent", Better::lower, 1, ""},
               {"volume.mapped_m3", NAN, "m3", Better::lower, 0, "the rig sees no roof"},
               {"closures.loops_true", 1, "count", Better::higher, 1, ""},
               {"closures.loops_closed", 1, "count", Better::higher, 1, ""}};
  s.notes = {"made by hand"};
}

}  // namespace

SyntheticRun synthetic_run(double drift_m, double edge_m) {
  SyntheticRun run;
  run.world = ring_world(outer_m, width_m, height_m, edge_m);
  for (Vec3& p : run.world.mesh.vertex) p = undulating(p);
  const Caster caster(run.world.mesh);
  drive(run, caster);
  sense(run, caster, drift_m);
  map(run, drift_m);
  score(run, caster);
  return run;
}

}  // namespace adit
