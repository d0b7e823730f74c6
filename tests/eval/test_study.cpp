// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/rng.h"
#include "base/sqlite.h"
#include "eval/study.h"
#include "eval/study_page.h"
#include "tests/support/scratch.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <limits>

namespace adit {
namespace {

using ::testing::HasSubstr;

constexpr double none = std::numeric_limits<double>::quiet_NaN();

// Two factors of two levels, six seeds; error = 10 + 4 a + 2 b + 3 a b + the seed's own, exactly.
StudyTable planted() {
  StudyTable t;
  t.name = "planted";
  t.factor = {"a", "b"};
  t.metric = {{"error_m", "m", Better::lower}, {"found", "share", Better::higher}};
  t.objective = {"error_m", "found", "price"};
  for (const int a : {0, 1})
    for (const int b : {0, 1}) {
      const size_t p = t.point.size();
      t.point.push_back({{std::to_string(a), std::to_string(b)},
                         100.0 - 50 * a,
                         1,
                         std::vector<double>(fast_columns().size(), -1.0 * a)});
      for (int seed = 1; seed <= 6; ++seed)
        t.cell.push_back({"c" + std::to_string(10 * p) + std::to_string(seed),
                          "",
                          p,
                          seed,
                          {10.0 + 4 * a + 2 * b + 3 * a * b + seed, 0.9},
                          1.5});
    }
  return t;
}

TEST(Study, SharesOfVarianceAreThoseOfThePlantedEffects) {
  const StudyAnswer answer = answer_of(planted());
  // Means over the other factor: a: 11 and 16.5, b: 12 and 15.5; the four means about 13.75: -3.75, -1.75, 0.25, 5.25.
  const double all = 3.75 * 3.75 + 1.75 * 1.75 + 0.25 * 0.25 + 5.25 * 5.25, a = 4 * 2.75 * 2.75, b = 4 * 1.75 * 1.75;
  ASSERT_EQ(answer.effect.size(), 4u);  // two factors, two objectives that are metrics
  EXPECT_NEAR(answer.effect[0].share, a / all, 1e-12);
  EXPECT_NEAR(answer.effect[1].share, b / all, 1e-12);
  EXPECT_NEAR(answer.interaction[0].share, 1 - (a + b) / all, 1e-12);
  EXPECT_NEAR(answer.effect[0].level[0].value.median, (10 + 12) / 2.0 + 3.5, 1e-12);
}

TEST(Study, TheFrontHoldsWhatIsBestInSomethingAndTheWorstIsWorstInAll) {
  const StudyAnswer answer = answer_of(planted());
  EXPECT_TRUE(answer.point[0].front);   // least error
  EXPECT_FALSE(answer.point[1].front);  // as dear, more error
  EXPECT_TRUE(answer.point[2].front);   // cheaper
  EXPECT_FALSE(answer.point[3].front);
  EXPECT_EQ(answer.point[0].front_share, 1);  // the same in every sample of the seeds
  EXPECT_EQ(answer.point[0].value[0].n, 6);
  EXPECT_NEAR(answer.point[0].value[0].median, 13.5, 1e-12);
  EXPECT_LE(answer.point[0].value[0].low, 13.5);
  EXPECT_EQ(*answer.worst, 1u);
}

TEST(Study, APointWhoseRunsFailIsWorseAndAPointWithoutAnyScoreIsNeverTheBest) {
  StudyTable t = planted();
  for (StudyCell& c : t.cell)
    if (c.point == 0) c.failure = "drive stuck: at the first bend", c.value.clear();
  const StudyAnswer answer = answer_of(t);
  EXPECT_EQ(answer.point[0].failed, 6u);
  EXPECT_NE(*answer.best, 0u);
  EXPECT_TRUE(std::isnan(answer.point[0].value[0].median));
}

TEST(Study, WithoutRunsTheBestIsThatOfTheGeometry) {
  StudyTable t = planted();
  t.cell.clear(), t.metric.clear();
  t.objective = {"fast.value", "price"};
  for (size_t p = 0; p < 4; ++p) t.point[p].fast[0] = p == 1 ? 2 : 1;  // of one price with point 0
  t.point[3].fast.assign(fast_columns().size(), none), t.point[3].price = none;
  const StudyAnswer answer = answer_of(t);
  // Mean ranks: point 1 by its value 1, by price 2.5; point 2 the other way round, and the first of equals is told;
  // point 0 2.5 by both. Of point 3 nothing is known.
  ASSERT_TRUE(answer.best && answer.worst);
  EXPECT_EQ(*answer.best, 1u);
  EXPECT_EQ(*answer.worst, 0u);
}

TEST(Study, SpearmanIsOneForARisingCurveMinusOneForAFallingOneAndSharesTies) {
  EXPECT_NEAR(spearman({1, 2, 3, 4}, {1, 8, 27, 64}), 1, 1e-12);
  EXPECT_NEAR(spearman({1, 2, 3, 4}, {4, 3, 2, 1}), -1, 1e-12);
  // Ranks 1, 2.5, 2.5, 4 against 1, 2, 3, 4: 4.5 / sqrt(4.5 * 5).
  EXPECT_NEAR(spearman({1, 2, 2, 4}, {1, 2, 3, 4}), 4.5 / std::sqrt(4.5 * 5), 1e-12);
  EXPECT_TRUE(std::isnan(spearman({1, 1, 1}, {1, 2, 3})));
}

TEST(Study, AgreementOfFastAndFullIsToldWithItsInterval) {
  StudyTable t;
  t.factor = {"p"};
  t.metric = {{"error_m", "m", Better::lower}};
  t.objective = {"error_m"};
  for (size_t p = 0; p < 30; ++p) {
    t.point.push_back({{std::to_string(p)}, 0, 0, std::vector<double>(fast_columns().size(), static_cast<double>(p))});
    t.cell.push_back({"c" + std::to_string(p),
                      "",
                      p,
                      1,
                      {-static_cast<double>(p) + 3 * normal(5, Draw::test, p)},
                      1});  // higher value, less error
  }
  const StudyAnswer answer = answer_of(t);
  const StudyAnswer::Agreement& first = answer.agreement[0];
  EXPECT_EQ(first.fast, "fast.value");
  EXPECT_GT(first.rho, 0.8);
  EXPECT_LT(first.low, first.rho);
  EXPECT_GT(first.high, first.low);
  EXPECT_LE(first.high, 1);
}

TEST(Study, AFrontKeepsEqualPoints) {
  EXPECT_EQ(pareto_front({{1, 2}, {1, 2}, {2, 1}, {2, 2}}), (std::vector<bool>{true, true, true, false}));
}

TEST(Study, AnObjectiveThatNoColumnHasIsAnError) {
  StudyTable t = planted();
  t.objective = {"eror_m"};
  EXPECT_THROW(answer_of(t), Error);
}

TEST(Study, FilesTellTheSameInJsonCsvAndSqliteAndSecondsStandApart) {
  StudyTable t = planted();
  t.cell[3].failure = "mapper failed: \"no\", it said";
  t.cell[3].value.clear();
  t.cell[4].value[1] = none;
  const std::string dir = scratch("study"), again = scratch("study_again");
  const StudyAnswer answer = answer_of(t);
  write_study(dir, t, answer);
  for (StudyCell& c : t.cell) c.seconds = 9;
  write_study(again, t, answer);
  for (const char* file : {"/study.json", "/cells.csv", "/comparison.json"})
    EXPECT_EQ(read_text(dir + file), read_text(again + file)) << file;
  EXPECT_THAT(read_text(dir + "/cells.csv"), HasSubstr("c04,0,4,\"mapper failed: \"\"no\"\", it said\",0,0,100,1"));
  const auto j = nlohmann::json::parse(read_text(dir + "/study.json"));
  EXPECT_EQ(j["failures"].size(), 1u);
  Sqlite base(dir + "/study.sqlite", Sqlite::Open::read);
  SqliteStatement rows = base.prepare(
      "SELECT value FROM numbers JOIN metrics USING(metric) JOIN cells USING(cell) WHERE name = 'error_m' AND point = "
      "? "
      "ORDER BY seed");
  rows.bind(0, std::int64_t{1});
  for (int seed = 1; seed <= 6; ++seed) {
    ASSERT_TRUE(rows.step());
    EXPECT_EQ(*rows.number(0), 12 + seed);
  }
  EXPECT_FALSE(rows.step());
  SqliteStatement seconds = base.prepare("SELECT count(*), sum(seconds) FROM seconds");
  ASSERT_TRUE(seconds.step());
  EXPECT_EQ(seconds.integer(0), 24);
  EXPECT_EQ(*seconds.number(1), 36);
}

TEST(Study, ThePageIsOneFileThatNamesEachPointAndEscapesWhatItQuotes) {
  StudyTable t = planted();
  t.about = "a < b & c";
  const StudyAnswer answer = answer_of(t);
  const std::string dir = scratch("page");
  write_study_page(dir, {t, answer, {}, "x = 1\n", "[[laser]]\n"});
  const std::string html = read_text(dir + "/index.html");
  for (const char* words : {"a &lt; b &amp; c", "What each factor does", "interaction", "[[laser]]", "</html>"})
    EXPECT_THAT(html, HasSubstr(words));
  for (const char* outside : {"http://", "src=\"http"})
    EXPECT_EQ(html.find(outside), html.find(std::string(outside) + "www.w3.org")) << outside;
}

TEST(Sqlite, FaultsNameFileStatementAndReason) {
  const std::string file = scratch("x.sqlite");
  std::filesystem::remove(file);
  Sqlite base(file);
  base.exec("CREATE TABLE t(a INTEGER PRIMARY KEY, b TEXT)");
  const auto said = [&](const char* sql) -> std::string {
    try {
      base.exec(sql);
    } catch (const Error& e) {
      EXPECT_EQ(e.fault(), Fault::file);
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(said("INSERT INTO nowhere VALUES(1)"), ::testing::AllOf(HasSubstr(file), HasSubstr("no such table")));
  SqliteStatement insert = base.prepare("INSERT INTO t VALUES(?, ?)");
  insert.bind(0, std::int64_t{1}).bind(1, std::string("one")).step();
  EXPECT_THROW(insert.bind(0, std::int64_t{1}).step(), Error);  // the same key again
  EXPECT_THROW(Sqlite(scratch("none/x.sqlite"), Sqlite::Open::read), Error);
}

}  // namespace
}  // namespace adit
