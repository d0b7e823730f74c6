// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/parallel.h"
#include "cli/cells.h"
#include "cli/commands.h"
#include "cli/study_fast.h"
#include "tests/bench/bench.h"

#include <unistd.h>

#include <chrono>
#include <filesystem>

namespace {

using namespace adit;
using namespace adit::bench;
namespace fs = std::filesystem;

// About 200 m of passages.
const std::vector<std::string> small_mine{"world.panel.crosscuts=3", "world.panel.stub_length_m=5.0"};

std::string fresh() {
  static int n = 0;
  const fs::path dir =
      fs::temp_directory_path() / ("adit_bench_" + std::to_string(::getpid()) + "_" + std::to_string(++n));
  fs::remove_all(dir);
  return dir.string();
}

// 64 cells: four mines, each with 16 ways of looking at it and mapping it.
std::vector<Scenario> sixty_four() {
  std::vector<Scenario> cells;
  for (int seed = 1; seed <= 4; ++seed)
    for (const char* rig : {"[]", "[\"profile off\"]", "[\"down off\"]", "[\"up pitch_deg=-80\"]"})
      for (const char* noise : {"0.0", "0.05"})
        for (const char* patch : {"0.2", "0.3"}) {
          std::vector<std::string> set = small_mine;
          set.insert(set.end(), {std::string("sensors.mounts=") + rig, std::string("sensors.beam_angle_deg=") + noise,
                                 std::string("score.patch_m=") + patch});
          cells.push_back(load_scenario("mini", set));
          cells.back().seed = seed;
        }
  return cells;
}

double seconds_of_cells(int threads) {
  const std::string dir = fresh();
  const Cost cost = cost_of([&] {
    set_threads(threads);
    run_cells(sixty_four(), {.dir = dir});
  });
  fs::remove_all(dir);
  return cost.wall_s;
}

std::vector<Figure> study() {
  const double one_s = seconds_of_cells(1), two_s = seconds_of_cells(2);
  // Every eighth of the runs, one after the other, each with all cores as a user would have it.
  const std::vector<Scenario> all = sixty_four();
  double runs_s = 0;
  for (size_t i = 0; i < all.size(); i += 8) {
    const std::string dir = fresh();
    fs::create_directories(dir);
    runs_s += cost_of([&] {
                set_threads(2);
                Console console(true, false);
                std::vector<std::string> set = small_mine;
                std::string mounts;
                for (const std::string& m : all[i].sensors.mounts)
                  mounts += (mounts.empty() ? "\"" : ", \"") + m + "\"";
                set.insert(set.end(), {"sensors.mounts=[" + mounts + "]",
                                       "sensors.beam_angle_deg=" + std::to_string(all[i].sensors.beam_angle_deg),
                                       "score.patch_m=" + std::to_string(all[i].score.patch_m)});
                std::freopen("/dev/null", "w", stdout);
                run_command("mini", {dir, all[i].seed, set}, console);
              }).wall_s;
    fs::remove_all(dir);
  }
  runs_s *= 8;
  return {
      {"study_2_cores", one_s / two_s, "ratio", "higher", "64 full cells on 200 m of passages: 1 thread against 2", 64},
      {"study_vs_runs", runs_s / two_s, "ratio", "higher",
       "64 separate runs (8 measured) with their pages, against the study, 2 threads", 64}};
}

std::vector<Figure> placements() {
  set_threads(0);
  Study study;
  study.scenario = "bruceton";
  study.mounts.count = 4;
  study.mounts.orientations = {"[0.0, -90.0, 0.0]", "[0.0, 90.0, 0.0]", "[0.0, 0.0, 90.0]", "[0.0, 0.0, 0.0]"};
  study.mounts.spacing_m = 0.4;
  const FastCourse course(load_scenario("bruceton"), study.fast);
  const std::vector<Candidate> candidates = candidates_of(study, course.hull());
  RigText text{"candidates", {}};
  for (const Candidate& c : candidates) text.lasers.push_back(c.mount);
  const Rig rig = rig_of(text, 38400);
  size_t looked_at = 0;
  const double wall_s = best_seconds(1, [&] {
    std::vector<Sight> sights(candidates.size());
    parallel_for(sights.size(), [&](size_t i) { sights[i] = course.course().sight(rig.mounts[i], course.hull()); });
    looked_at = search(course.course(), candidates, sights, {}, 4, {}, 0.15).scored.size();
  });
  return {{"placements_per_s", static_cast<double>(looked_at) / wall_s, "1/s", "higher",
           "placements of four lasers scored along bruceton at " + std::to_string(course.course().stations()) +
               " stations 2 m apart, out of " + std::to_string(candidates.size()) + " candidates, rays of all included",
           static_cast<std::int64_t>(looked_at)}};
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, {{{"study_2_cores", "study_vs_runs"}, study}, {{"placements_per_s"}, placements}});
}
