// SPDX-License-Identifier: BSD-3-Clause
#include "cli/stats_command.h"

#include "base/error.h"
#include "base/files.h"
#include "base/world.h"
#include "cli/scenario.h"
#include "eval/histograms.h"
#include "worlds/decay.h"
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

// What a mine's settings state, and what was measured of it; by name.
using Stated = std::map<std::string, std::pair<std::vector<double>, std::vector<double>>>;

double mean_of(const std::vector<double>& values) {
  return values.empty() ? 0 : spread_of(values).mean;
}

// Of a mine whose scenario lies beside it.
void compare(const std::string& mine, const MineSamples& own, Stated& stated) {
  const std::string file = (fs::path(mine).parent_path() / "scenario.toml").string();
  if (!fs::exists(file)) return;
  const WorldSettings s = in_condition(load_scenario(file).world);
  const auto add = [&](const std::string& name, double asked, double found) {
    stated[name].first.push_back(asked);
    stated[name].second.push_back(found);
  };
  add("height_m", s.height_m, mean_of(own.height_m));
  if (s.kind == "panel") add("width_m", s.panel.width_m, mean_of(own.width_m));
  add("floor_rough_m", s.floor.rms_m, mean_of(own.floor_rough_m));
  add("roof_rough_m", s.roof.rms_m, mean_of(own.roof_rough_m));
  add("rib_rough_m", s.rib.rms_m, mean_of(own.rib_rough_m));
  const auto things = [&](Label label, double asked) {
    const auto found = own.per_100m.find(label);
    if (asked > 0) add(label_name(label) + "_per_100m", asked, found == own.per_100m.end() ? 0 : found->second.back());
  };
  things(Label::crib, s.furniture.cribs_per_100m);
  things(Label::block, s.furniture.blocks_per_100m);
  things(Label::water, s.furniture.pools_per_100m);
  things(Label::car, s.furniture.cars_per_100m);
  things(Label::beam, s.furniture.beams_per_100m);
  things(Label::cavity, s.decay.falls_per_100m);
  things(Label::scar, s.decay.skins_per_100m);
  things(Label::rubble, s.decay.falls_per_100m * (1 - s.decay.cleared_share));
}

void print_stated(const Stated& stated, Console& console, ordered_json& all) {
  if (stated.empty()) return;
  console.result("stated and measured   n    stated  measured   ratio");
  for (const auto& [name, both] : stated) {
    const double asked = mean_of(both.first), found = mean_of(both.second);
    char line[160];
    std::snprintf(line, sizeof line, "%-18s %5zu %9.3f %9.3f %7.2f", name.c_str(), both.first.size(), asked, found,
                  found / asked);
    console.result(line);
    all["stated"][name] = {{"n", both.first.size()}, {"stated", asked}, {"measured", found}};
  }
}

using Rows = std::vector<std::pair<std::string, const std::vector<double>*>>;

// OUT/stats.svg and stats.png: of each row how its values are spread, and what was stated.
void write_plots(const std::string& out, size_t mines, const Rows& rows, const Stated& stated, Console& console) {
  std::vector<Histogram> all;
  for (const auto& [name, values] : rows) {
    const size_t per = name.find("/100m");
    const auto asked = stated.find(per == std::string::npos ? name : name.substr(0, per) + "_per_100m");
    if (asked == stated.end())
      all.push_back({name, *values, {}});
    else  // densities: of the mines that state one, those without a thing too
      all.push_back({name, per == std::string::npos ? *values : asked->second.second, asked->second.first});
  }
  const Drawing sheet =
      histogram_sheet(all, "what " + std::to_string(mines) + (mines == 1 ? " mine measures" : " mines measure"));
  write_text(out + "/stats.svg",
             to_svg(sheet, "Histograms of what the mines measure, with what their settings state") + "\n");
  write_png(out + "/stats.png", to_picture(sheet));
  console.result("plots: " + out + "/stats.svg, stats.png");
}

}  // namespace

int stats_command(const std::string& dir, const std::string& out, Console& console) {
  MineSamples samples;
  const std::vector<std::string> mines = worlds_under(dir);
  Stated stated;
  for (const std::string& mine : mines) {
    MineSamples own;
    measure(load_world(mine), own);
    compare(mine, own, stated);
    append(samples, own);
  }
  std::vector<double> degrees_of;
  for (const auto& [degree, n] : samples.junctions) degrees_of.insert(degrees_of.end(), n, degree);
  Rows rows{{"width_m", &samples.width_m},
            {"height_m", &samples.height_m},
            {"floor_rough_m", &samples.floor_rough_m},
            {"roof_rough_m", &samples.roof_rough_m},
            {"rib_rough_m", &samples.rib_rough_m},
            {"grade_percent", &samples.grade_percent},
            {"length_m", &samples.length_m},
            {"pillar_m2", &samples.pillar_m2},
            {"extraction_ratio", &samples.extraction},
            {"junction_degree", &degrees_of}};
  if (!samples.per_100m.empty()) {
    rows.emplace_back("blocked_share", &samples.blocked_share);
    rows.emplace_back("bodies_share", &samples.bodies_share);
  }
  for (const auto& [label, values] : samples.per_100m) rows.emplace_back(label_name(label) + "/100m", &values);
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
  print_stated(stated, console, all);
  write_plots(out.empty() ? dir : out, mines.size(), rows, stated, console);
  console.json(all.dump());
  return 0;
}

}  // namespace adit
