// SPDX-License-Identifier: BSD-3-Clause
#include "tests/eval/exact_case.h"

#include "eval/grid_error.h"
#include "eval/true_scans.h"
#include "rays/caster.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int beams = 91;

Mount mount(const std::string& name, const Pose& X_BS) {
  Mount m;
  m.name = name;
  m.X_BS = X_BS;
  m.laser.name = "exact";
  m.laser.fov_rad = pi;
  m.laser.beams = beams;
  m.laser.turn_s = 0.02;
  m.laser.interval_s = 0.2;
  m.laser.range_max_m = 50;
  m.laser.sigma_m = 0.01;  // as its sheet has it; these scans are exact
  return m;
}

// 1 m/s along the line, a quarter turn in 2 s; a pose every 1/30 s.
Trajectory path_along(const std::vector<Vec3>& line) {
  Trajectory path;
  const double step_s = 1.0 / 30;
  const auto add = [&](const Vec3& p, double yaw) {
    path.stamp_s.push_back(step_s * static_cast<double>(path.size()));
    path.X_WB.push_back(pose_of(p, yaw));
  };
  double yaw = 0;
  for (size_t k = 0; k + 1 < line.size(); ++k) {
    const Vec3 d = line[k + 1] - line[k];
    const double next = std::atan2(d.y(), d.x());
    const double turn = k ? wrap_angle(next - yaw) : 0;
    const int turns = static_cast<int>(std::lround(std::abs(turn) / (pi / 4) / step_s));
    for (int i = 1; i <= turns; ++i) add(line[k], yaw + turn * i / turns);
    yaw = next;
    const int steps = static_cast<int>(std::lround(d.norm() / step_s));
    for (int i = 0; i < steps; ++i) add(line[k] + d * i / steps, yaw);
  }
  add(line.back(), yaw);
  return path;
}

ScanTruth cast(const Caster& caster, const Trajectory& path, const Mount& m) {
  ScanTruth scans;
  for (double t = 0; t + m.laser.turn_s < path.stamp_s.back(); t += m.laser.interval_s) {
    scans.stamp_s.push_back(t);
    for (int k = 0; k < beams; ++k) {
      const Pose X_WS = path.at(t + m.laser.beam_offset_s(k)) * m.X_BS;
      const double a = m.laser.beam_angle_rad(k);
      const Vec3 direction = X_WS.linear() * Vec3(std::cos(a), std::sin(a), 0);
      const Hit hit = caster.nearest({X_WS.translation(), direction});
      scans.range_m.push_back(static_cast<float>(hit.range_m));
      scans.face.push_back(hit.face);
      const auto f = static_cast<size_t>(hit.face);
      scans.label.push_back(static_cast<std::uint8_t>(caster.mesh().label.at(f)));
      scans.part.push_back(caster.mesh().part.at(f));
      scans.incidence_rad.push_back(
          static_cast<float>(std::acos(std::min(1.0, std::abs(caster.mesh().normal(f).dot(direction))))));
    }
  }
  return scans;
}

Grid exact_grid(const ExactCase& c, const Pose& X_WM) {
  Grid cell;
  cell.cell_m = 0.1;
  cell.width = cell.height = 1;
  cell.log_odds = {0};
  const TrueSection s = true_section(cell, X_WM, TrueScans(c.truth, c.world.mesh), 0, c.world.mesh);
  Grid grid{s.cell_m, s.origin, s.width, s.height, {}};
  for (const CellTruth t : s.cell)
    grid.log_odds.push_back(t == CellTruth::free ? -20.f : t == CellTruth::wall ? 20.f : 0.f);
  return grid;
}

}  // namespace

ExactCase drive_exactly(const World& world, const std::vector<Vec3>& line) {
  ExactCase c;
  c.world = world;
  c.nominal.name = "exact";
  c.nominal.mounts = {mount("front", pose_of({0.3, 0, 0.9}, 0)), mount("up", pose_of({0, 0, 1}, 0, -pi / 2)),
                      mount("down", pose_of({-0.3, 0, 1.1}, 0, pi / 2))};
  c.truth.world = world_hash(world);
  c.truth.rig = c.nominal;
  c.truth.drive.path = path_along(line);
  const Caster caster(c.world.mesh);
  for (const Mount& m : c.nominal.mounts) c.truth.scans.push_back(cast(caster, c.truth.drive.path, m));
  const Pose X_WM = c.truth.drive.path.X_WB.front(), X_MW = X_WM.inverse();
  Estimate& e = c.estimate;
  e.method = "exact";
  const TrueScans scans(c.truth, c.world.mesh);
  for (const double t : c.truth.scans[0].stamp_s) {
    e.path.stamp_s.push_back(t);
    e.path.X_WB.push_back(X_MW * c.truth.drive.path.at(t));
    e.open_loop.push_back(flatten(e.path.X_WB.back()));
  }
  for (size_t l = 0; l < scans.lasers(); ++l)
    for (size_t i = 0; i < scans.scans(l); ++i)
      for (const TrueBeam& b : scans.fan(l, i, 1)) {
        // The stored range is a float; the plane of the face is exact.
        const Vec3 a = c.world.mesh.corner(static_cast<size_t>(b.face), 0),
                   n = c.world.mesh.normal(static_cast<size_t>(b.face));
        e.points.p.push_back(X_MW * Vec3(b.end() - n.dot(b.end() - a) * n));
        e.points.stamp_s.push_back(c.truth.scans[l].stamp_s[i]);
        e.points.laser.push_back(static_cast<std::uint8_t>(l));
      }
  e.surface = world.mesh;
  for (Vec3& v : e.surface.vertex) v = X_MW * v;
  e.grid = exact_grid(c, X_WM);
  e.volume_m3 = world.numbers.volume_m3;
  return c;
}

const ExactCase& ring_case() {
  static const ExactCase c = drive_exactly(ring_world(20, 4, 2, 0.5),
                                           {{-8, -8, 0}, {8, -8, 0}, {8, 8, 0}, {-8, 8, 0}, {-8, -8, 0}, {0, -8, 0}});
  return c;
}

const ExactCase& tunnel_case() {
  static const ExactCase c = drive_exactly(tunnel_world(20, 4, 2, 0.5), {{4, 0, 0}, {16, 0, 0}});
  return c;
}

ExactCase moved(const ExactCase& exact, const Pose& X) {
  ExactCase c = exact;
  const auto move = [&](Vec3& p) { p = X * p; };
  for (Vec3& v : c.world.mesh.vertex) move(v);
  for (Junction& j : c.world.junctions) move(j.p_W);
  for (Passage& p : c.world.passages)
    for (Vec3& v : p.centre_line) move(v);
  for (Pillar& p : c.world.pillars)
    for (Vec2& v : p.outline) v = (X * Vec3(v.x(), v.y(), 0)).head<2>();
  for (Pose& X_WB : c.truth.drive.path.X_WB) X_WB = X * X_WB;
  c.truth.world = world_hash(c.world);
  return c;
}

Score score_of(const ExactCase& c, const ScoreSettings& settings) {
  return score_map(c.world, c.truth, c.nominal, c.estimate, settings);
}

double value(const Score& score, const std::string& name) {
  const Metric* m = score.find(name);
  EXPECT_NE(m, nullptr) << name;
  return m ? m->value : NAN;
}

}  // namespace adit
