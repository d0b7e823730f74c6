// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "tests/support/scratch.h"
#include "worlds/plan.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

WorldSettings bruceton() {
  WorldSettings s;
  s.x_max = -45;
  s.y_max = 182;
  return s;
}

double length_of(const MinePlan& plan) {
  double length = 0;
  for (const PlanPassage& p : plan.passages)
    for (size_t i = 1; i < p.line.size(); ++i) length += (p.line[i] - p.line[i - 1]).norm();
  return length;
}

int loops_of(const MinePlan& plan) {
  return static_cast<int>(plan.passages.size()) - static_cast<int>(plan.nodes.size()) + 1;
}

std::string error_of(const WorldSettings& s) {
  try {
    make_plan(s, 1);
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

WorldSettings with_plan(const std::string& name, const std::string& text) {
  WorldSettings s;
  s.plan = scratch("plan_") + name + ".json";
  write_text(s.plan, text);
  return s;
}

std::string square(const std::string& width = "3.5", const std::string& more = "") {
  return R"({"nodes": [{"id": 1, "x_m": 0, "y_m": 0}, {"id": 2, "x_m": 30, "y_m": 0}, {"id": 3, "x_m": 30, "y_m": 30},
            {"id": 4, "x_m": 0, "y_m": 30}, {"id": 5, "x_m": 100, "y_m": 0}, {"id": 6, "x_m": 130, "y_m": 0}],
            "edges": [{"a": 1, "b": 2, "width_m": )" +
         width + R"(}, {"a": 2, "b": 3, "width_m": 3.5}, {"a": 3, "b": 4, "width_m": 3.5},
            {"a": 4, "b": 1, "width_m": 3.5})" +
         more + "]}";
}

TEST(Plan, BrucetonHasTheSizeThatThePublishedPlanHas) {
  const MinePlan plan = make_plan(bruceton(), 1);
  EXPECT_NEAR(length_of(plan), 1957, 0.02 * 1957);  // the plan's own edge list; lines are good to 2 m
  EXPECT_EQ(plan.nodes.size(), 72u);                // 71 and the crossing of two passages at (-270, 74)
  EXPECT_EQ(loops_of(plan), 22);
}

TEST(Plan, BothBrucetonMinesAreOneWithTheWallsOpenAndTwoWithout) {
  WorldSettings s;
  s.passages = "all";
  EXPECT_GT(length_of(make_plan(s, 1)), 3700);
  s.passages = "open";
  EXPECT_NE(error_of(s).find("not connected"), std::string::npos) << error_of(s);
}

TEST(Plan, ACrossingBecomesANode) {
  MinePlan plan{{{0, 0}, {20, 0}, {10, -10}, {10, 10}},
                {0, 0, 0, 0},
                {{0, 1, 3, {{0, 0}, {20, 0}}}, {2, 3, 3, {{10, -10}, {10, 10}}}}};
  plan = split_crossings(plan);
  ASSERT_EQ(plan.nodes.size(), 5u);
  EXPECT_NEAR((plan.nodes[4] - Vec2(10, 0)).norm(), 0, 1e-12);
  EXPECT_EQ(plan.passages.size(), 4u);
  EXPECT_NEAR(length_of(plan), 40, 1e-12);
}

TEST(Plan, PassagesThatOnlyShareANodeAreNotSplit) {
  const MinePlan plan = make_plan(with_plan("square", square()), 1);
  EXPECT_EQ(plan.passages.size(), 4u);
  EXPECT_EQ(loops_of(plan), 1);
}

TEST(Plan, APassageThatLeavesTheSelectionIsCutAtItsBorder) {
  WorldSettings s = with_plan("cut", square());
  s.x_max = 20;
  const MinePlan plan = make_plan(s, 1);
  int cut = 0;
  for (size_t i = 0; i < plan.nodes.size(); ++i) {
    if (!plan.cut[i]) continue;
    EXPECT_NEAR(plan.nodes[i].x(), 20, 1e-9);
    ++cut;
  }
  EXPECT_EQ(cut, 2);
  EXPECT_NEAR(length_of(plan), 70, 1e-9);
}

TEST(Plan, BadPlansAreAnsweredByPlaceAndCause) {
  const auto says = [](const std::string& what, const std::string& part) {
    EXPECT_NE(what.find(part), std::string::npos) << what;
  };
  WorldSettings unknown;
  unknown.plan = "brucetown";
  says(error_of(unknown), "bruceton");
  unknown.plan = "/nowhere/plan.json";
  says(error_of(unknown), "/nowhere/plan.json");
  says(error_of(with_plan("zero", square("0"))), "width_m = 0");
  says(error_of(with_plan("negative", square("-3"))), "from node 1 to 2");
  says(error_of(with_plan("parts", square("3.5", R"(, {"a": 5, "b": 6, "width_m": 3})"))), "not connected");
  says(error_of(with_plan("node", square("3.5", R"(, {"a": 4, "b": 9, "width_m": 3})"))), "to 9 names a node");
  says(error_of(with_plan("text", square("\"wide\""))), "not a plan");
  says(error_of(with_plan("broken", square().substr(0, 100))), "not a plan");
  WorldSettings empty = bruceton();
  empty.x_min = -40;
  says(error_of(empty), "world.x_min");
  WorldSettings nothing = bruceton();
  nothing.x_max = -1000;
  says(error_of(nothing), "no passage");
}

TEST(Panel, LoopsArePillarsBetweenEntriesAndCrosscuts) {
  for (int entries : {1, 2, 3, 5}) {
    for (int crosscuts : {1, 2, 4}) {
      for (double stagger : {0.0, 0.5}) {
        PanelSettings s;
        s.entries = entries;
        s.crosscuts = crosscuts;
        s.stagger = stagger;
        for (std::uint64_t seed = 0; seed < 5; ++seed)
          EXPECT_EQ(loops_of(split_crossings(panel_plan(s, seed))), (entries - 1) * (crosscuts - 1))
              << entries << " entries, " << crosscuts << " crosscuts, stagger " << stagger << ", seed " << seed;
      }
    }
  }
}

TEST(Panel, ObliqueCrosscutsLeanByTheirAngle) {
  PanelSettings s;
  s.crosscut_angle_deg = 60;
  s.spacing_sd_m = 0;
  s.stub_share = 0;
  for (const PlanPassage& p : panel_plan(s, 1).passages) {
    const Vec2 d = p.line.back() - p.line.front();
    if (std::abs(d.y()) > 1) {
      EXPECT_NEAR(std::atan2(d.y(), d.x()), std::atan(1.0) * 4 / 3, 1e-12);
    }
  }
}

TEST(Panel, EntriesWiderThanTheirSpacingAllowsAreRefusedWithTheRange) {
  WorldSettings s;
  s.kind = "panel";
  s.panel.width_m = 19;
  EXPECT_NE(error_of(s).find("world.panel.width_m = 19.00 m"), std::string::npos) << error_of(s);
  EXPECT_NE(error_of(s).find("at most 13.40 m"), std::string::npos)
      << error_of(s);  // 20 - 2.6 for pillars - 4 sd of 1 m
  s.panel.width_m = -1;
  EXPECT_NE(error_of(s).find("must be above 0"), std::string::npos) << error_of(s);
}

// Two entries whose centre lines are 4 m apart and that are 5 m wide leave no rock between.
TEST(Plan, PassagesThatRunIntoOneAnotherAreRefusedWithThePlace) {
  WorldSettings s = with_plan("overlap", R"({"nodes": [{"id": 1, "x_m": 0, "y_m": 0}, {"id": 2, "x_m": 60, "y_m": 0},
      {"id": 3, "x_m": 60, "y_m": 4}, {"id": 4, "x_m": 0, "y_m": 4}],
      "edges": [{"a": 1, "b": 2, "width_m": 5}, {"a": 2, "b": 3, "width_m": 5}, {"a": 3, "b": 4, "width_m": 5},
                {"a": 4, "b": 1, "width_m": 5}]})");
  s.mesh_edge_m = 0.5;
  try {
    make_world(s, 1);
    FAIL() << "no error";
  } catch (const Error& e) {
    const std::string what = e.what();
    EXPECT_NE(what.find("the centre lines have 1 loops, but 0 pillars would be left"), std::string::npos) << what;
    EXPECT_NE(what.find("world.width_scale = 1.00"), std::string::npos) << what;
    EXPECT_NE(what.find(" near ("), std::string::npos) << what;
  }
}

}  // namespace
}  // namespace adit
