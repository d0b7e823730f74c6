// SPDX-License-Identifier: BSD-3-Clause
#include "eval/exhibit.h"

#include "base/parallel.h"
#include "eval/outline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {

namespace {

constexpr float none = std::numeric_limits<float>::quiet_NaN();

bool is_identity(const Pose& X) {
  return (X.matrix() - Pose::Identity().matrix()).norm() < 1e-12;
}

// The map laid on the world by the first pose, for runs without a score.
Pose first_pose(const ReportInput& in) {
  const Trajectory &truth = in.truth.drive.path, &path = in.estimate.path;
  if (truth.empty() || path.empty()) return Pose::Identity();
  return truth.at(path.stamp_s.front()) * path.X_WB.front().inverse();
}

// Signed distance of a point to the true surface, + into the void. With `seen_along` only what is seen in that
// direction counts.
float signed_error(const Caster& caster, const Vec3& p_W, const std::optional<Vec3>& seen_along) {
  if (!p_W.allFinite()) return none;
  const auto hit = caster.closest(p_W, 3, seen_along);
  if (!hit) return none;
  return static_cast<float>(-caster.mesh().normal(hit->face).dot(p_W - hit->point));
}

// Vertex normals, out of the enclosed volume.
std::vector<Vec3> vertex_normals(const Mesh& mesh) {
  std::vector<Vec3> normal(mesh.vertex.size(), Vec3::Zero());
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const Vec3 n = (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0));
    for (const auto v : mesh.face[f]) normal[v] += n;
  }
  for (Vec3& n : normal) n = n.norm() > 0 ? Vec3(n.normalized()) : Vec3::UnitZ();
  return normal;
}

void lay_points(Exhibit& x) {
  const auto& p_M = x.input.estimate.points.p;
  const Score& score = x.input.score;
  x.point_W.resize(p_M.size());
  parallel_for(
      p_M.size(), [&](size_t k) { x.point_W[k] = x.X_WM * p_M[k]; }, 4096);
  x.point_error_m = score.point_error_m;
  x.point_label.assign(p_M.size(), Label::none);
  if (score.point_label.size() == p_M.size())
    for (size_t k = 0; k < p_M.size(); ++k) x.point_label[k] = static_cast<Label>(score.point_label[k]);
  if (x.point_error_m.size() == p_M.size()) return;
  x.point_error_m.assign(p_M.size(), none);
  if (!x.caster) return;
  parallel_for(
      p_M.size(), [&](size_t k) { x.point_error_m[k] = signed_error(*x.caster, x.point_W[k], {}); }, 1024);
}

void lay_surface(Exhibit& x) {
  x.surface_W = x.input.estimate.surface;
  for (Vec3& p : x.surface_W.vertex) p = x.X_WM * p;
  x.surface_error_m.assign(x.surface_W.vertex.size(), none);
  if (!x.caster) return;
  const std::vector<Vec3> normal = vertex_normals(x.surface_W);
  parallel_for(
      x.surface_W.vertex.size(),
      [&](size_t v) { x.surface_error_m[v] = signed_error(*x.caster, x.surface_W.vertex[v], normal[v]); }, 1024);
}

void find_spots(Exhibit& x) {
  for (const WorstPlace& w : x.input.score.worst) {
    if (static_cast<int>(x.spots.size()) >= x.settings.places) break;
    const char* side = w.bias_m > 0.5 * w.mae_m    ? ", mostly into the void"
                       : w.bias_m < -0.5 * w.mae_m ? ", mostly into the rock"
                                                   : ", to both sides";
    std::string words = "off by " + plain_number(w.mae_m, 2) + " m on average" + side;
    if (w.passage >= 0) words += ", passage " + std::to_string(w.passage);
    x.spots.push_back({w.p_W, w.bias_m, w.mae_m, words});
  }
}

void choose_range(Exhibit& x) {
  std::vector<double> errors;
  const auto take = [&](const std::vector<float>& all) {
    const size_t step = std::max<size_t>(1, all.size() / 400000);
    for (size_t k = 0; k < all.size(); k += step) errors.push_back(all[k]);
  };
  take(x.point_error_m);
  if (errors.empty()) take(x.surface_error_m);
  const double end = x.settings.range_m > 0 ? x.settings.range_m : round_range(errors, 0.99, 0.05, 2);
  x.ramp = {Ramp::Kind::diverging, -end, end, "error: − in the rock, + in the void", "m"};
  x.size_ramp = {Ramp::Kind::sequential, 0, end, "distance of the map to the true rock", "m"};
}

void find_bounds(Exhibit& x) {
  x.low_W = Vec2::Constant(1e30);
  x.high_W = Vec2::Constant(-1e30);
  const auto take = [&](const Vec3& p) {
    if (!p.allFinite()) return;
    x.low_W = x.low_W.cwiseMin(p.head<2>());
    x.high_W = x.high_W.cwiseMax(p.head<2>());
  };
  for (const Vec3& p : x.input.world.mesh.vertex) take(p);
  if (!x.has_world())
    for (const Vec3& p : x.point_W) take(p);
  for (const Pose& X : x.path_W.X_WB) take(X.translation());
  for (const Pose& X : x.input.truth.drive.path.X_WB) take(X.translation());
  if (x.low_W.x() > x.high_W.x()) x.low_W = Vec2(-10, -10), x.high_W = Vec2(10, 10);
  const double margin = std::max(2.0, 0.02 * (x.high_W - x.low_W).maxCoeff());
  x.low_W -= Vec2::Constant(margin);
  x.high_W += Vec2::Constant(margin);
}

}  // namespace

Exhibit make_exhibit(const ReportInput& input, const ReportSettings& settings, const Progress& progress) {
  Exhibit x{.input = input,
            .settings = settings,
            .outline = plan_outline(input.world.mesh),
            .X_WM = input.score.X_WM_se3,
            .X_WM_first = input.score.X_WM_first_pose,
            .path_W = input.estimate.path};
  progress("report: errors", 0, 2);
  if (!input.world.mesh.face.empty()) x.caster.emplace(input.world.mesh);
  if (input.score.poses.empty() && is_identity(x.X_WM)) x.X_WM = x.X_WM_first = first_pose(input);
  for (Pose& X : x.path_W.X_WB) X = x.X_WM * X;
  lay_points(x);
  progress("report: errors", 1, 2);
  lay_surface(x);
  find_spots(x);
  choose_range(x);
  find_bounds(x);
  progress("report: errors", 2, 2);
  return x;
}

}  // namespace adit
