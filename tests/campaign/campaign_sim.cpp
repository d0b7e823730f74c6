// SPDX-License-Identifier: BSD-3-Clause
// Drives both vehicles through seeded mines of every bundled layout, without lasers, and asks of each drive how it ended.
//   campaign_sim FILE [MINES] [METRES]   results are appended to FILE, a line a drive; what stands there is not driven
//                                        again. Routes are driven for METRES at most, else to their ends
// Exit code 1: a drive broke the rules: an error, an end that has no cause, a path that is not finite or leaps.
#include "base/bundled.h"
#include "base/error.h"
#include "cli/scenario.h"
#include "sim/ground.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>

namespace {

using namespace adit;

struct Case {
  std::string scenario, vehicle, ground, turn;
  int seed;

  std::string name() const {
    return scenario + " seed " + std::to_string(seed) + " " + vehicle + " on " + ground + " turning " + turn;
  }
};

// Every layout, then every layout again with the next seed; grounds and turns go round at other paces.
std::vector<Case> cases_of(int mines) {
  const std::vector<std::string> layouts = bundled_names("cli/scenarios"),
                                 grounds = {"smooth", "mixed", "track", "rubble", "mixed"},
                                 turns = {"three_point", "in_place", "arc"};
  std::vector<Case> cases;
  for (int k = 0; k < mines; ++k) {
    const auto i = static_cast<size_t>(k);
    const std::string layout = layouts[i % layouts.size()], ground = grounds[i % grounds.size()];
    const int seed = 1000 + static_cast<int>(i / layouts.size());
    cases.push_back({layout, "cart", ground, turns[i % turns.size()], seed});
    cases.push_back({layout, "groundhog", ground, "in_place", seed});
  }
  return cases;
}

// Empty = the path is one that a vehicle can have driven.
std::string fault_of(const Drive& drive, const World& world) {
  const Floor floor(world.mesh);
  if ((drive.end == DriveEnd::finished) != drive.cause.empty()) return "its end and its cause do not fit";
  const Trajectory& path = drive.path;
  for (size_t i = 0; i < path.size(); ++i) {
    if (!path.X_WB[i].matrix().allFinite()) return "its path is not finite";
    // No vehicle here is faster than 2 m/s, and one that falls is stopped at once.
    if (i > 0 && (path.X_WB[i].translation() - path.X_WB[i - 1].translation()).norm() > 0.05)
      return "its path leaps at " + std::to_string(path.stamp_s[i]) + " s";
    // What lies on the floor is 0.2 m high at most, and tyres and a wheel's hollow take less than 0.1 m.
    const auto z = i % 60 == 0 ? floor.height_m(path.X_WB[i].translation().head<2>()) : std::nullopt;
    if (z && drive.end == DriveEnd::finished && std::abs(path.X_WB[i].translation().z() - *z - 0.1) > 0.25)
      return "it left the floor at " + std::to_string(path.stamp_s[i]) + " s";
  }
  return "";
}

// The beginning of a route; not cut where it is driven backwards.
Route shortened(Route route, double most_m) {
  double way = 0;
  for (size_t i = 1; i < route.line.size(); ++i) {
    way += (route.line[i] - route.line[i - 1]).norm();
    const auto at = static_cast<int>(i);
    const auto inside = [&](const Route::Stretch& s) { return s.first <= at && at <= s.last; };
    if (way < most_m || std::any_of(route.backwards.begin(), route.backwards.end(), inside)) continue;
    route.line.resize(i + 1);
    std::erase_if(route.backwards, [&](const Route::Stretch& s) { return s.first > at; });
    route.length_m = way;
    break;
  }
  return route;
}

// "ok" or "FAULT", how it ended, and why.
std::string outcome_of(const Case& c, double most_m) {
  try {
    Scenario s =
        load_scenario(c.scenario, {"world.mesh_edge_m=0.3", "drive.ground=" + c.ground, "route.turn=" + c.turn,
                                   "drive.robot_speed_mps=0.3", c.seed % 2 ? "route.mode=all" : "route.mode=loops"});
    static std::pair<std::string, World> made;  // both vehicles drive the same mine, one after the other
    const std::string mine = c.scenario + std::to_string(c.seed);
    if (made.first != mine) made = {mine, make_world(s.world, static_cast<std::uint64_t>(c.seed))};
    const World& world = made.second;
    if (world.numbers.loops == 0) s.route.mode = "all";
    const Route route = shortened(plan_route(world, s.route, static_cast<std::uint64_t>(c.seed)), most_m);
    const Drive drive = adit::drive(world, route, load_vehicle(c.vehicle), s.drive, static_cast<std::uint64_t>(c.seed));
    const std::string fault = fault_of(drive, world);
    char text[160];
    std::snprintf(text, sizeof text, "\t%s\t%.0f of %.0f m in %.0f s\t", drive_end_name(drive.end).c_str(),
                  drive.driven_m, route.length_m, drive.path.stamp_s.back());
    return (fault.empty() ? "ok" : "FAULT") + std::string(text) + fault + drive.cause;
  } catch (const Error& e) {
    return std::string("FAULT\terror\t\t") + e.what();
  }
}

std::map<std::string, std::string> known(const std::string& file) {
  std::map<std::string, std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (const size_t tab = line.find('\t'); tab != std::string::npos) lines[line.substr(0, tab)] = line.substr(tab + 1);
  return lines;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: campaign_sim FILE [MINES] [METRES]\n");
    return 2;
  }
  std::map<std::string, std::string> done = known(argv[1]);
  std::map<std::string, int> ends;
  int faults = 0;
  const double most_m = argc > 3 ? std::atof(argv[3]) : 1e9;
  for (const Case& c : cases_of(argc > 2 ? std::atoi(argv[2]) : 50)) {
    if (!done.count(c.name())) {
      done[c.name()] = outcome_of(c, most_m);
      std::ofstream(argv[1], std::ios::app) << c.name() << '\t' << done[c.name()] << std::endl;
    }
    const std::string& line = done[c.name()];
    faults += !line.starts_with("ok");
    const size_t from = line.find('\t') + 1;
    ++ends[c.vehicle + " " + line.substr(from, line.find('\t', from) - from)];
  }
  for (const auto& [end, count] : ends) std::printf("%s: %d\n", end.c_str(), count);
  std::printf("%d faults\n", faults);
  return faults == 0 ? 0 : 1;
}
