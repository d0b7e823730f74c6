// SPDX-License-Identifier: BSD-3-Clause
#include "base/bundled.h"
#include "cli/scenario.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

namespace adit {
namespace {

// In a coarse mesh; the two that are as large as a real mine are made elsewhere.
TEST(Scenarios, EachBundledOneIsASoundMineWithARoute) {
  const auto names = bundled_names("cli/scenarios");
  EXPECT_GE(names.size(), 15u);
  for (const std::string& name : names) {
    if (name.starts_with("bruceton")) continue;
    const Scenario s = load_scenario(name, {"world.mesh_edge_m=0.5"});
    const std::uint64_t seed = 1;
    const World world = make_world(s.world, seed);
    const WorldCheck check = check_world(world);
    EXPECT_TRUE(check.ok()) << name << ": " << check.what();
    EXPECT_TRUE(check_truth(world).empty()) << name << ": " << check_truth(world).front();
    EXPECT_GT(plan_route(world, s.route, seed).length_m, 200) << name;
    EXPECT_FALSE(s.about.empty()) << name;
  }
}

}  // namespace
}  // namespace adit
