// SPDX-License-Identifier: BSD-3-Clause
// Makes every bundled mine from many seeds and asks of each whether it is sound, its truth fits and it can be driven.
//   campaign_worlds FIRST COUNT [EDGE_M]   seeds FIRST .. FIRST + COUNT - 1; a failure prints its scenario and seed
#include "base/bundled.h"
#include "base/error.h"
#include "cli/scenario.h"
#include "worlds/worlds.h"

#include <cstdio>
#include <cstdlib>

namespace {

using namespace adit;

// Empty = nothing is wrong.
std::string fault_of(const Scenario& s, std::uint64_t seed) {
  try {
    const World world = make_world(s.world, seed);
    const WorldCheck check = check_world(world);
    if (!check.ok()) return check.what();
    const auto faults = check_truth(world);
    if (!faults.empty()) return faults.front();
    if (s.world.kind != "plan" && world.pillars.size() != static_cast<size_t>(world.numbers.loops))
      return std::to_string(world.pillars.size()) + " pillars, " + std::to_string(world.numbers.loops) + " loops";
    if (!(plan_route(world, s.route, seed).length_m > 0)) return "its route has no length";
    return "";
  } catch (const Error& e) {
    return e.what();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: campaign_worlds FIRST COUNT [EDGE_M]\n");
    return 2;
  }
  const auto first = std::strtoull(argv[1], nullptr, 10), count = std::strtoull(argv[2], nullptr, 10);
  const std::string edge = argc > 3 ? argv[3] : "0.3";
  int failed = 0, made = 0;
  for (const std::string& name : bundled_names("cli/scenarios")) {
    int bad = 0;
    for (auto seed = first; seed < first + count; ++seed) {
      const std::string fault = fault_of(load_scenario(name, {"world.mesh_edge_m=" + edge}), seed);
      ++made;
      if (fault.empty()) continue;
      ++bad;
      std::printf("%s, seed %llu: %s\n", name.c_str(), seed, fault.c_str());
      std::fflush(stdout);
    }
    failed += bad;
    std::printf("%s: %llu seeds, %d failed\n", name.c_str(), count, bad);
    std::fflush(stdout);
  }
  std::printf("%d mines, %d failed\n", made, failed);
  return failed == 0 ? 0 : 1;
}
