// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "cli/scenario.h"
#include "tests/bench/bench.h"
#include "worlds/worlds.h"

namespace {

using namespace adit;
using namespace adit::bench;

std::vector<Figure> made_and_checked(const std::string& name, const WorldSettings& world, const std::string& what) {
  const Cost cost = cost_of([&] {
    PartsCheck check;
    make_parts(world, 1, [&](MinePart&& part) { check.add(part); });
    if (!check.finish().ok()) throw Error(name + ": " + check.finish().what());
  });
  return {{name + "_s", cost.wall_s, "s", "lower", what}, {name + "_gib", cost.peak_gib, "GiB", "lower", what}};
}

// The Safety Research part of the Bruceton plan, checks included.
std::vector<Figure> bruceton() {
  return made_and_checked("world_bruceton", load_scenario("bruceton").world,
                          "bruceton's mine made and checked, triangles of 0.2 m");
}

std::vector<Figure> district(const std::string& name, double length_m, const std::string& what) {
  WorldSettings s = load_scenario("district").world;
  s.district.length_m = length_m;
  return made_and_checked(name, s, what + " of passages made and checked, triangles of 0.2 m");
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {{{"world_bruceton_s", "world_bruceton_gib"}, bruceton},
              {{"world_1km_s", "world_1km_gib"}, [] { return district("world_1km", 1000, "1 km"); }},
              {{"world_10km_s", "world_10km_gib"}, [] { return district("world_10km", 10000, "10 km"); }}});
}
