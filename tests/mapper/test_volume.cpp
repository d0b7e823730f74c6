// SPDX-License-Identifier: BSD-3-Clause
#include "base/rig.h"
#include "mapper/fan.h"
#include "mapper/stretches.h"
#include "mapper/surface.h"
#include "mapper/volume.h"
#include "tests/support/shapes.h"
#include "tests/support/tube_log.h"

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace adit {
namespace {

constexpr double length_m = 20, width_m = 3.7, height_m = 1.9;

/// The first and the last place of a laser that bounded the swept void, along x.
double swept_length(const Log& log, int laser, const Trajectory& path) {
  const auto scans = covered_scans(log, laser, path);
  const auto x = [&](size_t n) {
    return (path.at(log.scans[laser].stamp_s[n]) * log.rig.mounts[laser].X_BS).translation().x();
  };
  return x(scans.back()) - x(scans.front());
}

Log level_log(const Rig& rig, const Trajectory& path, double noise_m) {
  return tube_log(fine_box_mesh({0, -width_m / 2, 0}, {length_m, width_m / 2, height_m}, 5), rig, path, noise_m, 3);
}

/// Columns of which a whole number fits the width: no aliasing along the walls.
VolumeSettings fine() {
  VolumeSettings settings;
  settings.cell_m = 0.05;
  return settings;
}

Trajectory level_path() {
  return ride_along(straight_line(2, 18), {}, {});
}

TEST(Fan, EndsOfBeamsLieOnTheWallsHoweverTheLaserMoves) {
  Ride ride;
  ride.pitch_deg = 2, ride.roll_deg = 2, ride.heave_m = 0.02;
  const Trajectory path = ride_along(straight_line(2, 8), {}, ride);
  const Log log = level_log(load_rig("cart4", 38400), path, 0);
  for (size_t laser = 0; laser < log.scans.size(); ++laser)
    for (const size_t scan : covered_scans(log, static_cast<int>(laser), path))
      for (const FanBeam& beam : fan_of(log, static_cast<int>(laser), scan, path, 7)) {
        const Vec3& p = beam.end;
        const double off = std::min({std::abs(std::abs(p.y()) - width_m / 2), std::abs(p.z()),
                                     std::abs(p.z() - height_m), std::abs(p.x()), std::abs(p.x() - length_m)});
        // A turn of 7 ms taken as even, while 10 deg/s change by 2 % in it: 0.0002 deg over 18 m.
        EXPECT_LT(off, 1e-3);
      }
}

TEST(Volume, OfALevelTunnelIsWidthTimesHeightTimesLength) {
  const Trajectory path = level_path();
  const Log log = level_log(load_rig("cart4", 38400), path, 0);
  const MappedVoid mapped = map_void(log, path, fine());
  const double up = swept_length(log, find_view(log.rig, View::up), path);
  // Both fans sweep equally long pieces, 0.7 m shifted, that overlap in height over 0.3 m: the lower and the upper
  // part.
  const double upper = height_m - 0.75, lower = 1.05, overlap = 0.3;
  const double both = up - 0.7;
  const double expected = width_m * (upper * up + lower * up - overlap * both);
  ASSERT_TRUE(mapped.volume_m3);
  // Corners of the section cut by chords between beams 1 deg apart, and columns at the ends: 0.5 %.
  EXPECT_NEAR(*mapped.volume_m3 / expected, 1, 0.005);
  EXPECT_EQ(open_edges(mapped.surface), 0u);
  EXPECT_NEAR(mapped.solid.volume_m3() / *mapped.volume_m3, 1, 0.005);  // edges that the surface rounds
  EXPECT_EQ(mapped.surface.label.size(), mapped.surface.face.size());
}

TEST(Volume, SigmaIsThatOfTheLasersOverTheSurfaceEachSawAndPartsAddUp) {
  const Trajectory path = level_path();
  const Log log = level_log(load_rig("cart4", 38400), path, 0);
  VolumeSettings settings = fine();
  settings.common_percent = settings.local_sigma = 0;
  const auto lasers = static_cast<Eigen::Index>(log.rig.mounts.size());
  const Eigen::MatrixXd apart = 1e-6 * Eigen::MatrixXd::Identity(lasers, lasers),
                        together = Eigen::MatrixXd::Constant(lasers, lasers, 1e-6);
  const MappedVoid mapped = map_void(log, path, settings, {}, apart);
  double area = 0;
  for (size_t f = 0; f < mapped.surface.face.size(); ++f) area += mapped.surface.area(f);
  // A millimetre: of two lasers that err apart, and of two that err alike.
  EXPECT_NEAR(*mapped.volume_sigma_m3, 1e-3 * area / std::sqrt(2), 1e-9);
  EXPECT_NEAR(*map_void(log, path, settings, {}, together).volume_sigma_m3, 1e-3 * area, 1e-9);
  settings.common_percent = 0.5;
  EXPECT_NEAR(*map_void(log, path, settings, {}, 0 * apart).volume_sigma_m3, 0.005 * *mapped.volume_m3, 1e-9);
  settings.common_percent = 0, settings.local_sigma = 0.1;
  EXPECT_NEAR(*map_void(log, path, settings, {}, 0 * apart).volume_sigma_m3, 0.1 * std::sqrt(*mapped.volume_m3), 1e-9);
  double sum = 0;
  const std::vector<VolumePart> parts = volume_parts(mapped, path, settings);
  for (const VolumePart& part : parts) sum += part.volume_m3;
  EXPECT_NEAR(sum / *mapped.volume_m3, 1, 1e-12);
  EXPECT_EQ(parts.size(), 1u);  // no corner
}

TEST(Stretches, OfARingDrivenOnceAndAHalfAreItsSides) {
  const Trajectory path = ride_along(ring_line(24, 4, 1.5, 1.5), {}, {});  // a centre line of 20 x 20 m
  const Stretches stretches(path);
  // The side that it begins in the middle of is driven from there, and up to there at the end of the round.
  ASSERT_EQ(stretches.all().size(), 5u);
  double length_m = 0;
  for (const Stretch& s : stretches.all()) length_m += s.length_m;
  // Half a metre a sample, the first of a stretch has no way to it, and corners of 1.5 m are cut: 80 - 2.6.
  EXPECT_NEAR(length_m, 77.4, 4);
  const Vec2 middle = path.X_WB.front().translation().head<2>() + Vec2(0, 10);
  std::set<int> sides;
  for (const Vec2& away : {Vec2(9, 0), Vec2(0, 9), Vec2(-9, 0)}) sides.insert(stretches.nearest(middle + away));
  EXPECT_EQ(sides.size(), 3u);
  EXPECT_EQ(stretches.nearest(middle + Vec2(40, 0)), stretches.nearest(middle + Vec2(9, 0)));
}

void drop(Log& log, View view) {
  const int laser = find_view(log.rig, view);
  log.rig.mounts.erase(log.rig.mounts.begin() + laser);
  log.scans.erase(log.scans.begin() + laser);
}

TEST(Volume, TruePosesOfAShakenCartGiveTheSameVolume) {
  Ride ride;
  ride.pitch_deg = 2, ride.roll_deg = 1.5, ride.heave_m = 0.02, ride.stop_s = 4;
  const Trajectory shaken = ride_along(straight_line(2, 18), {}, ride);
  const Rig rig = load_rig("cart4", 38400);
  Log log = level_log(rig, shaken, 0.005);
  const MappedVoid all = map_void(log, shaken, {});
  drop(log, View::forward_vertical);
  drop(log, View::horizontal);
  const MappedVoid mapped = map_void(log, shaken, {}),
                   level = map_void(level_log(rig, level_path(), 0.005), level_path(), {});
  // Ends that lean, and noise that a union takes the outer side of where fans overlap.
  EXPECT_NEAR(*mapped.volume_m3 / *level.volume_m3, 1, 0.01);
  EXPECT_EQ(open_edges(mapped.surface), 0u);
  // Shaken, the forward fans sweep some of what lies ahead of the last section, and no rock.
  EXPECT_GT(*all.volume_m3, 1.02 * *mapped.volume_m3);
  EXPECT_LT(*all.volume_m3, 1.01 * length_m * width_m * height_m);
}

/// How far it is from a point inside of a box to its walls.
double range_in(const Eigen::AlignedBox3d& box, const Vec3& p, const Vec3& d) {
  double range_m = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k)
    if (d[k] != 0) range_m = std::min(range_m, ((d[k] > 0 ? box.max()[k] : box.min()[k]) - p[k]) / d[k]);
  return range_m;
}

TEST(Volume, OfAStandIsWhatItsNoddingLaserSweeps) {
  const Eigen::AlignedBox3d box(Vec3(-1, -1.85, 0), Vec3(7, 1.85, 1.9));
  Log log{load_rig("groundhog_tilt", 38400), {}};
  log.scans.resize(2);
  const Mount& mount = log.rig.mounts[0];
  Scans& scans = log.scans[0];
  scans.beams = mount.laser.beams;
  log.scans[1].beams = log.rig.mounts[1].laser.beams;
  for (double t = 0; t <= mount.tilt.period_s; t += 0.2) {
    scans.stamp_s.push_back(t);
    scans.tilt_rad.push_back(mount.tilt.at(t));
    const Pose X_WS = mount.X_BS_at(scans.tilt_rad.back());
    for (int k = 0; k < scans.beams; ++k) {
      const double a = mount.laser.beam_angle_rad(k);
      scans.range_m.push_back(
          static_cast<float>(range_in(box, X_WS.translation(), X_WS.linear() * Vec3(std::cos(a), std::sin(a), 0))));
    }
  }
  const Trajectory stands{{-1, 20}, {Pose::Identity(), Pose::Identity()}};
  // Counted on a lattice: what lies between the lowest and the highest half plane ahead of the mirror.
  const Vec3 o = mount.X_BS.translation();
  constexpr double step_m = 0.04;
  double swept_m3 = 0;
  for (double x = box.min().x() + step_m / 2; x < box.max().x(); x += step_m)
    for (double z = box.min().z() + step_m / 2; z < box.max().z(); z += step_m) {
      const double down = std::atan2(o.z() - z, x - o.x());
      if (down > mount.tilt.from_rad && down < mount.tilt.to_rad) swept_m3 += step_m * step_m * box.sizes().y();
    }
  EXPECT_NEAR(map_void(log, stands, fine()).volume_m3.value() / swept_m3, 1, 0.02);
}

TEST(Volume, ARigWithoutAnUpwardLaserMapsNone) {
  Log log = level_log(load_rig("cart4", 38400), level_path(), 0);
  drop(log, View::up);
  const MappedVoid mapped = map_void(log, level_path(), {});
  EXPECT_FALSE(mapped.volume_m3);
  EXPECT_TRUE(mapped.surface.face.empty());
}

TEST(Volume, ARigWithoutADownwardLaserMapsWhatLiesAboveTheUpwardOne) {
  Log log = level_log(load_rig("cart4", 38400), level_path(), 0);
  drop(log, View::down);
  const double swept = swept_length(log, find_view(log.rig, View::up), level_path());
  EXPECT_NEAR(*map_void(log, level_path(), fine()).volume_m3 / (swept * width_m * (height_m - 0.75)), 1, 0.005);
}

TEST(Volume, OnePointAVoxelStaysAndLiesOnTheWalls) {
  const Trajectory path = level_path();
  const Log log = level_log(load_rig("cart4", 38400), path, 0);
  const PointCloud cloud = map_points(log, path, {});
  ASSERT_GT(cloud.size(), 1000u);
  ASSERT_EQ(cloud.stamp_s.size(), cloud.size());
  ASSERT_EQ(cloud.laser.size(), cloud.size());
  std::set<std::array<std::int64_t, 3>> voxels;
  for (size_t n = 0; n < cloud.size(); ++n) {
    const Vec3& p = cloud.p[n];
    EXPECT_TRUE(voxels.insert({std::llround(p.x() * 10), std::llround(p.y() * 10), std::llround(p.z() * 10)}).second);
    const double off = std::min({std::abs(std::abs(p.y()) - width_m / 2), std::abs(p.z()), std::abs(p.z() - height_m),
                                 std::abs(p.x()), std::abs(p.x() - length_m)});
    EXPECT_LT(off, 1e-3);
  }
}

TEST(Surface, OfSolidsThatTouchAlongEdgesAndCornersIsClosed) {
  // Boxes of one voxel in a checkerboard, and random ones: the worst cases for a surface between voxels.
  const Dexels grid = empty_dexels({0, 0}, {2, 2}, 0.1);
  std::vector<std::vector<Interval>> columns(grid.columns());
  for (int j = 0; j < grid.height; ++j)
    for (int i = 0; i < grid.width; ++i)
      for (int k = 0; k < 20; ++k)
        if ((i / 2 * 7 + j / 2 * 13 + k / 2 * 29 + (i / 2) * (j / 2) * (k / 2)) % 3 == 0)
          columns[grid.index(i, j)].push_back({k * 0.1, (k + 1) * 0.1});
  const Dexels solid = dexels_of(columns, grid);
  for (const int cells : {1, 2}) {
    const Mesh surface = boundary_of(solid, cells);
    EXPECT_GT(surface.face.size(), 100u);
    EXPECT_EQ(open_edges(surface), 0u) << cells;
    EXPECT_GT(enclosed_volume(surface), 0);
  }
}

TEST(Surface, LevelFacesLieWhereTheColumnsEndWhateverTheVoxels) {
  for (const double low : {0.0, 0.03, 0.071, 0.11, 0.149}) {
    const Dexels grid = empty_dexels({0, 0}, {3, 3}, 0.075);
    std::vector<std::vector<Interval>> columns(grid.columns());
    for (int j = 0; j < grid.height; ++j)
      for (int i = 0; i < grid.width; ++i)
        if ((grid.axis(i, j) - Vec2(1.5, 1.5)).cwiseAbs().maxCoeff() < 1)
          columns[grid.index(i, j)] = {{low, low + 1.9}};
    const Mesh surface = boundary_of(dexels_of(columns, grid), 2);
    for (const Vec3& v : surface.vertex)
      if ((v.head<2>() - Vec2(1.5, 1.5)).cwiseAbs().maxCoeff() < 0.7) {
        EXPECT_LT(std::min(std::abs(v.z() - low), std::abs(v.z() - low - 1.9)), 1e-6) << low;
      }
  }
}

TEST(Surface, OfABallHasItsVolumeAndNormalsOutward) {
  const Mesh ball = sphere_mesh({0.3, 0.2, 0.1}, 1.0, 5);
  const Dexels solid = dexels_of(ball, empty_dexels({-1, -1}, {2, 2}, 0.04));
  const Mesh surface = boundary_of(solid, 2);
  EXPECT_EQ(open_edges(surface), 0u);
  // Facets 8 cm wide cut 0.8 mm off a ball of 1 m, 0.24 %, and so does a box that a bulging face fills to less than half.
  EXPECT_NEAR(enclosed_volume(surface) / solid.volume_m3(), 1, 0.006);
  for (size_t f = 0; f < surface.face.size(); ++f) {
    const Vec3 middle = (surface.corner(f, 0) + surface.corner(f, 1) + surface.corner(f, 2)) / 3 - Vec3(0.3, 0.2, 0.1);
    EXPECT_NEAR(middle.norm(), 1, 0.04);  // half a voxel
    if (surface.area(f) > 1e-5) {
      EXPECT_GT(surface.normal(f).dot(middle.normalized()), 0.5);
    }
  }
}

}  // namespace
}  // namespace adit
