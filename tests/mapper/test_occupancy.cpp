// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"
#include "mapper/occupancy.h"
#include "tests/support/plan_log.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace adit {
namespace {

Mount plain_mount() {
  Mount m = plan_mount(181, 0.2, 0.01);
  m.X_BS = Pose::Identity();
  return m;
}

// A laser at the origin that looks along x at a wall.
Grid grid_of_a_wall(double wall_m, double other_m = 0) {
  const Mount mount = plain_mount();
  Scans scans;
  scans.beams = mount.laser.beams;
  scans.stamp_s = {0};
  for (int k = 0; k < scans.beams; ++k) {
    const double c = std::cos(mount.laser.beam_angle_rad(k));
    scans.range_m.push_back(c > 0.5 ? static_cast<float>(wall_m / c) : static_cast<float>(other_m));
  }
  return map_grid(scans, mount, {Pose2{}}, {});
}

Grid::Cell at(const Grid& grid, double x, double y) {
  return grid.cell(static_cast<int>(std::floor((x - grid.origin.x()) / grid.cell_m)),
                   static_cast<int>(std::floor((y - grid.origin.y()) / grid.cell_m)));
}

TEST(Occupancy, AWallIsOccupiedWhatLiesBeforeItFreeAndBehindItUnknown) {
  const Grid grid = grid_of_a_wall(3.05);
  for (double y = -2; y <= 2; y += 0.1) {
    EXPECT_EQ(at(grid, 3.05, y), Grid::occupied) << y;
    EXPECT_EQ(at(grid, 2.85, y), Grid::free) << y;
    EXPECT_EQ(at(grid, 3.25, y), Grid::unknown) << y;
  }
  EXPECT_EQ(at(grid, -0.5, 0), Grid::unknown);  // behind the laser
}

TEST(Occupancy, ABeamWithoutEchoFreesOnlyWhereRockWouldHaveBeenSeenAndFillsNothing) {
  const Grid grid = grid_of_a_wall(std::numeric_limits<double>::infinity());
  EXPECT_EQ(at(grid, 3.5, 0.01), Grid::free);
  EXPECT_EQ(at(grid, 4.5, 0.01), Grid::unknown);
  for (const float odds : grid.log_odds) EXPECT_LE(odds, 0);
}

TEST(Occupancy, AnEchoBeyondTheRangeOfRibsFillsNothing) {
  const Grid grid = grid_of_a_wall(20);
  EXPECT_EQ(at(grid, 13, 0.01), Grid::free);
  for (const float odds : grid.log_odds) EXPECT_LE(odds, 0);
}

TEST(Occupancy, OriginIsAMultipleOfTheCell) {
  const Grid grid = grid_of_a_wall(3);
  EXPECT_NEAR(std::remainder(grid.origin.x(), grid.cell_m), 0, 1e-9);
  EXPECT_NEAR(std::remainder(grid.origin.y(), grid.cell_m), 0, 1e-9);
}

TEST(Occupancy, AVehicleThatStandsDoesNotVoteTwice) {
  const Plan plan = plan_along(panel_lines(2, 2, 18), {}, 1);
  TourSettings tour, stop;
  stop.stop_at_m = 5, stop.stop_s = 10;
  const auto most = [&](const TourSettings& t) {
    const PlanLog log = drive_plan(plan, {{2, 0}, {16, 0}}, t, 1);
    double sum = 0;
    for (const float odds : map_grid(log.scans, log.mount, log.X_WB, {.most_odds = 1000}).log_odds)
      sum += std::abs(odds);
    return sum;
  };
  EXPECT_NEAR(most(stop) / most(tour), 1, 0.02);  // the places of the scans along the way differ
}

TEST(Occupancy, FreeAreaOfAPanelIsThatOfItsPassages) {
  // A ring of four passages: a square of 18 + 3.7 m with round outer corners less the pillar of 18 - 3.7 m.
  const double d = 18, w = 3.7;
  const Plan plan = plan_along(panel_lines(2, 2, d), {.rough_rms_m = 0}, 1);
  const PlanLog log = drive_plan(plan, {{2, 0}, {d, 0}, {d, d}, {0, d}, {0, 0}, {5, 0}}, {}, 1);
  const Grid grid = map_grid(log.scans, log.mount, log.X_WB, {});
  double free_m2 = 0, occupied_m2 = 0;
  for (const float odds : grid.log_odds) {
    free_m2 += odds < 0 ? grid.cell_m * grid.cell_m : 0;
    occupied_m2 += odds > 0 ? grid.cell_m * grid.cell_m : 0;
  }
  const double corners = (4 - M_PI) * w * w / 4;
  const double area = (d + w) * (d + w) - (d - w) * (d - w) - corners;
  const double ribs_m = 4 * (d + w) + 4 * (d - w);
  // The ribs' cells, one or two across, lie half inside: 0.1 m * 144 m / 2 = 7 m2 of 263.
  EXPECT_NEAR(free_m2, area - 0.05 * ribs_m, 0.05 * ribs_m);
  EXPECT_NEAR(occupied_m2, 0.1 * ribs_m, 0.07 * ribs_m);
}

TEST(Occupancy, TheSameBitsOnAnyNumberOfThreads) {
  const Plan plan = plan_along(panel_lines(2, 2, 18), {}, 1);
  const PlanLog log = drive_plan(plan, {{2, 0}, {18, 0}, {18, 18}}, {}, 1);
  set_threads(1);
  const Grid one = map_grid(log.scans, log.mount, log.X_WB, {});
  set_threads(7);
  const Grid seven = map_grid(log.scans, log.mount, log.X_WB, {});
  set_threads(0);
  EXPECT_EQ(one.log_odds, seven.log_odds);
}

}  // namespace
}  // namespace adit
