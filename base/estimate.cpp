// SPDX-License-Identifier: BSD-3-Clause
#include "base/estimate.h"

#include "base/damaged_estimate.h"
#include "base/error.h"
#include "base/files.h"
#include "base/path_file.h"
#include "base/rib_lines.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

ordered_json json_of(const Closure& c) {
  return {{"i", c.i},
          {"j", c.j},
          {"X", {c.X_ij.x_m, c.X_ij.y_m, c.X_ij.yaw_rad}},
          {"measured", c.measured},
          {"accepted", c.accepted},
          {"ambiguous", c.ambiguous}};
}

Closure closure_of(const ordered_json& j) {
  Closure c;
  c.i = j.at("i").get<int>(), c.j = j.at("j").get<int>();
  const ordered_json& X = j.at("X");
  c.X_ij = {X.at(0).get<double>(), X.at(1).get<double>(), X.at(2).get<double>()};
  c.measured = j.at("measured").get<bool>();
  c.accepted = j.at("accepted").get<bool>();
  c.ambiguous = j.at("ambiguous").get<bool>();
  return c;
}

ordered_json json_of(const AlignmentRound& r) {
  ordered_json nodes = ordered_json::array();
  for (const Vec2& p : r.nodes) nodes.push_back({p.x(), p.y()});
  return {{"nodes", nodes}, {"correspondences", r.correspondences}};
}

AlignmentRound round_of(const ordered_json& j) {
  AlignmentRound r;
  for (const ordered_json& p : j.at("nodes")) r.nodes.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
  r.correspondences = j.at("correspondences").get<std::vector<std::pair<int, int>>>();
  return r;
}

ordered_json json_of(const DegenerateStretch& d) {
  return {{"from_s", d.from_s}, {"to_s", d.to_s}, {"sigma_m", d.sigma_m}};
}

ordered_json json_of(const RangeBias& b) {
  return {{"laser", b.laser}, {"bias_m", b.bias_m}, {"sigma_m", b.sigma_m}};
}

ordered_json json_of(const VolumePart& p) {
  return {{"from_s", p.from_s},
          {"to_s", p.to_s},
          {"length_m", p.length_m},
          {"volume_m3", p.volume_m3},
          {"sigma_m3", p.sigma_m3}};
}

ordered_json json_of(const std::optional<double>& x) {
  return x ? ordered_json(*x) : ordered_json();
}

std::optional<double> number_or_none(const ordered_json& j) {
  return j.is_null() ? std::nullopt : std::optional(j.get<double>());
}

ordered_json json_of(const SolvedGraph& g) {
  const Certificate& c = g.certificate;
  return {{"start", g.start},
          {"nodes", g.graph.node.size()},
          {"edges", g.graph.edge.size()},
          {"converged", g.converged},
          {"iterations", g.iterations},
          {"chi2", g.chi2},
          {"certificate",
           {{"of", "the optimum of sum tau |dt|^2 + kappa |dR|_F^2, tau = 2 / trace(cov_t), kappa = I_33"},
            {"certified", c.certified},
            {"stationary", c.stationary},
            {"objective", c.objective},
            {"gap_bound", c.gap_bound},
            {"smallest_eigenvalue", c.smallest_eigenvalue},
            {"threshold", c.threshold},
            {"objective_of_these_poses", c.given_objective},
            {"distance_rms_m", c.distance_rms_m},
            {"distance_max_m", c.distance_max_m},
            {"distance_max_rad", c.distance_max_rad}}}};
}

SolvedGraph solved_of(const ordered_json& j) {
  SolvedGraph g;
  g.start = j.at("start").get<std::string>();
  g.converged = j.at("converged").get<bool>();
  g.iterations = j.at("iterations").get<int>();
  g.chi2 = j.at("chi2").get<double>();
  const ordered_json& c = j.at("certificate");
  g.certificate.certified = c.at("certified").get<bool>();
  g.certificate.stationary = c.at("stationary").get<bool>();
  const std::pair<const char*, double*> numbers[] = {{"objective", &g.certificate.objective},
                                                     {"gap_bound", &g.certificate.gap_bound},
                                                     {"smallest_eigenvalue", &g.certificate.smallest_eigenvalue},
                                                     {"threshold", &g.certificate.threshold},
                                                     {"objective_of_these_poses", &g.certificate.given_objective},
                                                     {"distance_rms_m", &g.certificate.distance_rms_m},
                                                     {"distance_max_m", &g.certificate.distance_max_m},
                                                     {"distance_max_rad", &g.certificate.distance_max_rad}};
  for (const auto& [key, value] : numbers) *value = c.at(key).get<double>();
  return g;
}

