// SPDX-License-Identifier: BSD-3-Clause
#include "eval/page_data.h"

#include "base/parallel.h"
#include "base/polyline.h"
#include "eval/bound.h"
#include "eval/packed.h"
#include "eval/page_space.h"

#include <Eigen/Eigenvalues>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

using nlohmann::ordered_json;

constexpr size_t most_poses = 3000;
constexpr int bins = 60;
constexpr double farthest_m = 40;   // of points from the laser
constexpr size_t most_scans = 300;  // whose information is told

// To a thousandth unless more is asked for; null where there is no number.
ordered_json number(double value, double parts = 1e3) {
  if (!std::isfinite(value)) return nullptr;
  const double rounded = std::round(value * parts) / parts;
  return rounded == 0 ? 0.0 : rounded;
}

ordered_json numbers(const std::vector<double>& values, double parts = 1e3) {
  ordered_json list = ordered_json::array();
  for (const double v : values) list.push_back(number(v, parts));
  return list;
}

ordered_json frame_json(const Figure& figure) {
  if (!figure.frame) return nullptr;
  const Vec2 zero = (*figure.frame)(Vec2::Zero());
  return {{"x", number(zero.x())}, {"y", number(zero.y())}, {"px_per_m", number(figure.frame->px_per_m, 1e6)}};
}

// Stated deviation of a pose in plan, along the worst direction; NaN where the map states none.
double stated_m(const std::vector<Eigen::MatrixXd>& covariance, size_t i) {
  if (i >= covariance.size() || covariance[i].rows() < 2) return NAN;
  const Eigen::Matrix2d plan = covariance[i].topLeftCorner<2, 2>();
  return std::sqrt(std::max(0.0, Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(plan).eigenvalues()[1]));
}

// Errors along the true path where it was scored; else the mapped path alone.
ordered_json path_json(const Exhibit& x) {
  const auto& poses = x.input.score.poses;
  const Trajectory& path = x.path_W;
  std::vector<double> along, t, px, py, pz, plan, height, yaw, sigma;
  const auto add = [&](double d, double stamp, const Vec3& p) {
    along.push_back(d), t.push_back(stamp);
    px.push_back(p.x()), py.push_back(p.y()), pz.push_back(p.z());
  };
  if (poses.size() > 1) {
    const size_t step = 1 + poses.size() / most_poses;
    size_t k = 0;  // of the estimate
    for (size_t i = 0; i < poses.size(); i += step) {
      const PoseError& p = poses[i];
      add(p.along_m, p.stamp_s, p.X_WB.translation() + p.p_error_W);
      plan.push_back(p.p_error_W.head<2>().norm());
      height.push_back(p.p_error_W.z());
      yaw.push_back(p.error.yaw_rad * 180 / M_PI);
      while (k + 1 < path.size() && path.stamp_s[k] < p.stamp_s) ++k;
      sigma.push_back(stated_m(x.input.estimate.covariance, k));
    }
  } else if (path.size() > 1) {
    const std::vector<double> way = distance_along(path);
    for (size_t i = 0; i < path.size(); i += 1 + path.size() / most_poses)
      add(way[i], path.stamp_s[i], path.X_WB[i].translation());
  } else {
    return nullptr;
  }
  ordered_json json = {{"along", numbers(along, 1e2)},
                       {"t", numbers(t, 1e2)},
                       {"x", numbers(px)},
                       {"y", numbers(py)},
                       {"z", numbers(pz)}};
  if (!plan.empty()) {
    json["plan"] = numbers(plan, 1e4);
    json["height"] = numbers(height, 1e4);
    json["yaw"] = numbers(yaw);
  }
  if (std::any_of(sigma.begin(), sigma.end(), [](double s) { return std::isfinite(s); }))
    json["sigma"] = numbers(sigma, 1e4);
  return json;
}

