// SPDX-License-Identifier: BSD-3-Clause
#include "base/estimate.h"

#include "base/error.h"
#include "base/files.h"

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

ordered_json json_of(const std::optional<double>& x) {
  return x ? ordered_json(*x) : ordered_json();
}

std::optional<double> number_or_none(const ordered_json& j) {
  return j.is_null() ? std::nullopt : std::optional(j.get<double>());
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
      {"converged", ordered_json(e.converged).dump()},
      {"notes", ordered_json(e.notes).dump()},
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
    e.converged = j.at("converged").get<bool>();
    e.notes = j.at("notes").get<std::vector<std::string>>();
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

void save_estimate(const std::string& dir, const Estimate& e) {
  write_tum(dir + "/trajectory.tum", e.path);
  save_planar(dir + "/open_loop.tum", e.path.stamp_s, e.open_loop);
  save_planar(dir + "/planar.tum", e.path.stamp_s, e.planar);
  std::error_code absent;
  for (const char* file : {"/grid.pgm", "/grid.yaml", "/points.ply", "/surface.ply"}) fs::remove(dir + file, absent);
  if (!e.grid.log_odds.empty()) write_grid(dir + "/grid.pgm", e.grid);
  if (e.points.size() > 0) write_points(dir + "/points.ply", e.points);
  if (!e.surface.face.empty()) write_mesh(dir + "/surface.ply", e.surface);
  write_text(dir + "/map.json", map_text(e));
}

Estimate load_estimate(const std::string& dir) {
  Estimate e;
  read_map_text(dir + "/map.json", e);
  e.path = read_tum(dir + "/trajectory.tum");
  e.open_loop = load_planar(dir + "/open_loop.tum", e.path.size());
  e.planar = load_planar(dir + "/planar.tum", e.path.size());
  if (fs::exists(dir + "/grid.yaml")) e.grid = read_grid(dir + "/grid.yaml");
  if (fs::exists(dir + "/points.ply")) e.points = read_points(dir + "/points.ply");
  if (fs::exists(dir + "/surface.ply")) e.surface = read_mesh(dir + "/surface.ply");
  return e;
}

}  // namespace adit
