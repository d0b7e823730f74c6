// SPDX-License-Identifier: BSD-3-Clause
// `adit nightly` as its users call it.
#include "base/files.h"
#include "base/sqlite.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

namespace adit {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string suite = R"(
about = "the tiny mine"
seeds = 2
pictures = true
[[scenario]]
scenario = ")" ADIT_SOURCE_DIR R"(/tests/cli/tiny.toml"
[[metric]]
name = "map.local_5m.mae_m"
relevant_percent = 2
at_most = 0.1
[[metric]]
name = "grid.iou_free"
better = "higher"
)";

std::string suite_file(const std::string& text) {
  const std::string file = scratch("tiny-suite.toml");
  write_text(file, text);
  return file;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

struct Answer {
  int exit_code;
  std::string out, err;
};
Answer nightly(const std::string& text, const std::string& words) {
  const std::string at = scratch("nightly_says");
  const int status = std::system((std::string(ADIT_BINARY) + " nightly " + suite_file(text) + " --branch main " +
                                  words + " >" + at + ".out 2>" + at + ".err")
                                     .c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(at + ".out"), read_text(at + ".err")};
}

// One folder for all: its runs are made once.
std::string there() {
  return " --commit c1 -o " + scratch("nightly_out") + " ";
}

std::int64_t nights_in(const std::string& history) {
  Sqlite base(history);
  SqliteStatement count = base.prepare("SELECT count(*) FROM night");
  return count.step() ? count.integer(0) : -1;
}

TEST(Nightly, ShardsMakeTheRunsAndTheCallWithoutThemJudges) {
  EXPECT_EQ(nightly(suite, "--shard 3/2" + there()).exit_code, 2);
  EXPECT_EQ(nightly(suite, "--shard 1/2" + there()).exit_code, 0);
  const Answer second = nightly(suite, "--shard 2/2 --json" + there());
  EXPECT_EQ(nlohmann::json::parse(second.out).at("made"), 1);
  const std::string history = scratch("nightly.db");
  const Answer all = nightly(suite, "--json --history " + history + there());
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_THAT(all.err, HasSubstr("0 runs made, 2 there before"));
  EXPECT_EQ(nlohmann::json::parse(all.out).at("verdict"), "first");
  const Answer again = nightly(suite, "--history " + history + there());
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.out, HasSubstr("pass, against night 1 (c1)"));
  EXPECT_EQ(nights_in(history), 2);
  for (const char* file : {"verdict.json", "verdict.md", "junit.xml", "trend/index.html"})
    EXPECT_TRUE(fs::exists(scratch("nightly_out/") + file)) << file;
}

TEST(Nightly, ARunBeyondItsToleranceIsExitCodeOneWithPicturesBeforeAndAfter) {
  const std::string strict = replaced(suite, "at_most = 0.1", "at_most = 0.0001");
  const Answer answer = nightly(strict, "--history " + scratch("nightly.db") + there());
  EXPECT_EQ(answer.exit_code, 1);
  EXPECT_THAT(answer.out, HasSubstr("beyond: tiny, adit, map.local_5m.mae_m"));
  EXPECT_THAT(read_text(scratch("nightly_out/junit.xml")), HasSubstr("<failure type=\"beyond\""));
  const std::string page = read_text(scratch("nightly_out/trend/index.html"));
  for (const char* part : {".before.png", ".after.png", "../reports/tiny.adit."}) EXPECT_THAT(page, HasSubstr(part));
  EXPECT_TRUE(fs::exists(scratch("nightly_out/reports")));
  // Accepted, it is the beginning of what comes.
  EXPECT_EQ(nightly(strict, "--history " + scratch("nightly.db") + " --accept 'it is meant'").exit_code, 0);
}

TEST(Nightly, AnotherEvaluatorIsNotComparableAndSaysSo) {
  const Answer answer = nightly(suite, "--set score.loop_m=2 --history " + scratch("nightly.db") + there());
  EXPECT_EQ(answer.exit_code, 3);
  EXPECT_THAT(answer.out, HasSubstr("with [score]"));
}

TEST(Nightly, BadInputIsSaidBeforeAnythingRunsAndLeavesTheHistory) {
  const std::string history = scratch("nightly.db");
  const std::int64_t before = nights_in(history);
  const Answer scenario =
      nightly(replaced(suite, "tests/cli/tiny.toml", "tests/cli/none.toml"), "--history " + history);
  EXPECT_EQ(scenario.exit_code, 2);
  EXPECT_THAT(scenario.err, HasSubstr("tiny-suite.toml:6: "));
  EXPECT_THAT(scenario.err, HasSubstr("none.toml"));
  const Answer metric = nightly(replaced(suite, "grid.iou_free", "grid.iou_fre"), "--history " + history);
  EXPECT_EQ(metric.exit_code, 2);
  EXPECT_THAT(metric.err, HasSubstr("grid.iou_fre"));
  const Answer key = nightly(replaced(suite, "seeds = 2", "sseeds = 2"), "--history " + history);
  EXPECT_EQ(key.exit_code, 2);
  EXPECT_THAT(key.err, HasSubstr("unknown key 'sseeds'"));
  const Answer baseline = nightly(suite, "--baseline commit:none --history " + history + there());
  EXPECT_EQ(baseline.exit_code, 2);
  EXPECT_THAT(baseline.err, HasSubstr("commit:none"));
  EXPECT_EQ(nights_in(history), before);
  Sqlite(history).exec("PRAGMA user_version = 7");
  const Answer newer = nightly(suite, "--history " + history + there());
  EXPECT_EQ(newer.exit_code, 74);
  EXPECT_THAT(newer.err, HasSubstr("newer adit (schema 7"));
}

}  // namespace
}  // namespace adit