// A list with one entry a line: readable, and small beside a full indentation.
template <class T>
std::string lines(const std::vector<T>& entries) {
  std::string text = "[";
  for (size_t i = 0; i < entries.size(); ++i) text += (i ? ",\n    " : "\n    ") + json_of(entries[i]).dump();
  return text + (entries.empty() ? "]" : "\n  ]");
}

std::string map_text(const Estimate& e) {
  const std::vector<std::pair<std::string, std::string>> items = {
      {"method", ordered_json(e.method).dump()},
      {"volume_m3", json_of(e.volume_m3).dump()},
      {"volume_sigma_m3", json_of(e.volume_sigma_m3).dump()},
      {"volume_parts", lines(e.volume_parts)},
      {"range_bias", lines(e.range_bias)},
      {"converged", ordered_json(e.converged).dump()},
      {"notes", ordered_json(e.notes).dump()},
      {"graph", e.graph ? json_of(*e.graph).dump(4) : "null"},
      {"degenerate", lines(e.degenerate)},
      {"closures", lines(e.closures)},
      {"rounds", lines(e.rounds)}};
  std::string text = "{";
  for (size_t i = 0; i < items.size(); ++i)
    text += (i ? ",\n  \"" : "\n  \"") + items[i].first + "\": " + items[i].second;
  return text + "\n}\n";
}

void read_map_text(const std::string& file, Estimate& e) {
  try {
    const ordered_json j = ordered_json::parse(read_text(file));
    e.method = j.at("method").get<std::string>();
    e.volume_m3 = number_or_none(j.at("volume_m3"));
    e.volume_sigma_m3 = number_or_none(j.at("volume_sigma_m3"));
    for (const ordered_json& p : j.value("volume_parts", ordered_json::array()))
      e.volume_parts.push_back({p.at("from_s").get<double>(), p.at("to_s").get<double>(),
                                p.at("length_m").get<double>(), p.at("volume_m3").get<double>(),
                                p.at("sigma_m3").get<double>()});
    for (const ordered_json& b : j.value("range_bias", ordered_json::array()))
      e.range_bias.push_back(
          {b.at("laser").get<std::string>(), b.at("bias_m").get<double>(), b.at("sigma_m").get<double>()});
    e.converged = j.at("converged").get<bool>();
    e.notes = j.at("notes").get<std::vector<std::string>>();
    if (j.contains("graph") && !j.at("graph").is_null()) e.graph = solved_of(j.at("graph"));
    for (const ordered_json& d : j.at("degenerate"))
      e.degenerate.push_back({d.at("from_s").get<double>(), d.at("to_s").get<double>(), d.at("sigma_m").get<double>()});
    for (const ordered_json& c : j.at("closures")) e.closures.push_back(closure_of(c));
    for (const ordered_json& r : j.at("rounds")) e.rounds.push_back(round_of(r));
  } catch (const ordered_json::exception& wrong) {
    throw Error(file + ": not the map.json of a map: " + wrong.what());
  }
}

void save_planar(const std::string& file, const std::vector<double>& stamp_s, const std::vector<Pose2>& X_MB) {
  if (X_MB.empty()) {
    std::error_code absent;
    fs::remove(file, absent);
    return;
  }
  ADIT_CHECK(X_MB.size() == stamp_s.size());
  Trajectory path{stamp_s, {}};
  for (const Pose2& X : X_MB) path.X_WB.push_back(lift(X));
  write_tum(file, path);
}

std::vector<Pose2> load_planar(const std::string& file, size_t expected) {
  std::vector<Pose2> X_MB;
  if (!fs::exists(file)) return X_MB;
  for (const Pose& X : read_tum(file).X_WB) X_MB.push_back(flatten(X));
  if (X_MB.size() != expected)
    throw Error(file + ": holds " + std::to_string(X_MB.size()) + " poses, trajectory.tum beside it " +
                std::to_string(expected));
  return X_MB;
}

}  // namespace

