// SPDX-License-Identifier: BSD-3-Clause
// Each effect of [sensors] alone, in whole recordings: what it changes, what it leaves as it was, and by how much.
#include "tests/sensors/scenes.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>

namespace adit {
namespace {

// Of every face that `where` holds for by its middle.
void relabel(Mesh& mesh, Label label, const std::function<bool(const Vec3&)>& where) {
  for (size_t f = 0; f < mesh.face.size(); ++f)
    if (where((mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3)) mesh.label[f] = label;
}

// 20 m of tunnel with a pool in its middle and daylight at its end.
World tunnel_with_pool() {
  World world = tunnel_world(20, 4, 2, 1);
  relabel(world.mesh, Label::water, [](const Vec3& p) { return p.z() == 0 && std::abs(p.x() - 12) < 2; });
  relabel(world.mesh, Label::cap, [](const Vec3& p) { return p.x() == 20; });
  return world;
}

// A fan ahead and one along the way, up and down.
const char* const rig_changes[] = {"up off", "down off"};

Recording recorded(SensorSettings s) {
  s.baud = 500000;
  s.mounts = {std::begin(rig_changes), std::end(rig_changes)};
  const Drive stand = drive_of(1, [](double) { return pose_of({10, 0.3, 0}, 0.1); });
  const Hull post{{"post", {1.0, 0.5, 0}, {1.05, 0.55, 2}, Label::vehicle}};  // less than a pulse before the rib
  static const World world = tunnel_with_pool();
  return record(world, stand, load_rig(s), post, s, 1);
}

SensorSettings nothing_on() {
  SensorSettings s = exact();
  s.water = s.rounding = false;
  return s;
}

// What of two recordings differs.
enum : unsigned { stamps = 1, truth = 2, told = 4, codes = 8 };

// As far as both go: a lost scan leaves one less.
template <class T>
bool same(const std::vector<T>& a, const std::vector<T>& b) {
  const size_t n = std::min(a.size(), b.size());
  return n > 0 && std::memcmp(a.data(), b.data(), n * sizeof(T)) == 0;
}

unsigned difference(const Recording& a, const Recording& b) {
  unsigned what = 0;
  for (size_t i = 0; i < a.log.scans.size(); ++i) {
    if (!same(a.log.scans[i].stamp_s, b.log.scans[i].stamp_s)) what |= stamps;
    if (!same(a.truth.scans[i].range_m, b.truth.scans[i].range_m)) what |= truth;
    if (!same(a.log.scans[i].range_m, b.log.scans[i].range_m)) what |= told;
    if (!same(a.log.scans[i].code, b.log.scans[i].code)) what |= codes;
  }
  return what;
}

struct Effect {
  const char* name;
  std::function<void(SensorSettings&)> on;
  unsigned changes;
};

const Effect effects[] = {
    {"nothing", [](SensorSettings&) {}, 0},
    {"noise", [](SensorSettings& s) { s.noise = true; }, told},
    {"footprint", [](SensorSettings& s) { s.footprint = true; }, told},
    {"bias", [](SensorSettings& s) { s.bias = true; }, told},
    {"range_offset", [](SensorSettings& s) { s.range_offset_m = 0.01; }, told},
    {"range_curve", [](SensorSettings& s) { s.range_curve = true; }, told},
    {"energy", [](SensorSettings& s) { s.energy = true; }, told},
    {"warm_up", [](SensorSettings& s) { s.warm_up = true; }, told},
    {"rounding", [](SensorSettings& s) { s.rounding = true; }, told},
    {"counter", [](SensorSettings& s) { s.counter_mm = 10; }, told},
    {"sub_rays", [](SensorSettings& s) { s.sub_rays = 19; }, told},
    {"detection", [](SensorSettings& s) { s.detection = true; }, told | codes},
    {"drop_out", [](SensorSettings& s) { s.drop_out = 0.01; }, told | codes},
    {"dust_echo", [](SensorSettings& s) { s.dust_echo_per_m = 0.03; }, told},
    {"dazzle", [](SensorSettings& s) { s.dazzle_deg = 3; }, told | codes},
    {"crosstalk", [](SensorSettings& s) { s.crosstalk = 0.01; }, told},
    {"water", [](SensorSettings& s) { s.water = true; }, told},
    {"mode", [](SensorSettings& s) { s.mode = "8m"; }, told | codes},
    {"beam_angle", [](SensorSettings& s) { s.beam_angle_deg = 0.05; }, truth | told},
    {"mount_error", [](SensorSettings& s) { s.mount_error_deg = 0.2; }, truth | told},
    {"mount_shift", [](SensorSettings& s) { s.mount_error_m = 0.005; }, truth | told},
    {"late", [](SensorSettings& s) { s.late = 0.5; }, stamps},
    {"loses", [](SensorSettings& s) { s.faults = {"front loses from_s=0 share=0.5"}; }, stamps},
    {"jitter", [](SensorSettings& s) { s.jitter_s = 0.001; }, stamps},
    {"latency", [](SensorSettings& s) { s.latency = true; }, stamps},
    {"drifts", [](SensorSettings& s) { s.faults = {"front drifts from_s=0 ppm=100"}; }, stamps},
    {"lags", [](SensorSettings& s) { s.faults = {"front lags from_s=0 lag_s=0.1"}; }, stamps},
    {"slips", [](SensorSettings& s) { s.faults = {"front slips from_s=0.5 yaw_deg=1"}; }, truth | told},
};

TEST(Effects, EachAloneChangesWhatItIsAboutAndNothingElse) {
  const Recording none = recorded(nothing_on());
  for (const Effect& effect : effects) {
    SensorSettings s = nothing_on();
    effect.on(s);
    EXPECT_EQ(difference(none, recorded(s)), effect.changes) << effect.name;
  }
}

TEST(Effects, ADirtyWindowAndDustLoseMoreOfWhatIsLostAlready) {
  const auto echoes = [](const SensorSettings& s) {
    const Recording r = recorded(s);
    const std::vector<float>& ranges = r.log.scans[0].range_m;
    return std::count_if(ranges.begin(), ranges.end(), [](float x) { return std::isfinite(x); });
  };
  SensorSettings clean = nothing_on(), dirty = clean, dusty = clean, off = clean;
  clean.detection = dirty.detection = dusty.detection = true;
  clean.reflectivity = dirty.reflectivity = dusty.reflectivity = 0.45;
  dirty.dirty_window = off.dirty_window = 1.55;
  dusty.dust_loss_per_m = off.dust_loss_per_m = 0.1;
  EXPECT_LT(echoes(dirty), 0.98 * static_cast<double>(echoes(clean)));
  EXPECT_LT(echoes(dusty), 0.95 * static_cast<double>(echoes(clean)));
  EXPECT_EQ(difference(recorded(off), recorded(nothing_on())), 0u);  // they are about detection
}

TEST(Effects, EverythingAtOnceGivesTheSameBitsFromTheSameSeed) {
  SensorSettings s = nothing_on();
  for (const Effect& effect : effects) effect.on(s);
  s.detection = true, s.dust_loss_per_m = 0.02, s.late = 0.1;
  const Recording a = recorded(s), b = recorded(s);
  EXPECT_EQ(difference(a, b), 0u);
  EXPECT_TRUE(same(a.truth.scans[0].fault, b.truth.scans[0].fault));
  EXPECT_EQ(difference(a, recorded(nothing_on())), stamps | truth | told | codes);
}

TEST(Effects, BeamsErrInTheirPlaneByTheStatedAngle) {
  const World tunnel = tunnel_world(60, 4, 2);
  const Drive stand = drive_of(4, [](double) { return pose_of({30, 0, 0}, 0); });
  SensorSettings s = exact();
  s.beam_angle_deg = 0.05;
  const Recording r = record(tunnel, stand, one_laser("ideal", pose_of({0, 0, 1}, 0)), {}, s, 1);
  double n = 0, sum = 0, squares = 0;
  for (size_t i = 0; i < r.truth.scans[0].range_m.size(); ++i) {
    const double a = r.log.rig.mounts[0].laser.beam_angle_rad(static_cast<int>(i % 361));
    if (a < 0.3 || a > 1.2) continue;
    // The rib 2 m to the left: the range tells where the beam truly went.
    const double error = std::asin(2 / static_cast<double>(r.truth.scans[0].range_m[i])) - a;
    ++n, sum += error, squares += error * error;
  }
  const double sd = 0.05 * M_PI / 180;
  EXPECT_NEAR(sum / n, 0, 5 * sd / std::sqrt(n));                     // five standard errors
  EXPECT_NEAR(std::sqrt(squares / n) / sd, 1, 5 / std::sqrt(2 * n));  // of an sd
  EXPECT_GT(n, 10000);
}

TEST(Effects, DaylightDazzlesTheBeamsThatLookIntoItAndSoManyDegreesBeside) {
  World world = tunnel_world(20, 4, 2);
  relabel(world.mesh, Label::cap, [](const Vec3& p) { return p.x() == 20; });
  const Drive stand = drive_of(0.2, [](double) { return pose_of({10, 0, 0}, 0); });
  for (const char* raster : {"180/0.5", "100/0.5"})
    for (const double beside_deg : {0.0, 3.0}) {
      SensorSettings s = exact();
      s.dazzle_deg = beside_deg;
      Rig rig = one_laser("lms200", pose_of({0, 0, 1}, 0));
      rig.mounts[0].laser = load_laser("lms200", 500000, {.raster = raster});
      const LaserModel& laser = rig.mounts[0].laser;
      const Recording r = record(world, stand, rig, {}, s, 1);
      for (int k = 0; k < laser.beams; ++k) {
        // The portal is 4 m wide and 10 m away: 11.31 degrees to either side, of which half degrees see up to 11.
        const bool dazzled = beside_deg > 0 && std::abs(laser.beam_angle_rad(k)) * 180 / M_PI < 11 + beside_deg + 0.25;
        EXPECT_EQ(r.log.scans[0].code[k], dazzled ? Code::dazzled : Code::range) << raster << " beam " << k;
        EXPECT_EQ(std::isnan(r.log.scans[0].range_m[k]), dazzled);
      }
    }
}

TEST(Effects, APoolShowsTheRoofBelowTheFloorToldAsAGhostAndNothingWhereTheEchoIsTooWeak) {
  World world = tunnel_world(40, 4, 2, 1);
  relabel(world.mesh, Label::water, [](const Vec3& p) { return p.z() == 0; });
  const Drive stand = drive_of(0.2, [](double) { return pose_of({10, 0, 0}, 0); });
  // Beam 0 looks straight down, 1 m above the pool; beam k half a degree more ahead each.
  const Rig rig = one_laser("lms200", pose_of({0, 0, 1}, 0, 0, M_PI / 2));
  SensorSettings mirror = exact(), still = exact(), weak = exact();
  still.water = false;
  weak.detection = true;
  const Recording seen = record(world, stand, rig, {}, mirror, 1), rock = record(world, stand, rig, {}, still, 1),
                  lost = record(world, stand, rig, {}, weak, 1);
  for (int k = 0; k <= 160; ++k) {
    if (k == 30) continue;  // 15 degrees, to the last bit either
    const double from_vertical = k * 0.5 * M_PI / 180, water_m = 1 / std::cos(from_vertical);
    const bool ghost = k * 0.5 > 15;
    const double told_m = seen.log.scans[0].range_m[k];
    EXPECT_NEAR(rock.log.scans[0].range_m[k], water_m, 0.00051) << k;  // told in millimetres
    EXPECT_NEAR(told_m, ghost ? 3 * water_m : water_m, 0.0011) << k;  // the mirrored ray starts 0.1 mm before the water
    EXPECT_EQ(seen.truth.scans[0].fault[k], ghost ? trouble::ghost : 0) << k;
    EXPECT_EQ(seen.truth.scans[0].label[k], static_cast<int>(Label::water));
    EXPECT_NEAR(seen.truth.scans[0].range_m[k], water_m, 1e-5);
    // Two reflections of 2 to 6 % each leave a thousandth of 45 %, far below the 1.85 % that is noticed.
    if (ghost && k * 0.5 < 60) {
      EXPECT_EQ(lost.log.scans[0].code[k], Code::no_echo) << k;
    }
  }
}

}  // namespace
}  // namespace adit
