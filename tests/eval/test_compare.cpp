// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "eval/compare.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

ScoredRun run_of(const std::string& settings, int seed, double ate_m, const std::string& truth = "t") {
  ScoredRun run{"run", settings, seed, Score{}};
  run.score->metrics.push_back({"trajectory.se3.ate_rmse_m", ate_m, "m", Better::lower, 10, ""});
  run.score->meta.emplace_back("truth_hash", truth + std::to_string(seed));
  return run;
}

const std::string plain = "[map]\nmethod = \"robust\"\n", other = "[map]\nmethod = \"icra2003\"\n";

TEST(SignFlip, IsExactForSmallSamples) {
  EXPECT_EQ(sign_flip_p({}), 1);
  EXPECT_EQ(sign_flip_p({1}), 1);                                // + and - are equally far
  EXPECT_EQ(sign_flip_p({1, 1, 1, 1, 1, 1}), 2.0 / 64);          // all plus, all minus
  EXPECT_EQ(sign_flip_p({1, 1, 1, 1, 1, -1}), (2.0 + 12) / 64);  // and those with one of the other sign
  EXPECT_EQ(sign_flip_p({3, -3}), 1);
}

TEST(SignFlip, RejectsATrueHypothesisAsOftenAsItSays) {
  int rejected = 0;
  constexpr int trials = 400;
  for (int t = 0; t < trials; ++t) {
    std::vector<double> d;
    for (int i = 0; i < 10; ++i)
      d.push_back(normal(7, Draw::test, static_cast<std::uint64_t>(t), static_cast<std::uint64_t>(i)));
    rejected += sign_flip_p(d) <= 0.05;
  }
  // 5 % of 400 = 20, sd sqrt(19) = 4.4: five standard errors.
  EXPECT_NEAR(rejected, 20, 22);
  EXPECT_GT(rejected, 0);
}

TEST(SignFlip, DrawnPatternsComeNearTheExactAnswer) {
  std::vector<double> d;
  for (int i = 0; i < 16; ++i) d.push_back(0.4 + normal(3, Draw::test, 0, static_cast<std::uint64_t>(i)));
  const double exact = sign_flip_p(d);
  d.push_back(0);  // a 17th that changes no sum: patterns are drawn now
  EXPECT_NEAR(sign_flip_p(d), exact, 5 * std::sqrt(exact * (1 - exact) / 65536) + 1e-4);
}

TEST(Spread, ItsIntervalHoldsTheMedianAndNeedsFiveRuns) {
  const Spread few = spread_of({1, 2, 3, 4});
  EXPECT_EQ(few.median, 2.5);
  EXPECT_TRUE(std::isnan(few.low));
  const Spread s = spread_of({5, 1, 4, 2, 3, 9, 7, 8, 6});
  EXPECT_EQ(s.median, 5);
  EXPECT_LT(s.low, 5);
  EXPECT_GT(s.high, 5);
  EXPECT_GE(s.low, 1);
  EXPECT_LE(s.high, 9);
}

TEST(Compare, PairsBySeedAndNamesTheWorstAndTheDifference) {
  std::vector<ScoredRun> runs;
  for (int seed = 1; seed <= 6; ++seed) {
    runs.push_back(run_of(plain, seed, 0.1 * seed));
    runs.push_back(run_of(other, seed, 0.1 * seed + 0.05));
  }
  const Comparison c = compare_runs(runs);
  ASSERT_EQ(c.group.size(), 2u);
  EXPECT_EQ(c.group[1].label, "map.method = \"icra2003\"");
  ASSERT_EQ(c.metric.size(), 1u);
  const ComparedMetric::Group& b = c.metric[0].group[1];
  EXPECT_NEAR(b.difference.median, 0.05, 1e-12);
  EXPECT_EQ(b.difference.n, 6);
  EXPECT_EQ(b.p, 2.0 / 64);
  EXPECT_EQ(b.worst_seed, 6);
  EXPECT_NEAR(c.metric[0].group[0].value.median, 0.35, 1e-12);
  const std::string table = comparison_table(c, {"trajectory.se3.ate_rmse_m"});
  EXPECT_NE(table.find("minus A: 0.05"), std::string::npos) << table;
}