// What single scans of the mapping laser could tell at best, by the true way driven.
ordered_json information_json(const Exhibit& x) {
  const Truth& truth = x.input.truth;
  const Trajectory& path = truth.drive.path;
  const int laser = find_view(x.input.log.rig, View::horizontal);
  if (!x.has_world() || laser < 0 || static_cast<size_t>(laser) >= truth.scans.size() || path.size() < 2)
    return nullptr;
  const TrueScans scans(truth, x.input.world.mesh);
  const size_t n = scans.scans(laser), step = 1 + n / most_scans;
  const std::vector<double> way = distance_along(path);
  std::vector<double> along, least((n + step - 1) / step), most(least.size());
  for (size_t k = 0; k < least.size(); ++k) {
    const double t = truth.scans[laser].stamp_s[k * step];
    const auto at = std::lower_bound(path.stamp_s.begin(), path.stamp_s.end(), t) - path.stamp_s.begin();
    along.push_back(way[std::min<size_t>(at, path.size() - 1)]);
  }
  parallel_for(
      least.size(),
      [&](size_t k) {
        const PositionBound bound = position_bound(information_of(scans, x.input.world.mesh, laser, k * step));
        least[k] = bound.least_m, most[k] = bound.most_m;
      },
      8);
  return {{"along", numbers(along, 1e2)}, {"least", numbers(least, 1e6)}, {"most", numbers(most, 1e6)}};
}

// Stretches of the path that the scans leave open, by the stamps of the map.
ordered_json degenerate_json(const Exhibit& x) {
  ordered_json list = ordered_json::array();
  for (const DegenerateStretch& d : x.input.estimate.degenerate)
    list.push_back({{"from_s", number(d.from_s)}, {"to_s", number(d.to_s)}, {"sigma", number(d.sigma_m)}});
  return list;
}

// How many points of each label lie how far off; the outer bins hold what lies beyond.
ordered_json histogram_json(const Exhibit& x) {
  ordered_json list = ordered_json::array();
  for (const Label label : {Label::floor, Label::roof, Label::rib, Label::cap}) {
    std::vector<std::int64_t> count(bins, 0);
    std::int64_t n = 0, under = 0, over = 0;
    for (size_t k = 0; k < x.point_label.size(); ++k) {
      const double e = x.point_error_m[k];
      if (x.point_label[k] != label || !std::isfinite(e)) continue;
      ++n;
      const double s = (e - x.ramp.low) / (x.ramp.high - x.ramp.low) * bins;
      ++(s < 0 ? under : s >= bins ? over : count[static_cast<size_t>(s)]);
    }
    if (n > 0)
      list.push_back({{"label", label_name(label)}, {"n", n}, {"count", count}, {"under", under}, {"over", over}});
  }
  return list;
}

// Errors of the points by their distance from where they were seen, a metre a bin.
ordered_json reach_json(const Exhibit& x) {
  const PointCloud& points = x.input.estimate.points;
  ordered_json list = ordered_json::array();
  if (points.stamp_s.size() != x.point_W.size() || x.path_W.size() < 2) return list;
  std::vector<float> range(x.point_W.size());
  parallel_for(
      range.size(),
      [&](size_t k) {
        range[k] = static_cast<float>((x.point_W[k] - x.path_W.at(points.stamp_s[k]).translation()).norm());
      },
      4096);
  std::vector<std::vector<float>> bin(static_cast<size_t>(farthest_m));
  for (size_t k = 0; k < range.size(); ++k)
    if (std::isfinite(x.point_error_m[k]) && range[k] < static_cast<float>(farthest_m))
      bin[static_cast<size_t>(range[k])].push_back(std::abs(x.point_error_m[k]));
  for (size_t m = 0; m < bin.size(); ++m) {
    auto& errors = bin[m];
    if (errors.size() < 20) continue;
    double sum = 0;
    for (const float e : errors) sum += static_cast<double>(e);
    const auto n = static_cast<double>(errors.size());
    const auto q = errors.begin() + static_cast<std::ptrdiff_t>(0.95 * (n - 1));
    std::nth_element(errors.begin(), q, errors.end());
    list.push_back({{"m", static_cast<double>(m) + 0.5},
                    {"n", errors.size()},
                    {"mean", number(sum / n, 1e4)},
                    {"p95", number(static_cast<double>(*q), 1e4)}});
  }
  return list;
}

