// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "sim/relief.h"
#include "sim/sim.h"
#include "tests/sim/terrain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;

// One straight passage along x with a floor as a levelled haulage way has it: waves of 1.5 to 4 m, 7 mm rms.
World passage_world() {
  World world = terrain_world({-4, -3}, {44, 3}, 0.25, [](const Vec2& p) {
    return 0.01 * (std::sin(4.1 * p.x() + 1.1 * p.y()) + std::sin(2.3 * p.x() - 2.9 * p.y())) / std::sqrt(2.0);
  });
  world.junctions = {{Vec3(-3, 0, 0), {0}}, {Vec3(43, 0, 0), {0}}};
  Passage passage{0, 1, {}, 4, 2, 46};
  for (int x = -3; x <= 43; ++x) passage.centre_line.push_back({static_cast<double>(x), 0, 0});
  world.passages = {passage};
  return world;
}

World level_world(double height_m) {
  return terrain_world({-2, -2}, {2, 2}, 0.5, [=](const Vec2&) { return height_m; });
}

TEST(Relief, ABallTouchesLevelGroundUnderItsMiddle) {
  const World world = level_world(3.25);
  const Floor floor(world.mesh);
  const Relief relief(world, floor, FloorKind::smooth, 1);
  for (const double gap : {-0.01, 0.0, 0.015}) {
    const std::vector<Touch> touches = relief.touches({0.31, -0.17, 3.25 + 0.2 + gap}, 0.2, {1, 0}, 0.02);
    ASSERT_FALSE(touches.empty());
    for (const Touch& touch : touches) {
      EXPECT_NEAR(touch.distance_m, gap, 1e-6);
      EXPECT_NEAR(touch.normal_W.z(), 1, 1e-6);
    }
  }
  EXPECT_TRUE(relief.touches({0, 0, 3.5}, 0.2, {1, 0}, 0.02).empty());
  EXPECT_TRUE(relief.touches({9, 9, 3.4}, 0.2, {1, 0}, 0.02).empty());  // no floor there
}

TEST(Relief, ABallOnARampTouchesItWhereThePlumbToThePlaneFalls) {
  const double slope = 12 * deg;
  const World world = terrain_world({-2, -2}, {2, 2}, 0.5, [=](const Vec2& p) { return p.x() * std::tan(slope); });
  const Floor floor(world.mesh);
  const Relief relief(world, floor, FloorKind::smooth, 1);
  const Vec3 normal(-std::sin(slope), 0, std::cos(slope)), foot(0.3, 0.1, 0.3 * std::tan(slope));
  const std::vector<Touch> touches = relief.touches(foot + 0.24 * normal, 0.25, {1, 0}, 0.02);
  const auto nearest =
      std::min_element(touches.begin(), touches.end(), [](auto& a, auto& b) { return a.distance_m < b.distance_m; });
  ASSERT_NE(nearest, touches.end());
  EXPECT_NEAR(nearest->distance_m, -0.01, 1e-5);  // the search ends within 1 mm along the ground: 1e-6 / (2 * 0.24)
  EXPECT_LT((nearest->normal_W - normal).norm(), 0.005);
}

TEST(Relief, RestsOnWhatLiesThere) {
  const World world = passage_world();
  const Floor floor(world.mesh);
  const Relief relief(world, floor, FloorKind::rubble, 5);
  for (int k = 0; k < 200; ++k) {
    const Vec2 p(0.15 * k, 0.01 * k - 1);
    const double at = *relief.height_m(p), rest = *relief.rest_height_m(p, 0.15);
    EXPECT_GE(rest, at);
    EXPECT_LT(rest - at, 0.15);
  }
}

TEST(Relief, DoesNotDependOnWhatWasAskedBefore) {
  const World world = passage_world();
  const Floor floor(world.mesh);
  const Relief one(world, floor, FloorKind::track, 5), other(world, floor, FloorKind::track, 5);
  for (double x = 40; x > 0; x -= 0.37) EXPECT_TRUE(other.height_m({x, 0.3}).has_value());
  for (double x = 0; x < 40; x += 0.05) ASSERT_EQ(one.height_m({x, 0.3}), other.height_m({x, 0.3})) << "x " << x;
}

