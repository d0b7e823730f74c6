// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "cli/study_file.h"
#include "sim/vehicle.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

namespace adit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::string fresh(const std::string& name) {
  const std::string dir = scratch("study_") + name;
  fs::remove_all(dir);
  return dir;
}

std::string file_of(const std::string& toml) {
  const std::string file = scratch("study_file.toml");
  write_text(file, toml);
  return file;
}

std::string error_of(const std::string& toml) {
  try {
    load_study(file_of(toml));
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

struct Answer {
  int exit_code;
  std::string out, err;
};
Answer adit_says(const std::string& words) {
  const std::string at = scratch("study_says");
  const int status =
      std::system((std::string(ADIT_BINARY) + " " + words + " >" + at + ".out 2>" + at + ".err").c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(at + ".out"), read_text(at + ".err")};
}

std::map<std::string, std::string> bytes_of(const std::string& dir) {
  std::map<std::string, std::string> all;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(dir))
    if (entry.is_regular_file() && entry.path().filename() != "timing.json" &&
        entry.path().filename() != "study.sqlite")  // holds seconds
      all[fs::relative(entry.path(), dir).string()] = read_text(entry.path().string());
  return all;
}

TEST(Study, AGridIsEveryCombinationAndARangeHoldsBothEnds) {
  const Study s =
      load_study(file_of("[[factor]]\nkey = \"drive.speed_mps\"\nfrom = 0.4\nto = 1.0\nsteps = 4\n"
                         "[[factor]]\nkey = \"sensors.baud\"\nvalues = [9600, 38400]\n"
                         "[[factor]]\nkey = \"rig.up.pitch_deg\"\nvalues = [-90.0, -80.0, -70.0]\n"));
  EXPECT_EQ(design_size(s), 24);
  const std::vector<DesignPoint> points = design_of(s);
  EXPECT_EQ(std::set<std::vector<std::string>>([&] {
              std::set<std::vector<std::string>> all;
              for (const DesignPoint& p : points) all.insert(p.level);
              return all;
            }())
                .size(),
            24u);
  EXPECT_EQ(points.front().level, (std::vector<std::string>{"0.4", "9600", "-90.0"}));
  EXPECT_EQ(points.back().level, (std::vector<std::string>{"1.0", "38400", "-70.0"}));
  const Scenario last = scenario_at(s, points.back(), 5);
  EXPECT_EQ(last.drive.speed_mps, 1);
  EXPECT_EQ(last.seed, 5);
  const Rig rig = load_rig(last.sensors);
  EXPECT_NEAR(std::acos(rig.mounts[2].X_BS.linear().col(0).z()) * 180 / M_PI, 20, 1e-9);  // from straight up
}

TEST(Study, EveryDyadicPieceOfTheUnitSquareHoldsOneOfTheFirstSobolPoints) {
  // A (0, m, 2)-net in the first two dimensions, whatever the shift; and in every dimension one point a 64th.
  const auto points = sobol(64, 16, 7);
  for (int columns : {1, 2, 4, 8, 16, 32, 64}) {
    std::set<int> seen;
    for (const auto& p : points)
      seen.insert(static_cast<int>(p[0] * columns) * 1000 + static_cast<int>(p[1] * (64.0 / columns)));
    EXPECT_EQ(seen.size(), 64u) << columns;
  }
  for (size_t d = 0; d < 16; ++d) {
    std::set<int> seen;
    for (const auto& p : points) seen.insert(static_cast<int>(p[d] * 64));
    EXPECT_EQ(seen.size(), 64u) << "dimension " << d;
  }
  EXPECT_THROW(sobol(2, 17, 1), Error);
}

TEST(Study, ALatinHypercubeHasOnePointInEachStratumOfEachDimension) {
  for (int seed : {1, 2, 3}) {
    const auto points = latin_hypercube(37, 5, seed);
    for (size_t d = 0; d < 5; ++d) {
      std::set<int> seen;
      for (const auto& p : points) seen.insert(static_cast<int>(p[d] * 37));
      EXPECT_EQ(seen.size(), 37u) << "seed " << seed;
    }
  }
}

TEST(Study, SamplesOfARangeLieWithinItAndOfWholeNumbersAreWhole) {
  const Study s =
      load_study(file_of("sample = \"sobol\"\nsamples = 32\n"
                         "[[factor]]\nkey = \"drive.speed_mps\"\nfrom = 0.3\nto = 1.2\nlog = true\n"
                         "[[factor]]\nkey = \"sensors.sub_rays\"\nfrom = 1\nto = 37\nwhole = true\n"));
  for (const DesignPoint& p : design_of(s)) {
    const Scenario at = scenario_at(s, p, 1);
    EXPECT_GE(at.drive.speed_mps, 0.3);
    EXPECT_LE(at.drive.speed_mps, 1.2);
    EXPECT_EQ(p.level[1], std::to_string(at.sensors.sub_rays));
  }
}

TEST(Study, WhatIsWrittenOutIsTheSameStudyAgain) {
  for (const char* name : {"decay", "groundhog", "placements", "quick"}) {
    const std::string once = to_toml(load_study(name, {"drive.lead_in_s=1.0"}));
    EXPECT_EQ(to_toml(load_study(file_of(once))), once);
  }
}

TEST(Study, ALevelOfSetStandsForManyChanges) {
  const Study s = load_study(
      file_of("[[factor]]\nkey = \"set\"\nname = \"mine\"\nlabels = [\"bare\", \"low\"]\n"
              "values = [[], [\"world.height_m=1.6\", \"world.decay.may_cut=true\"]]\n"
              "[[factor]]\nkey = \"set\"\nvalues = [[\"drive.speed_mps=0.5\"], [\"drive.speed_mps=0.7\"]]\n"));
  const std::vector<DesignPoint> points = design_of(s);
  ASSERT_EQ(points.size(), 4u);
  EXPECT_EQ(points[0].level[0], "bare");
  EXPECT_EQ(scenario_at(s, points[0], 1).world.height_m, load_scenario("mini").world.height_m);
  const Scenario low = scenario_at(s, points[3], 1);
  EXPECT_EQ(low.world.height_m, 1.6);
  EXPECT_TRUE(low.world.decay.may_cut);
  EXPECT_EQ(low.drive.speed_mps, 0.7);
  EXPECT_THAT(error_of("[[factor]]\nkey = \"set\"\nvalues = [[\"world.heigt_m=1.6\"]]\n"),
              HasSubstr("did you mean 'world.height_m'?"));
  EXPECT_THAT(error_of("[[factor]]\nkey = \"set\"\nvalues = [3]\n"), HasSubstr("set"));
}

TEST(Study, FaultsInItsFileNameLineKeyAndWhatWouldBeRight) {
  EXPECT_THAT(error_of("seedz = [1]\n"), HasSubstr("study_file.toml:1: unknown key 'seedz' (did you mean 'seeds'?)"));
  EXPECT_THAT(error_of("seeds = []\n"), HasSubstr("needs one seed"));
  EXPECT_THAT(error_of("objectives = [\"map.se3.p95\"]\n"), HasSubstr("names 'map.se3.p95', which is no metric"));
  EXPECT_THAT(error_of("objectives = [\"map.se3.p95_m\"]\nfull = false\n"), HasSubstr("needs runs, and full = false"));
  EXPECT_THAT(error_of("seeds = [1, 1]\n"), HasSubstr("holds a seed twice"));
  EXPECT_THAT(error_of("[[factor]]\nvalues = [1]\n"), HasSubstr("'key' is missing"));
  EXPECT_THAT(error_of("[[factor]]\nkey = \"drive.speed_mps\"\nvalues = []\n"), HasSubstr("needs a value at least"));
  EXPECT_THAT(error_of("[[factor]]\nkey = \"drive.speed_mps\"\nfrom = 1.0\nto = 2.0\n"), HasSubstr("needs steps = N"));
  EXPECT_THAT(error_of("[[factor]]\nkey = \"drive.sped_mps\"\nvalues = [0.5]\n"),
              HasSubstr("did you mean 'drive.speed_mps'?"));
  EXPECT_THAT(error_of("[[factor]]\nkey = \"rig.up\"\nvalues = [0.5]\n"), HasSubstr("must be rig.LASER.KEY"));
  EXPECT_THAT(error_of("[[factor]]\nkey = \"seed\"\nvalues = [1]\n"), HasSubstr("seeds = [...]"));
}

TEST(Study, AMisspeltKeyOfAMountAndALimitWithoutPricesAreSaidBeforeAnythingRuns) {
  const std::string out = fresh("early");
  const auto said = [&](const std::string& toml) {
    const Answer a = adit_says("study " + file_of(toml) + " -o " + out);
    EXPECT_EQ(a.exit_code, 2) << a.err;
    EXPECT_FALSE(fs::exists(out + "/cells"));
    return a.err;
  };
  EXPECT_THAT(said("[[factor]]\nkey = \"rig.up.pich_deg\"\nvalues = [-80.0]\n"), HasSubstr("pitch_deg"));
  EXPECT_THAT(said("price_max = 10.0\n"), HasSubstr("no [[device]] for the model 'lms200'"));
  EXPECT_THAT(said("price_max = 10.0\n[[device]]\nmodel = \"lms200\"\nprice = 4000.0\n"),
              HasSubstr("limits exclude all 1 points: 1 for price above price_max"));
  EXPECT_THAT(said("clearance_m = 0.5\n"), HasSubstr("nearer to the hull than clearance_m"));
  std::string many;
  for (const char* key : {"drive.speed_mps", "drive.gait_hz", "drive.wobble_deg"})
    many += "[[factor]]\nkey = \"" + std::string(key) + "\"\nfrom = 0.5\nto = 1.0\nsteps = 1000\n";
  const std::string refused = said("seeds = [1]\n" + many);
  EXPECT_THAT(refused, HasSubstr("asks for 1e+09 cells"));
  EXPECT_THAT(refused, HasSubstr("days on"));
  EXPECT_THAT(said("sample = \"gird\"\n"), HasSubstr("one of \"grid\""));
}

TEST(Study, CandidatesThatNoHullLeavesOrThatAreTooManyAreErrors) {
  Study s;
  s.mounts.count = 1;
  s.mounts.orientations = {"[0.0, -90.0, 0.0]"};
  const Hull hull = load_vehicle("cart").hull;
  EXPECT_FALSE(candidates_of(s, hull).empty());
  s.mounts.most = 3;
  EXPECT_THROW(candidates_of(s, hull), Error);
  s.mounts.orientations.clear();
  EXPECT_THROW(candidates_of(s, hull), Error);
}

// Two rigs on the tiny mine: the cart's, and one whose ceiling laser looks into its own tower.
const std::string planted = "scenario = \"" ADIT_SOURCE_DIR
                            "/tests/cli/tiny.toml\"\n"
                            "set = [\"sensors.baud=9600\"]\nseeds = [7]\n"
                            "objectives = [\"volume.error_percent\", \"map.se3.p95_m\"]\n"
                            "[[factor]]\nkey = \"sensors.mounts\"\nname = \"rig\"\n"
                            "values = [[], [\"up pitch_deg=90\", \"profile off\", \"down off\"]]\n"
                            "labels = [\"cart\", \"blind\"]\n";

TEST(Study, ARigWithABlindDirectionLosesAndThePageSaysWhyAndShardsMergeToTheSameBytes) {
  const std::string file = file_of(planted), whole = fresh("whole"), parts = fresh("parts");
  const Answer one = adit_says("study " + file + " --threads 2 --json -o " + whole);
  ASSERT_EQ(one.exit_code, 0) << one.err;
  const nlohmann::json j = nlohmann::json::parse(one.out);
  EXPECT_EQ(j["best"], 0);
  EXPECT_EQ(j["worst"], 1);
  EXPECT_GT(j["points"][1]["fast"]["fast.blind_left"], 0.5);
  EXPECT_LT(j["points"][0]["fast"]["fast.blind_left"], 0.7 * j["points"][1]["fast"]["fast.blind_left"].get<double>());
  EXPECT_GT(j["points"][1]["fast"]["fast.hull"], j["points"][0]["fast"]["fast.hull"]);
  EXPECT_THAT(read_text(whole + "/index.html"), HasSubstr("it is blind there"));
  EXPECT_THAT(read_text(whole + "/recommended.toml"), HasSubstr("name = \"profile\""));

  const std::string shard = "study " + file + " --threads 1 --quiet -o " + parts;
  ASSERT_EQ(adit_says(shard + " --shard 2/2").exit_code, 0);
  const Answer early = adit_says("study merge " + parts);
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.out, HasSubstr("1 of 2 cells are not made yet"));
  ASSERT_EQ(adit_says(shard + " --shard 1/2").exit_code, 0);
  ASSERT_EQ(adit_says(shard + " --shard 1/2").exit_code, 0);  // twice
  ASSERT_EQ(adit_says("study merge --quiet " + parts).exit_code, 0);
  EXPECT_EQ(bytes_of(whole), bytes_of(parts));
  EXPECT_EQ(adit_says(shard + " --shard 3/2").exit_code, 2);

  // A full disk: earlier cells stay, and the study goes on where there is room again.
  const std::string more = file_of(planted + "[[factor]]\nkey = \"score.patch_m\"\nvalues = [0.2, 0.3]\n");
  const std::map<std::string, std::string> before = bytes_of(whole + "/cells");
  const int status = std::system(("ulimit -f 16; " + std::string(ADIT_BINARY) + " study " + more + " --quiet -o " +
                                  whole + " 2>" + scratch("full.err"))
                                     .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 74) << read_text(scratch("full.err"));
  EXPECT_EQ(bytes_of(whole + "/cells"), before);
  fs::remove_all(whole), fs::remove_all(parts);
}

