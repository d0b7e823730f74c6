// SPDX-License-Identifier: BSD-3-Clause
#include "cli/scenario.h"
#include "tests/bench/bench.h"
#include "worlds/worlds.h"

namespace {

using namespace adit;
using namespace adit::bench;

// The Safety Research part of the Bruceton plan, checks included.
std::vector<Figure> bruceton() {
  const Scenario scenario = load_scenario("bruceton");
  const Cost cost = cost_of([&] { check_world(make_world(scenario.world, 1)); });
  const std::string what = "bruceton's mine made and checked, triangles of 0.2 m";
  return {{"world_bruceton_s", cost.wall_s, "s", "lower", what},
          {"world_bruceton_gib", cost.peak_gib, "GiB", "lower", what}};
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, {{{"world_bruceton_s", "world_bruceton_gib"}, bruceton}});
}