TEST(Relief, SleepersAndRailsStandAsHighAsOldTrackDoesAndEndBeforeJunctions) {
  const World world = passage_world();
  const Floor floor(world.mesh);
  const Relief relief(world, floor, FloorKind::track, 7);
  double highest = 0;
  for (double x = 5; x < 35; x += 0.01)
    for (const double y : {-0.53, 0.0, 0.4})
      highest = std::max(highest, *relief.height_m({x, y}) - *floor.height_m({x, y}));
  EXPECT_GT(highest, 0.03);
  EXPECT_LT(highest, 0.11);
  for (double x = -2.9; x < -0.6; x += 0.03)  // planked within 2.5 m of the passage's end at x = -3
    EXPECT_NEAR(*relief.height_m({x, 0}), *floor.height_m({x, 0}), 1e-3);
}

// A passage that bends by 40 degrees: the bed of the track goes round on the outer side too.
TEST(Relief, TrackHasNoGapAtABend) {
  World world = terrain_world({-12, -12}, {22, 12}, 1, [](const Vec2&) { return 0.0; });
  world.junctions = {{Vec3(-10, 0, 0), {0}}, {Vec3(10, 8.4, 0), {0}}};
  const Vec3 way(std::cos(40 * deg), std::sin(40 * deg), 0);
  world.passages = {{0, 1, {Vec3(-10, 0, 0), Vec3::Zero(), 12 * way}, 4, 2, 22}};
  const Floor floor(world.mesh);
  const Relief relief(world, floor, FloorKind::track, 5);
  for (const double r : {0.3, 0.53, 0.7}) {  // round the bend, on either rail and between them
    double before = *relief.height_m(r * Vec2(std::sin(-10 * deg), -std::cos(-10 * deg)));
    for (double a = -9.5; a <= 50; a += 0.5) {
      const double here = *relief.height_m(r * Vec2(std::sin(a * deg), -std::cos(a * deg)));
      // The steepest flank that lies there is a sleeper's, 0.06 m in 0.17 m: slope 0.55; steps are 6 mm long at most.
      EXPECT_LT(std::abs(here - before), 0.006) << "at " << a << " degrees, " << r << " m off the bend";
      before = here;
    }
  }
}

// A cross of four passages, each 30 m long.
World cross_world() {
  World world = terrain_world({-34, -34}, {34, 34}, 2, [](const Vec2&) { return 0.0; });
  world.junctions = {{Vec3::Zero(), {0, 1, 2, 3}}};
  for (const Vec2& way : {Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)}) {
    Passage passage{0, static_cast<int>(world.junctions.size()), {}, 4, 2, 30};
    for (int k = 0; k <= 30; ++k) passage.centre_line.push_back({k * way.x(), k * way.y(), 0});
    world.junctions.push_back({passage.centre_line.back(), {static_cast<int>(world.passages.size())}});
    world.passages.push_back(passage);
  }
  return world;
}

TEST(Relief, PassagesMayDifferAndEachHasItsOwnGround) {
  const World world = cross_world();
  const Floor floor(world.mesh);
  using enum FloorKind;
  const Relief mixed(world, floor, {track, rubble, smooth, rubble}, 5), all_track(world, floor, track, 5);
  double rough = 0;
  for (double s = 5; s < 25; s += 0.05) {
    EXPECT_EQ(mixed.height_m({s, 0.3}), all_track.height_m({s, 0.3})) << "at " << s;
    EXPECT_NEAR(*mixed.height_m({0.3, s}), rubble_height_m({0.3, s}, 5), 0.02) << "at " << s;  // between samples
    EXPECT_EQ(*mixed.height_m({-s, 0.3}), 0) << "at " << s;
    rough = std::max(rough, *mixed.height_m({0.3, -s}));
  }
  EXPECT_GT(rough, 0.1);
  for (double s = 0; s < 2.4; s += 0.1)  // cleared at junctions
    for (const Vec2& p : {Vec2(s, 0.2), Vec2(0.2, s), Vec2(-s, 0.2), Vec2(0.2, -s)}) EXPECT_EQ(*mixed.height_m(p), 0);
}

TEST(Relief, WherePassagesDifferTheGroundHasNoSteps) {
  const World world = cross_world();
  const Floor floor(world.mesh);
  using enum FloorKind;
  const Relief mixed(world, floor, {track, rubble, smooth, rubble}, 6);
  double steepest = 0;
  for (double a = 0; a < 2 * std::numbers::pi; a += 0.002)  // round the junction over all borders
    for (const double r : {3.0, 6.0, 9.0}) {
      const Vec2 p = r * Vec2(std::cos(a), std::sin(a)), q = p + 0.005 * Vec2(-std::sin(a), std::cos(a));
      steepest = std::max(steepest, std::abs(*mixed.height_m(q) - *mixed.height_m(p)) / 0.005);
    }
  EXPECT_LT(steepest, 1.2);  // as stones on rubble are
}