// Four cells in two tasks of a job array on a Slurm of one node, one task requeued while it runs.
TEST(Study, ARequeuedJobArrayMergesToWhatOneMachineSays) {
  if (std::system("command -v slurmctld slurmd munged sbatch >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "Slurm is not installed (ci/setup --peers)";
  if (geteuid() != 0) GTEST_SKIP() << "starting a Slurm takes root";
  const std::string file = scratch("slurm.toml"), alone = fresh("alone"), array = fresh("array");
  write_text(file,
             "scenario = \"" ADIT_SOURCE_DIR
             "/tests/cli/tiny.toml\"\nset = [\"sensors.baud=9600\"]\nseeds = [7]\n"
             "[[factor]]\nkey = \"sensors.mounts\"\nvalues = [[], [\"profile off\"], [\"down off\"], [\"up off\"]]\n");
  ASSERT_EQ(adit_says("study " + file + " --quiet -o " + alone).exit_code, 0);
  const int status =
      std::system((std::string(ADIT_SOURCE_DIR) + "/tests/cli/slurm.sh " + fs::canonical(ADIT_BINARY).string() + " " +
                   ADIT_SOURCE_DIR + "/examples/slurm/study.sbatch " + file + " " + array + " " + fresh("slurm") +
                   " >" + scratch("slurm.log") + " 2>&1")
                      .c_str());
  ASSERT_EQ(WEXITSTATUS(status), 0) << read_text(scratch("slurm.log"));
  EXPECT_THAT(read_text(scratch("slurm.log")), HasSubstr("requeued"));
  EXPECT_EQ(bytes_of(alone), bytes_of(array));
  fs::remove_all(alone), fs::remove_all(array);
}

}  // namespace
}  // namespace adit
