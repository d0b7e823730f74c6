// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "cli/cells.h"
#include "tests/support/folder.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <map>

namespace adit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// One loop of some 60 m; the changes are those of a command line.
Scenario tiny(std::vector<std::string> changes = {}) {
  changes.insert(changes.begin(), "sensors.baud=9600");  // few scans
  return load_scenario(ADIT_SOURCE_DIR "/tests/cli/tiny.toml", changes);
}

std::string fresh(const std::string& name) {
  const std::string dir = scratch("cells_") + name;
  fs::remove_all(dir);
  return dir;
}

TEST(Cells, TheNameDependsOnWhatTheScoreDependsOnAndOnNothingElse) {
  const Scenario s = tiny();
  EXPECT_EQ(cell_name(s).size(), 16u);
  EXPECT_EQ(cell_name(s), cell_name(tiny({"name=other", "about=words", "report.width_px=600"})));
  for (const char* change : {"seed=8", "world.height_m=1.5", "drive.speed_mps=0.6", "sensors.noise=false",
                             "map.method=icra2003", "score.patch_m=0.3", "sensors.mounts=[\"up off\"]"})
    EXPECT_NE(cell_name(s), cell_name(tiny({change}))) << change;
}

TEST(Cells, TheNameChangesWithWhatIsInTheRigsFile) {
  const std::string file = fresh("rig.toml");
  write_text(file, "[[laser]]\nname = \"front\"\n");
  const std::string before = cell_name(tiny({"sensors.rig=" + file}));
  write_text(file, "[[laser]]\nname = \"front\"\nyaw_deg = 1.0\n");
  EXPECT_NE(cell_name(tiny({"sensors.rig=" + file})), before);
  fs::remove(file);
}

TEST(Cells, TheNameChangesWithWhatIsInTheLaserFilesThatARigFileOrAMountNames) {
  const std::string sheet = fresh("sheet.toml"), rig = fresh("naming_rig.toml");
  const auto sheet_says = [&](const std::string& range) { write_text(sheet, "range_max_m = " + range + "\n"); };
  write_text(rig, "[[laser]]\nname = \"front\"\nmodel = \"" + sheet + "\"\n");
  const std::vector<std::string> by_rig{"sensors.rig=" + rig},
      by_mount{"sensors.mounts=[\"front model=" + sheet + "\"]"};
  sheet_says("20.0");
  const std::string in_rig = cell_name(tiny(by_rig)), on_mount = cell_name(tiny(by_mount));
  sheet_says("30.0");
  EXPECT_NE(cell_name(tiny(by_rig)), in_rig);
  EXPECT_NE(cell_name(tiny(by_mount)), on_mount);
  sheet_says("20.0");
  EXPECT_EQ(cell_name(tiny(by_rig)), in_rig);
  fs::remove(sheet), fs::remove(rig);
}

TEST(Cells, OfOneMineInAnyOrderOnAnyThreadsInAnyShardsAreTheSameBytesAndFailuresAreRows) {
  // Two cells of one recording, one of another rig, one that cannot drive, one whose rig cannot be.
  const std::vector<Scenario> all{tiny(), tiny({"score.patch_m=0.4"}), tiny({"sensors.mounts=[\"up off\"]"}),
                                  tiny({"vehicle=nowhere"}), tiny({"sensors.mounts=[\"front off\"]"})};
  const std::string one = fresh("one"), other = fresh("other");
  set_threads(1);
  const CellsRun first = run_cells(all, {.dir = one});
  EXPECT_EQ(first.made, 5u);
  EXPECT_EQ(first.failed, 2u);
  set_threads(3);
  for (int shard : {2, 1}) run_cells({all.rbegin(), all.rend()}, {.dir = other, .shard = shard, .shards = 2});
  set_threads(0);
  EXPECT_EQ(bytes_of(one), bytes_of(other));

  const CellsRun again = run_cells(all, {.dir = one});
  EXPECT_EQ(again.there, 5u);
  EXPECT_EQ(again.made, 0u);
  EXPECT_EQ(again.failed, 2u);
  const auto cell = [&](size_t i) { return *load_cell(one, cell_name(all[i])); };
  EXPECT_TRUE(cell(0).score);
  EXPECT_GT(cell(0).seconds, 0);
  EXPECT_THAT(cell(3).failure, HasSubstr("'nowhere' is not bundled under sim/vehicles"));
  EXPECT_THAT(cell(4).failure, HasSubstr("no horizontal laser"));
  EXPECT_FALSE(load_cell(one, "0000000000000000"));
  fs::remove_all(one), fs::remove_all(other);
}

TEST(Cells, ThatDifferOnlyInHowTheyAreScoredMakeTheirMapOnce) {
  const std::string dir = fresh("shared_map"), calls = fresh("calls");
  fs::remove(calls);
  const std::string mapper = "map.external.command=[\"sh\", \"-c\", \"echo called >>" + calls + "; exit 3\"]";
  const std::vector<Scenario> all{tiny({mapper}), tiny({mapper, "score.patch_m=0.4"}),
                                  tiny({mapper, "map.method=icra2003"})};
  const CellsRun run = run_cells(all, {.dir = dir});
  EXPECT_EQ(run.failed, 3u);
  EXPECT_EQ(read_text(calls), "called\ncalled\n");  // one for each way of mapping
  for (const Scenario& s : all) EXPECT_THAT(load_cell(dir, cell_name(s))->failure, HasSubstr("mapper failed"));
  fs::remove_all(dir), fs::remove(calls);
}

TEST(Cells, AreScoredToTheByteAsARunIsAndAFolderLeftByAKilledProcessIsSweptAway) {
  const std::string dir = fresh("run"), out = fresh("run_out");
  fs::create_directories(dir);
  const Scenario s = tiny();
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::string left = dir + "/." + cell_name(s) + "." + host + ".999999999";
  write_text(left + "/scenario.toml", "half");
  run_cells({s}, {.dir = dir, .keep_map = true});
  EXPECT_FALSE(fs::exists(left));
  ASSERT_EQ(
      std::system((std::string(ADIT_BINARY) + " run " + ADIT_SOURCE_DIR +
                   "/tests/cli/tiny.toml --set sensors.baud=9600 --set name=cell --quiet -o " + out + " >/dev/null")
                      .c_str()),
      0);
  EXPECT_EQ(read_text(dir + "/" + cell_name(s) + "/score.json"), read_text(out + "/score.json"));
  EXPECT_TRUE(fs::exists(dir + "/" + cell_name(s) + "/map/trajectory.tum"));
  fs::remove_all(dir), fs::remove_all(out);
}

TEST(Cells, AShardThatIsNoneIsAnError) {
  for (const auto& [i, n] : {std::pair{0, 2}, {3, 2}, {1, 0}})
    EXPECT_THROW(run_cells({}, {.dir = fresh("none"), .shard = i, .shards = n}), Error);
}

}  // namespace
}  // namespace adit
