// SPDX-License-Identifier: BSD-3-Clause
#include "eval/relations.h"

#include "base/error.h"
#include "base/files.h"
#include "eval/metric_list.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

namespace adit {
namespace {

constexpr double least_share = 0.95;

std::optional<size_t> nearest(const Trajectory& path, double stamp_s, double max_diff_s) {
  const auto after = std::lower_bound(path.stamp_s.begin(), path.stamp_s.end(), stamp_s);
  std::optional<size_t> best;
  for (const auto& it : {after, after == path.stamp_s.begin() ? after : after - 1}) {
    if (it == path.stamp_s.end()) continue;
    const auto i = static_cast<size_t>(it - path.stamp_s.begin());
    if (!best || std::abs(*it - stamp_s) < std::abs(path.stamp_s[*best] - stamp_s)) best = i;
  }
  if (best && std::abs(path.stamp_s[*best] - stamp_s) > max_diff_s) best.reset();
  return best;
}

// Mean and standard deviation (of the sample) of the values and of their squares.
void add_moments(const MetricList& list, const std::string& name, const std::string& unit,
                 const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  const auto add = [&](const std::string& mean_name, const std::string& sd_name, const std::string& in, int power) {
    double mean = 0, squares = 0;
    for (const double v : values) mean += std::pow(v, power) / n;
    for (const double v : values) squares += std::pow(std::pow(v, power) - mean, 2);
    const auto count = static_cast<std::int64_t>(values.size());
    list.add(mean_name, n > 0 ? mean : NAN, in, Better::lower, count, "no relation");
    list.add(sd_name, n > 1 ? std::sqrt(squares / (n - 1)) : NAN, in, Better::lower, count, "fewer than two relations");
  };
  add(name + "_" + unit, name + "_sd_" + unit, unit, 1);
  add(name + "_sq_" + unit + "2", name + "_sq_sd_" + unit + "2", unit + "2", 2);
}

}  // namespace

std::vector<Relation> read_relations(const std::string& file) {
  std::vector<Relation> relations;
  std::istringstream text(read_text(file));
  std::string line;
  for (int number = 1; std::getline(text, line); ++number) {
    line = line.substr(0, line.find('#'));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(line);
    double v[8];
    bool good = true;
    for (double& x : v) good = good && (words >> x) && std::isfinite(x);
    std::string rest;
    if (!good || words >> rest)
      throw Error(file + ":" + std::to_string(number) +
                  ": a relation is eight numbers, 't1 t2 x y z roll pitch yaw' in seconds, metres and radians");
    Relation r{v[0], v[1], Pose::Identity()};
    r.X.translation() = Vec3(v[2], v[3], v[4]);
    r.X.linear() = (Eigen::AngleAxisd(v[7], Vec3::UnitZ()) * Eigen::AngleAxisd(v[6], Vec3::UnitY()) *
                    Eigen::AngleAxisd(v[5], Vec3::UnitX()))
                       .toRotationMatrix();
    relations.push_back(r);
  }
  if (relations.empty()) throw Error(file + ": no relation in it");
  return relations;
}

Score score_relations(const std::vector<Relation>& relations, const Trajectory& path, double max_diff_s) {
  std::vector<double> translation_m, rotation_deg;
  for (const Relation& r : relations) {
    const auto from = nearest(path, r.from_s, max_diff_s), to = nearest(path, r.to_s, max_diff_s);
    if (!from || !to) continue;
    const Pose error = r.X.inverse() * (path.X_WB[*from].inverse() * path.X_WB[*to]);
    translation_m.push_back(error.translation().norm());
    rotation_deg.push_back(Eigen::AngleAxisd(error.linear()).angle() * 180 / std::numbers::pi);
  }
  const double share = static_cast<double>(translation_m.size()) / static_cast<double>(relations.size());
  if (share < least_share)
    throw Error(std::to_string(translation_m.size()) + " of " + std::to_string(relations.size()) +
                    " relations find a pose within " + std::to_string(max_diff_s) +
                    " s at both ends; at least 95 % is needed: do the stamps belong together?",
                Fault::not_comparable);
  Score score;
  const MetricList list(score.metrics, "relations.");
  list.add("matched_share", share, "share", Better::higher, static_cast<std::int64_t>(relations.size()));
  add_moments(list, "translation", "m", translation_m);
  add_moments(list, "rotation", "deg", rotation_deg);
  score.meta.emplace_back("association", "nearest pose within " + std::to_string(max_diff_s) + " s");
  score.meta.emplace_back("alignment", "none: relative poses need none");
  return score;
}

}  // namespace adit