// Errors of relative poses by the way between them, from the scores.
ordered_json drift_json(const Score& score) {
  ordered_json list = ordered_json::array();
  const std::string stem = "trajectory.rpe_", end = "m_percent";
  for (const Metric& m : score.metrics)
    if (m.name.starts_with(stem) && m.name.ends_with(end) && std::isfinite(m.value))
      list.push_back({{"m", std::stod(m.name.substr(stem.size()))}, {"percent", number(m.value, 1e4)}, {"n", m.n}});
  return list;
}

ordered_json passages_json(const Exhibit& x) {
  ordered_json list = ordered_json::array();
  for (const Passage& p : x.input.world.passages) {
    std::vector<Vec2> line;
    for (const Vec3& v : p.centre_line) line.push_back(v.head<2>());
    ordered_json points = ordered_json::array();
    for (const Vec2& v : simplified(line, 0.2)) points.push_back({number(v.x(), 1e2), number(v.y(), 1e2)});
    list.push_back(std::move(points));
  }
  return list;
}

ordered_json mesh_json(const SpaceMesh& mesh) {
  if (mesh.faces == 0) return nullptr;
  return {{"vertices", mesh.vertices},
          {"faces", mesh.faces},
          {"roof", mesh.roof},
          {"coloured", mesh.coloured},
          {"data", packed(mesh.bytes)}};
}

ordered_json space_json(const Exhibit& x) {
  if (!x.has_surface() && !x.has_world() && x.path_W.size() < 2) return nullptr;
  const Raster raster = raster_of(x);
  ordered_json map, mine;
  parallel_for(2, [&](size_t k) {
    if (k == 0)
      map = mesh_json(map_in_space(x, raster));
    else
      mine = mesh_json(mine_in_space(x, raster));
  });
  ordered_json ramp = ordered_json::array();
  for (int k = 0; k < 255; ++k)
    ramp.push_back(hex_of(x.ramp.colour(x.ramp.low + k * (x.ramp.high - x.ramp.low) / 254)));
  ordered_json json = {{"low", {number(raster.low.x()), number(raster.low.y()), number(raster.low.z())}},
                       {"step", raster.step_m},
                       {"ramp", ramp},
                       {"map", std::move(map)},
                       {"mine", std::move(mine)}};
  std::vector<double> truth;
  const Trajectory& true_path = x.input.truth.drive.path;
  for (size_t i = 0; i < true_path.size(); i += 1 + true_path.size() / most_poses)
    for (int axis = 0; axis < 3; ++axis) truth.push_back(true_path.X_WB[i].translation()[axis]);
  json["true_path"] = numbers(truth);
  const SpaceBeams beams = beams_in_space(x, raster);
  if (!beams.to.empty()) {
    ordered_json names = ordered_json::array();
    for (const Mount& m : x.input.log.rig.mounts) names.push_back(m.name);
    json["beams"] = {{"lasers", names},
                     {"t", numbers(beams.stamp_s, 1e2)},
                     {"count", beams.count},
                     {"from", packed(delta_bytes(beams.from, 3))},
                     {"to", packed(delta_bytes(beams.to, 3))}};
  }
  return json;
}

ordered_json frames_json(const std::vector<AlongFrame>& frames) {
  ordered_json list = ordered_json::array();
  for (const AlongFrame& frame : frames)
    list.push_back({{"along", number(frame.along_m, 1e2)}, {"png", base64(frame.png)}});
  return list;
}

// What ends a script element or begins a comment there is written as an escape.
std::string in_page(std::string json) {
  for (size_t at = json.find('<'); at != std::string::npos; at = json.find('<', at + 6)) json.replace(at, 1, "\\u003c");
  return json;
}

}  // namespace

std::string page_data(const Exhibit& x, const Figure& wide, const Figure& narrow,
                      const std::vector<AlongFrame>& frames) {
  ordered_json json;
  json["plan"] = {{"wide", frame_json(wide)}, {"narrow", frame_json(narrow)}};
  json["range"] = number(x.ramp.high);
  json["path"] = path_json(x);
  json["information"] = information_json(x);
  json["degenerate"] = degenerate_json(x);
  json["histogram"] = histogram_json(x);
  json["reach"] = reach_json(x);
  json["drift"] = drift_json(x.input.score);
  json["passages"] = passages_json(x);
  json["space"] = space_json(x);
  json["frames"] = frames_json(frames);
  return in_page(json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

}  // namespace adit