TEST(Holm, RaisesEachPByHowManyAreLeft) {
  // Sorted 0.01, 0.02, 0.04: times 3, 2 and 1, never falling.
  EXPECT_EQ(holm({0.04, 0.01, 0.02}), (std::vector<double>{0.04, 0.03, 0.04}));
  EXPECT_EQ(holm({0.5, 0.6}), (std::vector<double>{1, 1}));
  EXPECT_TRUE(holm({}).empty());
}

TEST(Compare, SaysBetterWorseSameOrThatItCannotTell) {
  const auto verdict = [](double shift, int seeds, double noise) {
    std::vector<ScoredRun> runs;
    for (int seed = 1; seed <= seeds; ++seed) {
      const double z = normal(9, Draw::test, static_cast<std::uint64_t>(seed));
      runs.push_back(run_of(plain, seed, 0.1 + 0.01 * seed));
      runs.push_back(run_of(other, seed, 0.1 + 0.01 * seed + shift + noise * z));
    }
    const auto c = compare_runs(runs, {"trajectory.se3.ate_rmse_m"});
    return c.metric[0].group[1];
  };
  EXPECT_EQ(verdict(0.05, 8, 0.001).verdict, "worse");
  EXPECT_EQ(verdict(-0.05, 8, 0.001).verdict, "better");
  EXPECT_EQ(verdict(0.001, 8, 0.0001).verdict, "same");   // surely there, and 1 mm of 150: nobody would act on it
  EXPECT_EQ(verdict(0.05, 4, 0.001).verdict, "unclear");  // four pairs give no p below 0.125
  EXPECT_EQ(verdict(0, 8, 0).verdict, "same");
  EXPECT_EQ(verdict(0.05, 8, 0.001).p_holm, verdict(0.05, 8, 0.001).p);  // alone in its suite
  EXPECT_NEAR(verdict(0.05, 8, 0).difference.median, 0.05, 1e-12);
  EXPECT_GT(verdict(0.05, 8, 0.001).effect, 10);
}

TEST(Compare, ANumberThatIsGoodNearZeroIsJudgedByItsSize) {
  std::vector<ScoredRun> runs;
  for (int seed = 1; seed <= 8; ++seed)
    for (const bool first : {true, false}) {
      ScoredRun run = run_of(first ? plain : other, seed, 0.1);
      // From -3 to +1 percent: higher, and better.
      run.score->metrics.push_back(
          {"volume.error_percent", (first ? -3 : 1) + 0.01 * seed, "percent", Better::lower, 1, ""});
      runs.push_back(run);
    }
  const Comparison c = compare_runs(runs, {"volume.error_percent"});
  ASSERT_EQ(c.metric[1].name, "volume.error_percent");
  EXPECT_EQ(c.metric[1].group[1].verdict, "better");
  EXPECT_NEAR(c.metric[1].group[1].difference.median, 4, 1e-9);
}

TEST(Compare, TheShareOfRunsWhoseClaimHoldsIsTheMean) {
  std::vector<ScoredRun> runs;
  for (int seed = 1; seed <= 4; ++seed) {
    runs.push_back(run_of(plain, seed, 0.1));
    runs.back().score->metrics.push_back(
        {"volume.claim_holds_95", seed == 2 ? 0.0 : 1.0, "share", Better::higher, 1, ""});
  }
  EXPECT_EQ(compare_runs(runs).metric[1].group[0].mean, 0.75);
}

TEST(Compare, AFailedRunIsAResult) {
  std::vector<ScoredRun> runs{run_of(plain, 1, 0.1), run_of(plain, 2, 0.2)};
  runs[1].score.reset();
  const Comparison c = compare_runs(runs);
  EXPECT_EQ(c.group[0].failed, std::vector<int>{2});
  EXPECT_EQ(c.metric[0].group[0].value.n, 1);
}

TEST(Compare, TheSameRunTwiceOrAnotherTruthIsRefused) {
  EXPECT_THROW(compare_runs({run_of(plain, 1, 0.1), run_of(plain, 1, 0.1)}), Error);
  try {
    compare_runs({run_of(plain, 1, 0.1), run_of(other, 1, 0.1, "another")});
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_EQ(e.fault(), Fault::not_comparable);
  }
  const std::string wide = plain + "[world]\nwidth_m = 5\n";  // another mine is what was asked for
  EXPECT_EQ(compare_runs({run_of(plain, 1, 0.1), run_of(wide, 1, 0.1, "another")}).group.size(), 2u);
}

}  // namespace
}  // namespace adit
