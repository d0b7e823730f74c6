// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/world.h"
#include "cli/set_command.h"
#include "tests/support/scratch.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const char* const words =
    "scenario = \"mini\"\nmines = 4\nseed = 5\n"
    "set = [\"world.mesh_edge_m=0.6\", \"world.panel.crosscuts=2\"]\n"
    "vary = [\"world.height_m uniform 1.85 2.2\", \"world.condition choice bare abandoned\"]\n"
    "split = [0.5, 0.25, 0.25]\n";

std::string set_file(const std::string& name, const std::string& text) {
  const std::string file = scratch(name);
  write_text(file, text);
  return file;
}

int make(const std::string& file, const std::string& out) {
  Console silent(true, false);
  return set_command(file, {out, -1, {}}, silent);
}

TEST(Set, AnInterruptedSetGoesOnAndEndsAsIfItHadNotBeen) {
  const std::string file = set_file("set.toml", words), out = scratch("set");
  ASSERT_TRUE(is_set(file));
  ASSERT_EQ(make(file, out), 0);
  const std::string manifest = read_text(out + "/manifest.csv"), truth = read_text(out + "/mine-0002/world/truth.json");
  const auto kept = fs::last_write_time(out + "/mine-0001/world/mine.ply");
  fs::remove(out + "/mine-0002/mine.json");
  fs::remove(out + "/mine-0002/world/truth.json");
  fs::remove(out + "/manifest.csv");
  ASSERT_EQ(make(file, out), 0);
  EXPECT_EQ(read_text(out + "/manifest.csv"), manifest);
  EXPECT_EQ(read_text(out + "/mine-0002/world/truth.json"), truth);
  EXPECT_EQ(fs::last_write_time(out + "/mine-0001/world/mine.ply"), kept);

  const json rows = json::parse(read_text(out + "/manifest.json"));
  ASSERT_EQ(rows.size(), 4u);
  std::map<std::string, int> parts;
  for (const json& row : rows) {
    const double asked = std::stod(row["world.height_m"].get<std::string>());
    EXPECT_GE(asked, 1.85);
    EXPECT_LE(asked, 2.2);
    EXPECT_NEAR(row["height_m"].get<double>(), asked, 0.3);  // 2.5 sd of 0.1 m, and a roof that sags
    ++parts[row["split"].get<std::string>()];
    const World world = load_world(out + "/" + row["mine"].get<std::string>() + "/world");
    EXPECT_EQ(world.objects.size(), row["things"].get<size_t>());
    EXPECT_EQ(world.objects.empty(), row["world.condition"] == "bare");
  }
  EXPECT_EQ(parts["train"], 2);
  EXPECT_EQ(parts["val"], 1);
  EXPECT_EQ(parts["test"], 1);
  EXPECT_NE(read_text(out + "/README.md").find("| mines | 4 |"), std::string::npos);
}

TEST(Set, MinesOfOnePlanAreInOnePartOfTheSplit) {
  const std::string file = set_file("plans.toml",
                                    "scenario = \"figure-eight\"\nmines = 3\nset = [\"world.mesh_edge_m=0.6\"]\n"
                                    "split = [0.4, 0.3, 0.3]\n");
  const std::string out = scratch("plans");
  ASSERT_EQ(make(file, out), 0);
  std::set<std::string> parts;
  for (const json& row : json::parse(read_text(out + "/manifest.json"))) parts.insert(row["split"].get<std::string>());
  EXPECT_EQ(parts.size(), 1u);
}

TEST(Set, AMineThatCannotBeMadeIsARowWithItsReason) {
  const std::string file = set_file("bad.toml",
                                    "scenario = \"mini\"\nmines = 2\nset = [\"world.panel.crosscuts=2\"]\n"
                                    "vary = [\"world.mesh_edge_m choice 0.95\"]\n");
  EXPECT_EQ(make(file, scratch("bad")), 1);
  const json rows = json::parse(read_text(scratch("bad") + "/manifest.json"));
  EXPECT_NE(rows[0]["error"].get<std::string>().find("world.mesh_edge_m"), std::string::npos);
}

TEST(Set, AVariableThatMakesNoSenseIsRefusedWithItsWords) {
  for (const char* vary : {"world.height_m uniform 2", "world.height_m uniform 3 2", "world.height_m about 2",
                           "world.height_m normal 1 2 x 4", "world.height_m choice"}) {
    const std::string file = set_file("no.toml", std::string("mines = 1\nvary = [\"") + vary + "\"]\n");
    try {
      make(file, scratch("no"));
      FAIL() << vary;
    } catch (const Error& e) {
      EXPECT_NE(std::string(e.what()).find(vary), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace adit
