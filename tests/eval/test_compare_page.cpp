// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare_page.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

const std::string metric = "trajectory.se3.ate_rmse_m";

ScoredRun run_of(const std::string& settings, int seed, std::optional<double> ate_m) {
  ScoredRun run{"out/<" + std::to_string(seed) + ">", settings, seed, {}};
  if (!ate_m) return run;
  run.score = Score{};
  run.score->metrics.push_back({metric, *ate_m, "m", Better::lower, 10, ""});
  run.score->metrics.push_back({"map.se3.p95_m", 0.3, "m", Better::lower, 10, ""});
  run.score->meta.emplace_back("truth_hash", "t" + std::to_string(seed));
  return run;
}

SideBySide two_methods() {
  SideBySide all;
  for (int seed = 1; seed <= 6; ++seed) {
    all.runs.push_back(run_of("method = \"<a>\"\n", seed, seed == 1 ? std::nullopt : std::optional(0.1 * seed)));
    all.runs.push_back(run_of("method = \"<b>\"\n", seed, 0.1 * seed + 0.5));
  }
  all.runs.push_back(run_of("method = \"<b>\"\n", 9, 0.4));
  all.headline = {metric};
  all.comparison = compare_runs(all.runs, all.headline);
  all.plans.resize(2);
  for (Plate& plate : all.plans) plate.figure.missing = "no <map>";
  return all;
}

size_t count(const std::string& text, const std::string& part) {
  size_t n = 0;
  for (size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

TEST(ComparePage, TellsGroupsDifferencesAndWhoIsWorse) {
  const SideBySide all = two_methods();
  const std::string html = comparison_html(all, std::vector<std::string>(all.runs.size(), "../x/index.html"));
  EXPECT_NE(html.find("13 runs side by side"), std::string::npos);
  EXPECT_NE(html.find("B is better than A in 0 of 1 headline numbers"), std::string::npos);
  EXPECT_EQ(count(html, "href=\"../x/index.html\""), all.runs.size());
  EXPECT_NE(html.find("data-v=\"0.500000\""), std::string::npos);  // each pair differs by that
  EXPECT_EQ(count(html, "<circle"), 12u);                          // a dot for each value of the one headline number
}

TEST(ComparePage, NamesAreEscapedAndNothingComesFromElsewhere) {
  const SideBySide all = two_methods();
  std::string html = comparison_html(all, std::vector<std::string>(all.runs.size()));
  html.erase(html.rfind("<script>"));
  for (const std::string bad : {"<a>", "<b>", "<1>", "<map>", "http:", "https:", "src="})
    EXPECT_EQ(count(html, bad), 0u) << bad;
}

TEST(ComparePage, ShowsTheSmallestSeedThatAllGroupsHave) {
  const SideBySide all = two_methods();
  const std::vector<size_t> shown = shown_runs(all.runs, all.comparison);
  ASSERT_EQ(shown.size(), 2u);
  EXPECT_EQ(all.runs[shown[0]].seed, 2);  // seed 1 failed in the first group
  EXPECT_EQ(all.runs[shown[1]].seed, 2);
  EXPECT_EQ(all.runs[shown[0]].settings, "method = \"<a>\"\n");
}

TEST(ComparePage, PathsAreLaidOverEachOtherWithTheirLetters) {
  SideBySide all = two_methods();
  EXPECT_NE(comparison_html(all, std::vector<std::string>(all.runs.size())).find("no run's path"), std::string::npos);
  Score score;
  for (int k = 0; k < 50; ++k)
    score.poses.push_back(
        {0.1 * k, 1.0 * k, Pose::Identity(), Vec3(0.03 * k, 0.04 * k, -0.1), {0, 0, 0}, Pose::Identity()});
  const PathErrors errors = path_errors(score, 2);
  ASSERT_EQ(errors.along_m.size(), 50u);
  EXPECT_NEAR(errors.plan_m.back(), 0.05 * 49, 1e-12);
  EXPECT_DOUBLE_EQ(errors.height_m.back(), -0.1);
  all.paths = {errors, {}};  // the second group has none
  const std::string html = comparison_html(all, std::vector<std::string>(all.runs.size()));
  EXPECT_NE(html.find("over each other: A (seed 2)."), std::string::npos);
  EXPECT_EQ(count(html, "Chart of the paths&#39; errors"), 4u);  // two charts, label and title each
}

TEST(ComparePage, OneRangeHoldsTheErrorsOfAll) {
  std::vector<ScoredRun> runs = two_methods().runs;
  EXPECT_DOUBLE_EQ(common_range_m(runs), 0.5);  // 0.3 m and a third of that, rounded up
  EXPECT_DOUBLE_EQ(common_range_m({}), 0.05);
}

TEST(ComparePage, AGroupWithoutAScoreHasNoRunToShow) {
  const std::vector<ScoredRun> runs = {run_of("a", 1, {}), run_of("b", 1, 0.2)};
  const std::vector<size_t> shown = shown_runs(runs, compare_runs(runs));
  EXPECT_EQ(shown, (std::vector<size_t>{2, 1}));
}

}  // namespace
}  // namespace adit