TEST(Relief, DrawnGroundHasItsSharesOfThePassagesLength) {
  World world = cross_world();
  for (int k = 0; k < 200; ++k) {
    world.passages.push_back(world.passages[0]);
    world.passages.back().length_m = 10 + 20 * uniform(3, Draw::test, static_cast<std::uint64_t>(k), 0);
  }
  double all = 0;
  for (const Passage& passage : world.passages) all += passage.length_m;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const std::vector<FloorKind> kinds = draw_floor_kinds(world, 0.3, 0.2, seed);
    double of[3] = {0, 0, 0};
    for (size_t i = 0; i < kinds.size(); ++i) of[static_cast<size_t>(kinds[i])] += world.passages[i].length_m;
    EXPECT_NEAR(of[1], 0.3 * all, 30) << "seed " << seed;  // to within a passage
    EXPECT_NEAR(of[2], 0.2 * all, 30) << "seed " << seed;
    EXPECT_NE(kinds, draw_floor_kinds(world, 0.3, 0.2, seed + 10));
  }
}

struct Swing {
  double pitch_deg = 0, roll_deg = 0, heave_m = 0;     // sd about the mean over 5.6 m
  double pitch_deg_s = 0, roll_deg_s = 0;              // rms rates over 33 ms
  double pitch_quick_deg_s = 0, roll_quick_deg_s = 0;  // rates that one hundredth of the time exceeds
  double pitch_peak_deg = 0, roll_peak_deg = 0;
  double strongest_hz = 0;  // of pitch
};

double moving_mean(const std::vector<double>& sum, size_t i, size_t half) {
  return (sum[i + half] - sum[i - half]) / (2 * static_cast<double>(half));
}

Swing swing_of(const Trajectory& path, double speed_mps) {
  constexpr double window_m = 5.6;  // which the cart walks in 8 s
  constexpr size_t lag = 4;
  const auto half = static_cast<size_t>(0.5 * window_m / speed_mps * 120);
  const size_t n = path.size();
  std::vector<double> value[3], sum[3];
  for (auto& s : sum) s.assign(n + 1, 0);
  for (size_t i = 0; i < n; ++i) {
    const YawPitchRoll a = yaw_pitch_roll(path.X_WB[i].linear());
    const double now[3] = {a.pitch_rad / deg, a.roll_rad / deg, path.X_WB[i].translation().z()};
    for (int k = 0; k < 3; ++k) value[k].push_back(now[k]), sum[k][i + 1] = sum[k][i] + now[k];
  }
  Swing swing;
  double square[3] = {0, 0, 0}, rate[2] = {0, 0}, peak[2] = {0, 0};
  double count = 0;
  std::vector<double> pitch, rates[2];
  for (size_t i = half; i + half < n; ++i, ++count) {
    for (int k = 0; k < 3; ++k) {
      const double off = value[k][i] - moving_mean(sum[k], i, half);
      square[k] += off * off;
      if (k == 0) pitch.push_back(off);
      if (k == 2) continue;
      peak[k] = std::max(peak[k], std::abs(off));
      const double r = (value[k][i] - value[k][i - lag]) * 120 / lag;
      rate[k] += r * r;
      rates[k].push_back(std::abs(r));
    }
  }
  for (auto& r : rates) std::sort(r.begin(), r.end());
  swing.pitch_quick_deg_s = rates[0][rates[0].size() * 99 / 100];
  swing.roll_quick_deg_s = rates[1][rates[1].size() * 99 / 100];
  swing.pitch_deg = std::sqrt(square[0] / count);
  swing.roll_deg = std::sqrt(square[1] / count);
  swing.heave_m = std::sqrt(square[2] / count);
  swing.pitch_deg_s = std::sqrt(rate[0] / count);
  swing.roll_deg_s = std::sqrt(rate[1] / count);
  swing.pitch_peak_deg = peak[0];
  swing.roll_peak_deg = peak[1];
  double most = 0;
  for (double per_m = 0.4; per_m < 6; per_m += 0.03) {
    const double hz = per_m * speed_mps;
    double re = 0, im = 0;
    for (size_t i = 0; i < pitch.size(); ++i) {
      const double phase = 2 * std::numbers::pi * hz * static_cast<double>(i) / 120;
      re += pitch[i] * std::cos(phase), im += pitch[i] * std::sin(phase);
    }
    if (re * re + im * im > most) most = re * re + im * im, swing.strongest_hz = hz;
  }
  return swing;
}

