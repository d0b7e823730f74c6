// SPDX-License-Identifier: BSD-3-Clause
#include "cli/stats_command.h"

#include "base/error.h"
#include "base/world.h"
#include "worlds/stats.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

std::vector<std::string> worlds_under(const std::string& dir) {
  if (!fs::is_directory(dir)) throw Error(dir + ": no such folder");
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(dir))
    if (entry.path().filename() == "truth.json" && fs::exists(entry.path().parent_path() / "mine.ply"))
      found.push_back(entry.path().parent_path().string());
  if (found.empty()) throw Error(dir + ": no mine in it: no folder with truth.json and mine.ply");
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace

int stats_command(const std::string& dir, Console& console) {
  MineSamples samples;
  const std::vector<std::string> mines = worlds_under(dir);
  for (const std::string& mine : mines) measure(load_world(mine), samples);
  const std::vector<std::pair<std::string, const std::vector<double>*>> rows{
      {"width_m", &samples.width_m},   {"height_m", &samples.height_m},   {"grade_percent", &samples.grade_percent},
      {"length_m", &samples.length_m}, {"pillar_m2", &samples.pillar_m2}, {"extraction_ratio", &samples.extraction}};
  ordered_json all{{"mines", mines.size()}};
  console.result(std::to_string(mines.size()) + " mines\n" +
                 "                       n      mean        sd        p5       p50       p95");
  for (const auto& [name, values] : rows) {
    const Spread s = spread_of(*values);
    char line[160];
    std::snprintf(line, sizeof line, "%-17s %6zu %9.3f %9.3f %9.3f %9.3f %9.3f", name.c_str(), s.n, s.mean, s.sd, s.p5,
                  s.p50, s.p95);
    console.result(line);
    all[name] = {{"n", s.n}, {"mean", s.mean}, {"sd", s.sd}, {"p5", s.p5}, {"p50", s.p50}, {"p95", s.p95}};
  }
  std::string degrees = "junctions by degree:";
  for (const auto& [degree, n] : samples.junctions) {
    degrees += " " + std::to_string(degree) + ": " + std::to_string(n);
    all["junctions"][std::to_string(degree)] = n;
  }
  console.result(degrees);
  console.json(all.dump());
  return 0;
}

}  // namespace adit
