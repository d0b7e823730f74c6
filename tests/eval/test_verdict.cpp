// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "eval/verdict.h"
#include "tests/eval/simulated_nights.h"
#include "tests/support/scratch.h"

#include <gtest/gtest.h>

namespace adit {
namespace {

std::string kind_of(const Verdict& v, const std::string& metric) {
  for (const MetricVerdict& m : v.metric)
    if (m.metric.name == metric) return m.kind;
  return "";
}

TEST(SignFlip, OneSidedIsTheShareOfPatternsThatSumToAtLeastAsMuch) {
  EXPECT_EQ(sign_flip_p({1, 1, 1, 1, 1, 1}, Tail::above), 1.0 / 64);
  EXPECT_EQ(sign_flip_p({-1, -1, -1}, Tail::above), 1);
  EXPECT_EQ(sign_flip_p({1, 1, -1}, Tail::above), 4.0 / 8);  // +++ and three with one minus
}

TEST(SignFlip, RanksShareTiesAndLeaveZerosOut) {
  EXPECT_EQ(signed_ranks({0.1, -3, 0.1, 0, 100}), (std::vector<double>{2.5, -4, 2.5, 0, 5}));
}

TEST(Verdict, EqualNightsPassAndTheFirstOneIsTheBaseline) {
  Simulation s;
  s.noise = 0;
  std::vector<Night> past;
  EXPECT_EQ(live_through(s.night(1), past, s.rules()).verdict, "first");
  const Verdict second = live_through(s.night(2), past, s.rules());
  EXPECT_EQ(second.verdict, "pass");
  EXPECT_EQ(second.exit_code, 0);
  EXPECT_TRUE(second.claims.empty());
}

// 200 histories of 20 nights in which nothing happens but noise, without any least difference that matters.
TEST(Verdict, RaisesFalseAlarmsInAtMostFivePercentOfNights) {
  int alarms = 0, joys = 0;
  for (int t = 0; t < 200; ++t) {
    Simulation s;
    s.chance = 100 + static_cast<std::uint64_t>(t);
    std::vector<Night> past;
    for (int k = 1; k <= 20; ++k) {
      past.push_back(s.night(k));
      past.back().verdict = "pass";
    }
    const Verdict v = judge(s.night(21), past, s.rules());
    alarms += v.exit_code == 1;
    joys += v.verdict == "improved";
  }
  EXPECT_LE(alarms, 10);  // 5 % of 200
  // Of an exact test at half of alpha 5 of 200 are expected, so that 5 is no limit: 11 is exceeded once in 200 times. Over
  // 2000 histories they are 2.35 % (campaign_nightly --simulated).
  EXPECT_LE(joys, 11);
  EXPECT_GT(alarms + joys, 0) << "a test that never says yes says nothing";
}

TEST(Verdict, CatchesAShiftOfThreeTimesTheUsualNoiseWithPowerAboveNineTenths) {
  int caught = 0;
  for (int t = 0; t < 50; ++t) {
    Simulation s;
    s.seeds = 16, s.metrics = 4;
    s.chance = 1000 + static_cast<std::uint64_t>(t);
    s.factor = [](int metric, int night) { return metric == 3 && night == 9 ? 1.03 : 1.0; };
    std::vector<Night> past;
    for (int k = 1; k <= 8; ++k) {
      past.push_back(s.night(k));
      past.back().verdict = "pass";
    }
    const Verdict v = judge(s.night(9), past, s.rules());
    caught += kind_of(v, "m3") == "regressed" && v.exit_code == 1;
  }
  EXPECT_GE(caught, 45);
}

TEST(Verdict, ElevenSeedsAreEnoughForFortyMetricsAndTenAreNot) {
  for (const int seeds : {10, 11}) {
    Simulation s;
    s.seeds = seeds, s.metrics = 40, s.noise = 0.001;
    s.factor = [](int, int night) { return night == 2 ? 1.05 : 1.0; };  // every metric, in every seed
    std::vector<Night> past;
    live_through(s.night(1), past, s.rules());
    const Verdict v = judge(s.night(2), past, s.rules());
    EXPECT_EQ(kind_of(v, "m0"), seeds == 11 ? "regressed" : "few");
  }
}

TEST(Verdict, ARegressionStaysUntilItIsMendedOrAccepted) {
  Simulation s;
  s.noise = 0.001;
  s.factor = [](int, int night) { return night >= 5 ? 1.05 : 1.0; };
  std::vector<Night> past;
  for (int k = 1; k <= 20; ++k) EXPECT_EQ(live_through(s.night(k), past, s.rules(1)).exit_code, k >= 5 ? 1 : 0) << k;
  past.back().accepted = "known";
  EXPECT_EQ(live_through(s.night(21), past, s.rules(1)).exit_code, 0);
}

TEST(Verdict, CreepThatNoNightShowsIsCaughtAndTellsWhereItGrewMost) {
  Simulation s;
  s.noise = 0.002;
  s.factor = [](int metric, int night) { return metric == 2 ? 1 + 0.003 * std::max(0, night - 20) : 1.0; };
  std::vector<Night> past;
  int crept = 0;
  for (int k = 1; k <= 60 && !crept; ++k) {
    const Verdict v = live_through(s.night(k), past, s.rules(4));
    EXPECT_NE(kind_of(v, "m2"), "regressed") << k;
    if (kind_of(v, "m2") == "crept") crept = k;
    for (const MetricVerdict& m : v.metric) EXPECT_TRUE(m.metric.name == "m2" || m.kind == "pass" || m.kind == "new");
  }
  // 4 % are reached 13 nights after night 20.
  EXPECT_GE(crept, 32);
  EXPECT_LE(crept, 36);
  EXPECT_NE(past.back().claims[0].words.find("greatest step at night"), std::string::npos);
}

TEST(Verdict, NothingIsComparedAcrossAnotherEvaluatorOrTruth) {
  Simulation s;
  s.factor = [](int, int night) { return night >= 3 ? 1.5 : 1.0; };
  std::vector<Night> past;
  live_through(s.night(1), past, s.rules());
  live_through(s.night(2), past, s.rules());
  Night other = s.night(3);
  other.evaluator = "evaluator 2";
  const Verdict v = live_through(other, past, s.rules());
  EXPECT_EQ(v.exit_code, 3);
  EXPECT_EQ(v.verdict, "not comparable");
  EXPECT_EQ(kind_of(v, "m0"), "not comparable");
  Night next = s.night(4);
  next.evaluator = "evaluator 2";
  EXPECT_EQ(live_through(next, past, s.rules(5)).exit_code, 0);  // the baseline is what came since
  Night moved = s.night(5);
  moved.evaluator = "evaluator 2", moved.cells[4].truth = "another mine";
  const Verdict third = judge(moved, past, s.rules());
  EXPECT_EQ(third.exit_code, 3);
  EXPECT_NE(third.claims[0].words.find("truth of seed 5"), std::string::npos);
}

TEST(Verdict, ImprovementsAreToldAndBecomeTheBaseline) {
  Simulation s;
  s.noise = 0.001;
  s.factor = [](int metric, int night) { return metric == 1 && night >= 4 ? night >= 6 ? 0.97 : 0.9 : 1.0; };
  std::vector<Night> past;
  for (int k = 1; k <= 3; ++k) live_through(s.night(k), past, s.rules(1));
  const Verdict better = live_through(s.night(4), past, s.rules(1));
  EXPECT_EQ(better.verdict, "improved");
  EXPECT_EQ(better.exit_code, 0);
  EXPECT_EQ(live_through(s.night(5), past, s.rules(1)).verdict, "pass");
  // Better than ever before night 4, and still a loss.
  EXPECT_EQ(kind_of(live_through(s.night(6), past, s.rules(1)), "m1"), "regressed");
}

TEST(Verdict, NumbersGoodNearZeroAreJudgedByTheirSizeAndSteadyOnesEitherWay) {
  Simulation s;
  s.noise = 0.001, s.metrics = 2;
  SuiteRules rules = s.rules(1);
  rules.metric[0].better = Direction::zero, rules.metric[1].better = Direction::steady;
  std::vector<Night> past;
  for (int k = 1; k <= 2; ++k) live_through(s.night(k), past, rules);
  s.factor = [](int metric, int) { return metric == 0 ? -1.05 : 0.95; };
  const Verdict v = judge(s.night(3), past, rules);
  EXPECT_EQ(kind_of(v, "m0"), "regressed");
  EXPECT_EQ(kind_of(v, "m1"), "regressed");
  s.factor = [](int metric, int) { return metric == 0 ? -0.9 : 1; };
  EXPECT_EQ(kind_of(judge(s.night(3), past, rules), "m0"), "improved");
}

TEST(Verdict, RunsThatFailOrLoseAMetricAndTolerancesNeedNoStatistics) {
  Simulation s;
  s.noise = 0.001, s.metrics = 2, s.seeds = 3;
  SuiteRules rules = s.rules();
  std::vector<Night> past;
  EXPECT_EQ(live_through(s.night(1), past, rules).exit_code, 0);
  Night broken = s.night(2);
  broken.cells[1].value.clear(), broken.cells[1].failure = "drive stuck: at a corner";
  const Verdict v = judge(broken, past, rules);
  EXPECT_EQ(v.exit_code, 1);
  EXPECT_NE(v.claims[0].words.find("drive stuck"), std::string::npos);
  rules.failures = 1;
  EXPECT_EQ(judge(broken, past, rules).exit_code, 0);
  rules.failures = 0;
  Night lost = s.night(2);
  lost.cells[0].value.erase("m1");
  EXPECT_EQ(kind_of(judge(lost, past, rules), "m1"), "failing");
  rules.metric[0].at_most = 0.2;
  EXPECT_EQ(kind_of(judge(s.night(2), past, rules), "m0"), "beyond");
}

TEST(Verdict, ANamedBaselineIsThatNightOrAnError) {
  Simulation s;
  s.noise = 0.001;
  s.factor = [](int, int night) { return night == 2 ? 1.1 : 1.0; };
  std::vector<Night> past;
  for (int k = 1; k <= 3; ++k) live_through(s.night(k), past, s.rules(1));
  SuiteRules rules = s.rules(1);
  for (const auto& [name, expected] :
       {std::pair<std::string, std::string>{"commit:c1", "pass"}, {"night:2", "improved"}, {"branch:main", "pass"}}) {
    rules.baseline = name;
    EXPECT_EQ(judge(s.night(4), past, rules).verdict, expected) << name;
  }
  for (const std::string bad : {"commit:zzz", "night:99", "branch:other", "yesterday", "commit:"}) {
    rules.baseline = bad;
    EXPECT_THROW(judge(s.night(4), past, rules), Error) << bad;
  }
}

TEST(Verdict, TimesAndMemoryAreComparedOnOneMachineAlone) {
  Simulation s;
  std::vector<Night> past;
  Night first = s.night(1);
  for (NightCell& c : first.cells) c.peak_gib = 0.5;
  live_through(first, past, s.rules());
  Night slow = s.night(1);
  for (NightCell& c : slow.cells) c.seconds = 30, c.peak_gib = 1;
  const Verdict v = judge(slow, past, s.rules());
  EXPECT_NEAR(v.speed[0].ratio.median, 1.5, 1e-12);
  EXPECT_NEAR(v.speed[0].memory_ratio.median, 2, 1e-12);
  EXPECT_EQ(v.speed[0].baseline_gib, 0.5);
  EXPECT_EQ(v.exit_code, 0);
  ASSERT_EQ(v.notes.size(), 2u);
  EXPECT_NE(v.notes[1].find("100 % more memory"), std::string::npos) << v.notes[1];
  slow.machine = "another";
  const Verdict elsewhere = judge(slow, past, s.rules());
  EXPECT_EQ(elsewhere.speed[0].ratio.n, 0);
  EXPECT_EQ(elsewhere.speed[0].memory_ratio.n, 0);
}

TEST(Verdict, FilesTellTheSameAndEscapeWhatTheyMust) {
  Simulation s;
  s.noise = 0.001, s.metrics = 2;
  std::vector<Night> past;
  live_through(s.night(1), past, s.rules(1));
  s.factor = [](int metric, int) { return metric == 0 ? 1.1 : 1; };
  Night n = s.night(2);
  n.suite = "a<b>&\"c\"", n.cells[0].failure = "broke | at <here>\n\x01", n.cells[0].value.clear();
  const Verdict v = judge(n, past, s.rules(1));
  write_junit(scratch("junit.xml"), n, v);
  write_verdict_json(scratch("verdict.json"), n, v);
  write_verdict_md(scratch("verdict.md"), n, v);
  const std::string junit = read_text(scratch("junit.xml")), md = read_text(scratch("verdict.md"));
  EXPECT_NE(junit.find("tests=\"3\" failures=\"2\" skipped=\"0\""), std::string::npos) << junit;
  EXPECT_NE(junit.find("a&lt;b&gt;&amp;&quot;c&quot;"), std::string::npos);
  EXPECT_EQ(junit.find('\x01'), std::string::npos);
  EXPECT_NE(md.find("broke \\| at <here> "), std::string::npos) << md;
  EXPECT_NE(read_text(scratch("verdict.json")).find("\"kind\": \"regressed\""), std::string::npos);
}

TEST(Verdict, TheGreatestStepIsWhereTheMeansPart) {
  EXPECT_EQ(greatest_step({1, 1, 1, 2, 2}), 3u);
  EXPECT_FALSE(greatest_step({1, 1, 1}));
  EXPECT_FALSE(greatest_step({1}));
}

}  // namespace
}  // namespace adit
