// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/sqlite.h"
#include "eval/trend_page.h"
#include "tests/eval/simulated_nights.h"
#include "tests/support/errors.h"
#include "tests/support/scratch.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <filesystem>

namespace adit {
namespace {

Night remarkable(int k) {
  Night n = Simulation{}.night(k);
  n.verdict = "regressed", n.date = "2026-03-01 02:00";
  n.cells[1].peak_gib = 0.5;
  n.cells[2].failure = "drive stuck", n.cells[2].value.clear(), n.cells[2].run = "runs/x";
  n.claims.push_back({"mini", "adit", "m1", "regressed", "1 -> 2"});
  return n;
}

TEST(History, GivesBackWhatWasPutIn) {
  const std::string file = scratch("h/history.db");
  {
    History h(file);
    EXPECT_EQ(h.add(remarkable(1)), 1);
    EXPECT_EQ(h.add(remarkable(2)), 2);
  }
  const std::vector<Night> nights = History(file).nights("simulated");
  ASSERT_EQ(nights.size(), 2u);
  const Night &n = nights[1], like = remarkable(2);
  EXPECT_EQ(n.commit, like.commit);
  EXPECT_EQ(n.date, like.date);
  ASSERT_EQ(n.cells.size(), like.cells.size());
  for (size_t k = 0; k < n.cells.size(); ++k) {
    EXPECT_EQ(n.cells[k].value, like.cells[k].value);  // the same bits
    EXPECT_EQ(n.cells[k].failure, like.cells[k].failure);
    EXPECT_EQ(n.cells[k].seed, like.cells[k].seed);
    EXPECT_EQ(n.cells[k].truth, like.cells[k].truth);
  }
  EXPECT_EQ(n.cells[1].peak_gib, 0.5);
  EXPECT_TRUE(std::isnan(n.cells[0].peak_gib));
  ASSERT_EQ(n.claims.size(), 1u);
  EXPECT_EQ(n.claims[0].words, "1 -> 2");
  EXPECT_TRUE(History(file).nights("another").empty());
}

TEST(History, OneOfSchema1KeepsItsNightsAndTakesNewOnes) {
  const std::string file = scratch("old.db");
  { History(file).add(remarkable(1)); }
  Sqlite(file).exec("ALTER TABLE cell DROP COLUMN peak_gib; PRAGMA user_version = 1");
  History(file).add(remarkable(2));
  const std::vector<Night> nights = History(file).nights("simulated");
  ASSERT_EQ(nights.size(), 2u);
  EXPECT_EQ(nights[0].cells[1].value, remarkable(1).cells[1].value);
  EXPECT_TRUE(std::isnan(nights[0].cells[1].peak_gib));
  EXPECT_EQ(nights[1].cells[1].peak_gib, 0.5);
}

TEST(History, AcceptsTheLastNightOfABranch) {
  History h(scratch("accept.db"));
  EXPECT_THROW(h.accept("simulated", "", "why"), Error);
  h.add(remarkable(1));
  EXPECT_EQ(h.accept("simulated", "main", "a new baseline"), 1);
  EXPECT_EQ(h.nights("simulated")[0].accepted, "a new baseline");
  EXPECT_THROW(h.accept("simulated", "other", "why"), Error);
}

TEST(History, RefusesWhatIsNoneOrNewer) {
  write_text(scratch("text.db"),
             "this is not a database, however long it may be; it is prose and nothing else at all.");
  EXPECT_NE(error_of([] { History h(scratch("text.db")); }).find("text.db"), std::string::npos);
  Sqlite(scratch("foreign.db")).exec("CREATE TABLE t (x)");
  EXPECT_NE(error_of([] { History h(scratch("foreign.db")); }).find("not a history of adit"), std::string::npos);
  { History h(scratch("newer.db")); }
  Sqlite(scratch("newer.db")).exec("PRAGMA user_version = 99");
  EXPECT_NE(error_of([] { History h(scratch("newer.db")); }).find("newer adit (schema 99"), std::string::npos);
  EXPECT_NE(error_of([] { History h(std::filesystem::temp_directory_path().string()); }), "");
}

TEST(History, ALockedFileIsAnErrorAndStaysWhole) {
  const std::string file = scratch("locked.db");
  History h(file, 50);
  h.add(remarkable(1));
  Sqlite other(file);
  other.exec("BEGIN EXCLUSIVE");
  EXPECT_NE(error_of([&] { h.add(remarkable(2)); }).find("locked"), std::string::npos);
  other.exec("ROLLBACK");
  EXPECT_EQ(h.nights("simulated").size(), 1u);
  EXPECT_EQ(h.add(remarkable(2)), 2);
}

TEST(History, TwoRunsAtOnceBothGetIn) {
  const std::string file = scratch("two.db");
  const auto write_ten = [&] {
    for (int k = 0; k < 10; ++k) History(file).add(remarkable(k));
  };
  const pid_t child = ::fork();
  if (child == 0) {
    write_ten();
    ::_exit(0);
  }
  write_ten();
  int status = 1;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  EXPECT_EQ(History(file).nights("simulated").size(), 20u);
}

TEST(History, AFullDiskLeavesItAsItWas) {
  const std::string file = scratch("full.db");
  { History(file).add(remarkable(1)); }
  const auto before = ::signal(SIGXFSZ, SIG_IGN);
  rlimit was{};
  ::getrlimit(RLIMIT_FSIZE, &was);
  rlimit small = was;
  small.rlim_cur = std::filesystem::file_size(file);
  ::setrlimit(RLIMIT_FSIZE, &small);
  Simulation large;
  large.metrics = 200;
  const std::string error = error_of([&] { History(file).add(large.night(2)); });
  ::setrlimit(RLIMIT_FSIZE, &was);
  ::signal(SIGXFSZ, before);
  EXPECT_NE(error.find("full.db"), std::string::npos) << error;
  EXPECT_EQ(History(file).nights("simulated").size(), 1u);
}

TEST(History, AKillAmidANightLeavesItAsItWas) {
  const std::string file = scratch("killed.db");
  { History(file).add(remarkable(1)); }
  if (const pid_t child = ::fork(); child == 0) {
    Sqlite base(file);
    base.exec("PRAGMA cache_size = 1; BEGIN IMMEDIATE");  // so that pages reach the file before the end
    for (int k = 0; k < 2000; ++k) base.exec("INSERT INTO metric (name) VALUES ('name" + std::to_string(k) + "')");
    ::kill(::getpid(), SIGKILL);
  } else {
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
  }
  const std::vector<Night> nights = History(file).nights("simulated");
  ASSERT_EQ(nights.size(), 1u);
  EXPECT_EQ(nights[0].cells.size(), remarkable(1).cells.size());
  Sqlite base(file);
  SqliteStatement check = base.prepare("PRAGMA integrity_check");
  ASSERT_TRUE(check.step());
  EXPECT_EQ(check.text(0), "ok");
}

// Three months: a regression that is mended, an improvement, another evaluator, another machine, a creep.
std::vector<Night> three_months(const SuiteRules& rules) {
  Simulation s;
  s.seeds = 12, s.metrics = 5, s.noise = 0.004;
  s.factor = [](int metric, int night) {
    if (metric == 0) return night >= 20 && night < 25 ? 1.08 : 1.0;
    if (metric == 1) return night >= 35 ? 0.92 : 1.0;
    if (metric == 2) return 1 + 0.0025 * std::max(0, night - 66);
    return 1.0;
  };
  std::vector<Night> nights;
  for (int k = 1; k <= 92; ++k) {
    Night n = s.night(k);
    char date[32];
    std::snprintf(date, sizeof date, "2026-%02d-%02d", 3 + (k - 1) / 30, 1 + (k - 1) % 30);
    n.date = date;
    if (k >= 50) n.evaluator = "evaluator 2";
    if (k >= 62) n.machine = "another box";
    for (NightCell& c : n.cells) c.seconds = k >= 62 ? 14 : 20;
    live_through(n, nights, rules);
  }
  return nights;
}

TEST(TrendPage, TellsThreeMonthsAsTheyWere) {
  SuiteRules rules = Simulation{}.rules(3);
  rules.metric.resize(5);
  const std::vector<Night> nights = three_months(rules);
  std::vector<std::string> told;
  for (const Event& e : story(nights)) told.push_back(e.kind + " " + std::to_string(nights[e.night].id));
  ASSERT_EQ(told.size(), 6u) << testing::PrintToString(told);
  EXPECT_EQ(told[0], "regressed 20");
  EXPECT_EQ(told[1], "recovered 25");
  EXPECT_EQ(told[2], "improved 35");
  EXPECT_EQ(told[3], "evaluator 50");
  EXPECT_EQ(told[4], "machine 62");
  EXPECT_EQ(told[5].substr(0, 6), "crept ");
  const int crept = std::stoi(told[5].substr(6));
  EXPECT_GE(crept, 74);  // 3 % are reached 12 nights after night 66, less the noise of a median of 12 seeds
  EXPECT_LE(crept, 84);
}

TEST(TrendPage, IsOneFileWithALineForEachMetricAndALinkForEachRun) {
  SuiteRules rules = Simulation{}.rules(3);
  rules.metric.resize(5);
  std::vector<Night> nights = three_months(rules);
  for (Night& n : nights) n.cells[0].run = "runs/" + n.commit + "/index.html";
  const std::string dir = std::getenv("ADIT_KEEP_PAGE") ? std::getenv("ADIT_KEEP_PAGE") : scratch("trend");
  write_trend_page(dir, {"simulated", "three months", {"m0", "m1", "m2", "m3", "m4"}, nights, {}});
  const std::string html = read_text(dir + "/index.html");
  for (const char* part : {"<code>m0</code>", "<code>m4</code>", "href=\"runs/c20/index.html\"", "tag bad", "tag good",
                           "another evaluator", "another box"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
  for (const char* foreign : {"http:", "https:", "src=\"//"}) EXPECT_EQ(html.find(foreign), std::string::npos);
}

}  // namespace
}  // namespace adit
