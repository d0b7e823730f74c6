// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "cli/scenario.h"
#include "cli/set_command.h"
#include "tests/bench/bench.h"
#include "worlds/worlds.h"

#include <unistd.h>

#include <filesystem>

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

// The same at the edge for detail.
std::vector<Figure> detail() {
  WorldSettings s = load_scenario("bruceton").world;
  s.mesh_edge_m = 0.1;
  return made_and_checked("world_detail", s, "bruceton's mine made and checked, triangles of 0.1 m");
}

// Some 2,000 posts and 30 falls, against the same mine without.
std::vector<Figure> furnished() {
  WorldSettings s = load_scenario("bruceton").world;
  size_t posts = 0, falls = 0;
  const auto make = [&] {
    const World world = make_world(s, 1);
    if (!check_world(world).ok()) throw Error("world_furnished: " + check_world(world).what());
  };
  const Cost bare = cost_of(make);
  s.furniture.post_share = 1;
  s.furniture.post_spacing_m = 1.3;
  s.decay.falls_per_100m = 1.5;
  s.decay.cleared_share = 0.3;
  const Cost full = cost_of(make);
  for (const MineObject& o : make_world(s, 1).objects)
    posts += o.label == Label::post, falls += o.label == Label::cavity;
  const std::string what = "bruceton's mine made and checked with " + std::to_string(posts) + " posts and " +
                           std::to_string(falls) + " falls, over the bare one";
  return {{"world_furnished_ratio", full.wall_s / bare.wall_s, "ratio", "lower", what},
          {"world_furnished_cpu_ratio", full.cpu_s / bare.cpu_s, "ratio", "lower", what + ", processor time"}};
}

// Of a set, two at a time: what one mine takes.
std::vector<Figure> set() {
  constexpr int mines = 10;
  const std::string dir = (std::filesystem::temp_directory_path() / ("bench_set_" + std::to_string(getpid()))).string();
  write_text(dir + "/set.toml", "scenario = \"mini\"\nmines = " + std::to_string(mines) +
                                    "\nset = [\"world.panel.crosscuts=7\", \"world.mesh_edge_m=0.1\", "
                                    "\"world.condition=abandoned\"]\n");
  const Cost cost = cost_of([&] {
    Console silent(true, false);
    if (set_command(dir + "/set.toml", {dir + "/set", -1, {}}, silent) != 0) throw Error("set: a mine has a fault");
  });
  std::filesystem::remove_all(dir);
  const std::string what = "of a set, about 500 m of passages, abandoned, triangles of 0.1 m: made, checked, written";
  return {{"set_mine_s", cost.wall_s / mines, "s", "lower", "one mine " + what, mines},
          {"set_mine_cpu_s", cost.cpu_s / mines, "s", "lower", "one mine " + what + ", processor time", mines},
          {"set_gib", cost.peak_gib, "GiB", "lower", "two mines at a time " + what, mines}};
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
              {{"world_detail_s", "world_detail_gib"}, detail},
              {{"world_furnished_ratio", "world_furnished_cpu_ratio"}, furnished},
              {{"set_mine_s", "set_mine_cpu_s", "set_gib"}, set},
              {{"world_1km_s", "world_1km_gib"}, [] { return district("world_1km", 1000, "1 km"); }},
              {{"world_10km_s", "world_10km_gib"}, [] { return district("world_10km", 10000, "10 km"); }}});
}