Swing swing_on(const std::string& ground, const std::string& vehicle = "cart", double way_m = 39) {
  DriveSettings settings;
  settings.ground = ground;
  settings.lead_in_s = 0.5;
  settings.stop_gap_min_m = settings.stop_gap_max_m = 1e4;
  settings.speed_sd_mps = 0.02;
  const Drive d = drive(passage_world(), route_through({{0, 0}, {way_m, 0}}, 0), load_vehicle(vehicle), settings, 3);
  EXPECT_EQ(d.end, DriveEnd::finished) << ground << ": " << d.cause;
  return swing_of(d.path, vehicle == "cart" ? settings.speed_mps : settings.robot_speed_mps);
}

// The ranges that old mine floors are held to: smooth 0.5 to 1 degree sd and 3 to 10 degrees a second; track 2 degrees, 20
// to 40; rubble 4 degrees, peaks of 10 to 15, to 60 degrees a second. A figure there is good to about a third.
TEST(Relief, ASmoothFloorSwingsACartByHalfADegreeToOne) {
  const Swing s = swing_on("smooth");
  EXPECT_GT(s.pitch_deg, 0.4);
  EXPECT_LT(s.pitch_deg, 1.1);
  EXPECT_GT(s.roll_deg, 0.4);
  EXPECT_LT(s.roll_deg, 1.1);
  for (const double quick : {s.pitch_quick_deg_s, s.roll_quick_deg_s}) {
    EXPECT_GT(quick, 3);
    EXPECT_LT(quick, 11);
  }
}

TEST(Relief, TrackSwingsACartByTwoDegreesAtThePaceOfItsSleepers) {
  const Swing s = swing_on("track");
  EXPECT_GT(s.pitch_deg, 1.3);
  EXPECT_LT(s.pitch_deg, 2.7);
  EXPECT_GT(s.pitch_deg_s, 10);
  for (const double quick : {s.pitch_quick_deg_s, s.roll_quick_deg_s}) {
    EXPECT_GT(quick, 18);
    EXPECT_LT(quick, 45);
  }
  EXPECT_GT(s.roll_deg, 1.3);
  EXPECT_LT(s.roll_deg, 2.7);
  EXPECT_NEAR(s.strongest_hz, 0.7 / 0.6, 0.15);  // 0.7 m/s over sleepers 0.6 m apart
  EXPECT_LT(s.heave_m, 0.08);
}

TEST(Relief, RubbleSwingsACartByFourDegrees) {
  const Swing s = swing_on("rubble");
  EXPECT_GT(s.pitch_deg, 2.7);
  EXPECT_LT(s.pitch_deg, 5.3);
  EXPECT_GT(s.roll_deg, 2.7);
  EXPECT_LT(s.roll_deg, 5.3);
  EXPECT_GT(std::max(s.pitch_peak_deg, s.roll_peak_deg), 8);
  EXPECT_LT(std::max(s.pitch_peak_deg, s.roll_peak_deg), 18);
  for (const double quick : {s.pitch_quick_deg_s, s.roll_quick_deg_s}) {
    EXPECT_GT(quick, 18);
    EXPECT_LT(quick, 60);
  }
  EXPECT_GT(s.heave_m, 0.015);
  EXPECT_LT(s.heave_m, 0.08);
}

// The robot is longer by three fifths, its wheels are twice as large, and it goes at a fifth of the pace: it swings less
// than the cart on the same floors, where stones are far apart nearly as much, and slowly.
TEST(Relief, ARobotSwingsLessThanACartAndAtItsOwnPace) {
  const Swing smooth = swing_on("smooth", "groundhog", 14), track = swing_on("track", "groundhog", 14),
              rubble = swing_on("rubble", "groundhog", 14);
  for (const double sd : {smooth.pitch_deg, smooth.roll_deg}) {
    EXPECT_GT(sd, 0.1);
    EXPECT_LT(sd, 0.5);  // of the cart 0.5 to 0.7
  }
  for (const double sd : {track.pitch_deg, track.roll_deg}) {
    EXPECT_GT(sd, 0.5);
    EXPECT_LT(sd, 1.6);  // of the cart 1.6 to 1.8
  }
  EXPECT_NEAR(track.strongest_hz, 0.15 / 0.6, 0.03);  // 0.15 m/s over sleepers 0.6 m apart
  for (const double sd : {rubble.pitch_deg, rubble.roll_deg}) {
    EXPECT_GT(sd, 2);
    EXPECT_LT(sd, 4.2);  // of the cart 3.5 to 4.2
  }
  for (const Swing& s : {smooth, track, rubble})
    for (const double quick : {s.pitch_quick_deg_s, s.roll_quick_deg_s}) EXPECT_LT(quick, 12);
  EXPECT_LT(rubble.heave_m, 0.08);
}

}  // namespace
}  // namespace adit