void save_graph(const std::string& dir, const SolvedGraph& g) {
  std::error_code absent;
  for (const char* file : {"/trajectory.tum", "/open_loop.tum", "/planar.tum", "/grid.pgm", "/grid.yaml",
                           "/ribs.geojson", "/ribs.dxf", "/points.ply", "/surface.ply", "/surface.glb"})
    fs::remove(dir + file, absent);
  write_g2o(dir + "/graph.g2o", g.graph, g.id);
  std::string rows;
  for (size_t k = 0; k < g.covariance.size(); ++k) {
    const Eigen::Matrix3d& C = g.covariance[k];
    rows += fmt::format("{} {} {} {} {} {} {}\n", g.id[k], C(0, 0), C(0, 1), C(0, 2), C(1, 1), C(1, 2), C(2, 2));
  }
  write_text(dir + "/covariance.txt", rows);
  write_text(dir + "/map.json", ordered_json{{"method", "graph"}, {"graph", json_of(g)}}.dump(2) + "\n");
}

void save_estimate(const std::string& dir, const Estimate& e) {
  write_tum(dir + "/trajectory.tum", e.path);
  save_planar(dir + "/open_loop.tum", e.path.stamp_s, e.open_loop);
  save_planar(dir + "/planar.tum", e.path.stamp_s, e.planar);
  std::error_code absent;
  for (const char* file : {"/grid.pgm", "/grid.yaml", "/ribs.geojson", "/ribs.dxf", "/points.ply", "/surface.ply",
                           "/surface.glb", "/graph.g2o", "/path_covariance.txt"})
    fs::remove(dir + file, absent);
  if (!e.grid.log_odds.empty()) {
    write_grid(dir + "/grid.pgm", e.grid);
    write_rib_lines(dir + "/ribs", rib_lines(e.grid));
  }
  if (e.points.size() > 0) write_points(dir + "/points.ply", e.points);
  if (!e.surface.face.empty()) {
    write_mesh(dir + "/surface.ply", e.surface);
    write_glb(dir + "/surface.glb", e.surface);
  }
  if (e.graph) write_g2o(dir + "/graph.g2o", e.graph->graph, e.graph->id);
  if (!e.covariance.empty()) write_covariances(dir + "/path_covariance.txt", e.path, e.covariance);
  write_text(dir + "/map.json", map_text(e));
}

namespace {

// Reads each file of a map through `attempt(read)`, which may let a read fail: it leaves what it was to fill empty.
template <class Attempt>
Estimate read_parts(const std::string& dir, const Attempt& attempt) {
  Estimate e;
  const auto read = [&](const std::string& name, const auto& how) { attempt([&] { how(dir + "/" + name); }); };
  const auto read_if_there = [&](const std::string& name, const auto& how) {
    if (fs::exists(dir + "/" + name)) read(name, how);
  };
  read("map.json", [&](const std::string& file) {
    Estimate told;
    read_map_text(file, told);
    e = std::move(told);
  });
  read("trajectory.tum", [&](const std::string& file) { e.path = read_tum(file); });
  read("open_loop.tum", [&](const std::string& file) { e.open_loop = load_planar(file, e.path.size()); });
  read("planar.tum", [&](const std::string& file) { e.planar = load_planar(file, e.path.size()); });
  read_if_there("path_covariance.txt", [&](const std::string& file) { e.covariance = read_covariances(file, e.path); });
  read_if_there("grid.yaml", [&](const std::string& file) { e.grid = read_grid(file); });
  read_if_there("points.ply", [&](const std::string& file) { e.points = read_points(file); });
  read_if_there("surface.ply", [&](const std::string& file) { e.surface = read_mesh(file); });
  if (e.graph)
    read_if_there("graph.g2o", [&](const std::string& file) {
      GraphFile given = read_g2o(file);
      e.graph->graph = std::move(given.graph);
      e.graph->id = std::move(given.id);
    });
  return e;
}

}  // namespace

Estimate load_estimate(const std::string& dir) {
  return read_parts(dir, [](const auto& read) { read(); });
}

Estimate load_what_is_whole(const std::string& dir, std::vector<std::string>& damaged) {
  Estimate e = read_parts(dir, [&](const auto& read) {
    try {
      read();
    } catch (const Error& error) {
      damaged.push_back(error.what());
    }
  });
  if (e.graph && e.graph->graph.node.empty()) e.graph.reset();
  return e;
}

}  // namespace adit
