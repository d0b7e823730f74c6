// SPDX-License-Identifier: BSD-3-Clause
// Makes every bundled mine from many seeds and asks of each whether it is sound, its truth fits and it can be driven.
//   campaign_worlds FIRST COUNT [FILE [EDGE_M [CONDITION]]]   seeds FIRST .. FIRST + COUNT - 1 of each scenario
// CONDITION: bare (as the scenarios are), or one of world.condition with everything that it brings, and more of it.
// FILE gets a line a mine, "scenario seed triangles fault" (fault: - where there is none). Mines that it tells already
// are not made again: a campaign that was stopped goes on. Exit code 1: a mine has a fault.
#include "base/bundled.h"
#include "base/error.h"
#include "cli/scenario.h"
#include "worlds/worlds.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

namespace {

using namespace adit;

struct Verdict {
  size_t triangles = 0;
  std::string fault = "-";
};

// Tiles are checked one by one, and as the mine that they are together.
Verdict verdict_of(const Scenario& s, std::uint64_t seed) {
  Verdict v;
  try {
    PartsCheck parts;
    Mesh mesh;
    World world = make_parts(s.world, seed, [&](MinePart&& part) {
      parts.add(part);
      append(part, mesh);
    });
    world.mesh = std::move(mesh);
    v.triangles = world.mesh.face.size();
    const WorldCheck check = parts.finish();
    const auto faults = check_truth(world, parts.tally());
    if (!check.ok())
      v.fault = check.what();
    else if (s.world.tile_m > 0 && !check_world(world).ok())
      v.fault = "sound in parts, as a whole: " + check_world(world).what();
    else if (!faults.empty())
      v.fault = faults.front();
    else if (s.world.kind != "plan" && world.pillars.size() != static_cast<size_t>(world.numbers.loops))
      v.fault = std::to_string(world.pillars.size()) + " pillars, " + std::to_string(world.numbers.loops) + " loops";
    else if (!(plan_route(world, s.route, seed).length_m > 0))
      v.fault = "its route has no length";
  } catch (const Error& e) {
    v.fault = e.what();
  }
  return v;
}

std::map<std::pair<std::string, unsigned long long>, Verdict> told_by(const std::string& file) {
  std::map<std::pair<std::string, unsigned long long>, Verdict> told;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string name;
    unsigned long long seed = 0;
    Verdict v;
    if (words >> name >> seed >> v.triangles && std::getline(words >> std::ws, v.fault)) told[{name, seed}] = v;
  }
  return told;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: campaign_worlds FIRST COUNT [FILE [EDGE_M [CONDITION]]]\n");
    return 2;
  }
  const auto first = std::strtoull(argv[1], nullptr, 10), count = std::strtoull(argv[2], nullptr, 10);
  const std::string file = argc > 3 ? argv[3] : "/dev/null", edge = argc > 4 ? argv[4] : "0.3";
  std::vector<std::string> assignments{"world.mesh_edge_m=" + edge};
  if (argc > 5)
    assignments.insert(assignments.end(), {std::string("world.condition=") + argv[5], "world.furniture.bolt_share=0.5",
                                           "world.furniture.belt_share=0.5", "world.furniture.cribs_per_100m=2",
                                           "world.furniture.stopping_share=0.2", "world.furniture.cars_per_100m=0.5",
                                           "world.furniture.beams_per_100m=0.5", "world.furniture.pools_per_100m=2"});
  auto told = told_by(file);
  std::ofstream out(file, std::ios::app);
  for (auto seed = first; seed < first + count; ++seed) {
    for (const std::string& name : bundled_names("cli/scenarios")) {
      if (told.contains({name, seed})) continue;
      const Verdict v = told[{name, seed}] = verdict_of(load_scenario(name, assignments), seed);
      out << name << ' ' << seed << ' ' << v.triangles << ' ' << v.fault << std::endl;
    }
  }
  std::map<std::string, std::pair<int, int>> sums;  // made, failed
  int failed = 0;
  for (const auto& [which, v] : told) {
    ++sums[which.first].first;
    if (v.fault == "-") continue;
    ++sums[which.first].second;
    ++failed;
    std::printf("%s, seed %llu: %s\n", which.first.c_str(), which.second, v.fault.c_str());
  }
  for (const auto& [name, sum] : sums) std::printf("%s: %d mines, %d failed\n", name.c_str(), sum.first, sum.second);
  std::printf("%zu mines, %d failed\n", told.size(), failed);
  return failed == 0 ? 0 : 1;
}
