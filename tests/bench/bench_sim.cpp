// SPDX-License-Identifier: BSD-3-Clause
#include "cli/scenario.h"
#include "sim/sim.h"
#include "tests/bench/bench.h"
#include "worlds/worlds.h"

namespace {

using namespace adit;
using namespace adit::bench;

// Simulated seconds for each second of one core, start of the physics included, no lasers.
Figure real_time_factor(const std::string& name, const std::string& vehicle, const RouteSettings& route_settings,
                        const std::string& what) {
  const Scenario scenario = load_scenario("bruceton");
  const World world = make_world(scenario.world, 1);
  const Route route = plan_route(world, route_settings, 1);
  const Vehicle loaded = load_vehicle(vehicle);
  double simulated_s = 0;
  const double wall_s =
      best_seconds(1, [&] { simulated_s = drive(world, route, loaded, scenario.drive, 1).path.stamp_s.back(); });
  return {name, simulated_s / wall_s, "ratio", "higher", what, 1};
}

std::vector<Figure> cart() {
  return {real_time_factor("cart_rtf", "cart", {}, "simulated per wall second, the cart on bruceton's whole route")};
}

// At 0.15 m/s the whole route takes hours; a walk about three of the mine's loops tells as much.
std::vector<Figure> skid() {
  RouteSettings route;
  route.mode = "around";
  route.pillars = {0, 1, 2};
  return {real_time_factor("skid_rtf", "groundhog", route,
                           "simulated per wall second, groundhog about three pillars of bruceton")};
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, {{{"cart_rtf"}, cart}, {{"skid_rtf"}, skid}});
}
