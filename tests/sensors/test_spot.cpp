// SPDX-License-Identifier: BSD-3-Clause
// What a beam's width does: the sheet's diameters, mixed pixels at edges, thin things that look fat.
#include "sensors/fan.h"
#include "tests/sensors/scenes.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

TEST(Spot, IsAsWideAsTheSheetSaysAtEveryRange) {
  const Bundle rim{.place = {{0, 0}, {1, 0}}, .weight = {0.5, 0.5}};
  struct Row {
    const char* model;
    double range_m, diameter_mm;
  };
  for (const Row& row : {Row{"lms200", 1, 16},
                         {"lms200", 2, 21},
                         {"lms200", 5, 34},
                         {"lms200", 8, 47},
                         {"lms200", 10, 56},
                         {"lms200", 20, 100},
                         {"lms291", 1, 28},
                         {"lms291", 2, 40},
                         {"lms291", 5, 76},
                         {"lms291", 8, 111},
                         {"lms291", 10, 135},
                         {"lms291", 20, 254}}) {
    const Ray axis{{0, 0, 0}, {1, 0, 0}}, edge = spot_ray(axis, {0, 1, 0}, {0, 0, 1}, load_laser(row.model, 0), rim, 1);
    const double across_m = edge.origin.y() + row.range_m * edge.direction.y() / edge.direction.x();
    EXPECT_NEAR(2000 * across_m, row.diameter_mm, 0.51) << row.model << " at " << row.range_m;  // the table is rounded
  }
}

// A fine fan ahead, from 10 m before the end of a tunnel: what a device's own raster would tell wherever it stood.
struct Scene {
  const char* model;
  int sub_rays;
  double step_deg;
  Hull hull;
  double hull_reflectivity = 0.45;
  bool detection = false;
};

Recording ahead(const Scene& scene, double end_m) {
  const World tunnel = tunnel_world(end_m + 1, 30, 4);
  const Drive stand = drive_of(0.1, [](double) { return pose_of({1, 0, 0}, 0); });
  Rig rig = one_laser(scene.model, pose_of({0, 0, 2}, 0));
  LaserModel& laser = rig.mounts[0].laser;
  laser.fov_rad = 8 * M_PI / 180;
  laser.beams = 1 + static_cast<int>(std::lround(8 / scene.step_deg));
  SensorSettings s = exact();
  s.sub_rays = scene.sub_rays;
  s.detection = scene.detection;
  s.hull_reflectivity = scene.hull_reflectivity;
  return record(tunnel, stand, rig, scene.hull, s, 1);
}

// Metres across at a range that the beams cover which `chosen` holds for.
template <class Chosen>
double width_m(const Recording& r, double range_m, double step_deg, const Chosen& chosen) {
  const int beams = r.log.scans[0].beams;
  double n = 0;
  for (int k = 0; k < beams; ++k) n += chosen(static_cast<size_t>(k));
  return n * range_m * step_deg * M_PI / 180;
}

TEST(Spot, AnEdgeMixesSurfacesOverTheBundlesWidth) {
  // 19 rays of equal areas reach out to sqrt(13 / 19) of the spot's radius; an edge cuts every beam nearer than that.
  const double reach = std::sqrt(13.0 / 19);
  for (const auto& [model, at_m] : {std::pair{"lms200", 2.0}, {"lms200", 5.0}, {"lms291", 2.0}, {"lms291", 5.0}}) {
    const Hull board{{"board", {at_m, -20, -1}, {at_m + 0.05, 0, 5}, Label::vehicle}};
    const double step_deg = 0.01;
    const Recording r = ahead({model, 19, step_deg, board}, at_m + 1);
    const LaserModel& laser = r.log.rig.mounts[0].laser;
    const double wide_m = laser.spot_m + laser.divergence_rad * at_m;
    const double mixed_m = width_m(r, at_m, step_deg, [&](size_t k) { return r.truth.scans[0].surfaces[k] == 2; });
    // A beam's step at either end, and the rings' rays, 15 degrees apart at most, may miss the rim by 1 - cos(7.5 deg).
    EXPECT_NEAR(mixed_m, reach * wide_m, 0.01 * wide_m + 2 * at_m * step_deg * M_PI / 180) << model << " at " << at_m;
  }
}

TEST(Spot, AtHalfADegreeAnEdgeTwoMetresAwayGivesAnLms200AboutOneMixedPixelAndA291Two) {
  // Wherever the edge lies between two beams.
  const double half_deg = 0.5;
  for (const auto& [model, least, most] : {std::tuple{"lms200", 0, 2}, {"lms291", 1, 3}}) {
    double sum = 0;
    for (int place = 0; place < 20; ++place) {
      const double edge_m = 2 * std::tan(half_deg * M_PI / 180) * place / 20;
      const Hull board{{"board", {2, -20, -1}, {2.05, edge_m, 5}, Label::vehicle}};
      const Recording r = ahead({model, 19, half_deg, board}, 3);
      int mixed = 0;
      for (int k = 0; k < r.log.scans[0].beams; ++k) mixed += r.truth.scans[0].surfaces[static_cast<size_t>(k)] == 2;
      EXPECT_GE(mixed, least) << model << " " << place;
      EXPECT_LE(mixed, most) << model << " " << place;
      sum += mixed;
    }
    // On average the bundle's width over the beams' distance.
    const LaserModel laser = load_laser(model, 0);
    const double expected =
        std::sqrt(13.0 / 19) * (laser.spot_m + 2 * laser.divergence_rad) / (2 * half_deg * M_PI / 180);
    EXPECT_NEAR(sum / 20, expected, 0.1) << model;  // 20 places: steps of a twentieth, at either end of the spot
  }
}

TEST(Spot, AThinBrightPostLooksFatterByUpToTheSpotsDiameter) {
  // 20 mm of a target of 100 % at 10 m, more than a pulse before the wall. The spot is 56 mm wide; a tenth of it on the
  // post is noticed (telegram listing), so that nearly all beams that touch it tell it.
  const double step_deg = 0.01, post_m = 0.02, spot_m = 0.056;
  const Hull post{{"post", {10, -post_m / 2, -1}, {10.02, post_m / 2, 5}, Label::vehicle}};
  const auto seen_m = [&](int sub_rays) {
    const Recording r = ahead({"lms200", sub_rays, step_deg, post, 1.0, true}, 14);
    return width_m(r, 10, step_deg, [&](size_t k) { return r.log.scans[0].range_m[k] < 11; });
  };
  EXPECT_NEAR(seen_m(1), post_m, 0.0036);  // a beam's step at either end
  EXPECT_GT(seen_m(37), post_m + 0.5 * spot_m);
  EXPECT_LT(seen_m(37), post_m + spot_m);
}

}  // namespace
}  // namespace adit
