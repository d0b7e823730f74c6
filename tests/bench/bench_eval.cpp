// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "cli/scenario.h"
#include "eval/map_error.h"
#include "eval/path_error.h"
#include "eval/report.h"
#include "eval/scene.h"
#include "eval/volume_error.h"
#include "mapper/mapper.h"
#include "sim/sim.h"
#include "tests/bench/bench.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

namespace {

using namespace adit;
using namespace adit::bench;

constexpr std::uint64_t seed = 1;

// A mine of about half a million triangles, and a million points about its surface.
struct Cloud {
  Mesh mesh;
  MapPoints points;
};

Cloud cloud_about_bruceton(double far_share) {
  WorldSettings settings = load_scenario("bruceton").world;
  settings.mesh_edge_m = 0.3;
  Cloud c;
  c.mesh = make_world(settings, 1).mesh;
  constexpr size_t n = 1000000;
  std::vector<double> area{0};
  for (size_t f = 0; f < c.mesh.face.size(); ++f) area.push_back(area.back() + c.mesh.area(f));
  for (std::uint64_t i = 0; i < n; ++i) {
    const double at = uniform(seed, Draw::test, i, 0) * area.back();
    const size_t f = static_cast<size_t>(std::upper_bound(area.begin(), area.end(), at) - area.begin()) - 1;
    double u = uniform(seed, Draw::test, i, 1), v = uniform(seed, Draw::test, i, 2);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const Vec3 a = c.mesh.corner(f, 0);
    Vec3 p = a + u * (c.mesh.corner(f, 1) - a) + v * (c.mesh.corner(f, 2) - a);
    p += 0.02 * normal(seed, Draw::test, i, 3) * c.mesh.normal(f);
    if (uniform(seed, Draw::test, i, 4) < far_share) p += Vec3(0, 0, 10);
    c.points.p_M.push_back(p);
    c.points.seen_M.push_back(c.mesh.normal(f));
  }
  c.points.weight.assign(n, 1);
  return c;
}

// Floats, as its own binary formats keep them.
void write_for_cloudcompare(const Cloud& c, const std::string& folder) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : c.mesh.vertex) middle += v / static_cast<double>(c.mesh.vertex.size());
  PointCloud points;
  for (const Vec3& p : c.points.p_M) points.p.push_back(p - middle);
  write_points(folder + "/cloud.ply", points);
  Mesh mesh;
  mesh.face = c.mesh.face;
  for (const Vec3& v : c.mesh.vertex) mesh.vertex.push_back(v - middle);
  write_mesh(folder + "/mesh.ply", mesh);
}

// Seconds that CloudCompare itself says its distances took: both of its steps, files not counted.
double cloudcompare_seconds(const Cloud& c) {
  if (std::system("command -v CloudCompare >/dev/null 2>&1") != 0)
    throw Error("CloudCompare is not installed (ci/setup --peers)");
  const std::string folder = (std::filesystem::temp_directory_path() / "adit_bench_c2m").string();
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  write_for_cloudcompare(c, folder);
  const std::string words =
      "cd " + folder +
      " && QT_QPA_PLATFORM=offscreen CloudCompare -SILENT -AUTO_SAVE OFF -O cloud.ply -O mesh.ply "
      "-C2M_DIST >said.txt 2>&1";
  if (std::system(words.c_str()) != 0) throw Error("CloudCompare failed; see " + folder + "/said.txt");
  std::istringstream said(read_text(folder + "/said.txt"));
  double seconds = 0;
  int steps = 0;
  for (std::string line; std::getline(said, line);) {
    const size_t at = line.find("Time: ");
    if (line.find("istances]") == std::string::npos || at == std::string::npos) continue;
    seconds += std::strtod(line.c_str() + at + 6, nullptr);
    ++steps;
  }
  std::filesystem::remove_all(folder);
  if (steps != 2) throw Error("CloudCompare's words are not those of version 2.11: no times of its two steps");
  return seconds;
}

std::vector<Figure> against_cloudcompare(const std::string& name, double far_share) {
  const Cloud c = cloud_about_bruceton(far_share);
  const double theirs_s = cloudcompare_seconds(c);
  const Pose here = Pose::Identity();
  const Patches patches(c.mesh, 0.2, Pose::Identity());  // of recall; distances need none
  const double ours_s = best_seconds(2, [&] {
    const Surface surface(c.mesh);
    lay(
        c.points, [&](size_t) -> const Pose& { return here; }, surface, patches, nullptr);
  });
  char what[256];
  std::snprintf(what, sizeof what,
                "CloudCompare's seconds (%.2f) over ours (%.2f), tree built, with sign, side and label: %zu "
                "points, %.0f %% of them 10 m off, %zu triangles, %d threads",
                theirs_s, ours_s, c.points.size(), 100 * far_share, c.mesh.face.size(), threads());
  return {{name, theirs_s / ours_s, "ratio", "higher", what, static_cast<std::int64_t>(c.points.size())}};
}

// Association, alignment, all statistics of 500,000 poses; files are not counted.
std::vector<Figure> ate() {
  Trajectory truth, estimate;
  constexpr int n = 500000;
  for (int i = 0; i < n; ++i) {
    const double t = 0.01 * i;
    const Pose X = pose_of({20 * std::sin(0.01 * t), 30 * std::cos(0.007 * t), std::sin(t)}, 0.1 * t);
    truth.stamp_s.push_back(t);
    truth.X_WB.push_back(X);
    estimate.stamp_s.push_back(t + 0.004 * uniform(seed, Draw::test, static_cast<std::uint64_t>(i)));
    estimate.X_WB.push_back(X * pose_of({0.01 * normal(seed, Draw::test, static_cast<std::uint64_t>(i), 1), 0, 0}, 0));
  }
  std::vector<Figure> figures;
  for (const bool nearest : {true, false}) {
    const double seconds = best_seconds(2, [&] {
      std::vector<Metric> all;
      const PathMatch match =
          nearest ? associate_nearest(truth, estimate, 0.01) : associate(truth, estimate, Pose::Identity(), 0.5);
      add_ate(MetricList(all), pose_errors(match, align_se3(match).X_WM), "");
    });
    figures.push_back({nearest ? "ate_500k_s" : "ate_500k_interpolated_s", seconds, "s", "lower",
                       std::string("association of 500,000 poses (") + (nearest ? "nearest" : "interpolated") +
                           "), Umeyama, all statistics",
                       n});
  }
  return figures;
}

// Observable surface and domain of the volume for bruceton's whole drive, its mine and its scans being there.
std::vector<Figure> observable() {
  const Scenario s = load_scenario("bruceton");
  const World world = make_world(s.world, 1);
  const Vehicle vehicle = load_vehicle(s.vehicle);
  const Drive path = drive(world, plan_route(world, s.route, 1), vehicle, s.drive, 1);
  const Truth truth = record(world, path, load_rig(s.sensors), vehicle.hull, s.sensors, 1).truth;
  const Cost cost = cost_of([&] {
    const TrueScans scans(truth, world.mesh);
    const Patches patches(world.mesh, s.score.patch_m, truth.drive.path.X_WB.front());
    const Observable seen =
        observable_surface(patches, scans, world.mesh.face.size(), s.score.incidence_deg * std::acos(-1.0) / 180);
    volume_domain(world.mesh, patches, seen, scans, s.score, {});
  });
  const std::string what =
      "observable surface and volume's domain of bruceton with cart4; the mine and its recording are in "
      "memory and count to the peak";
  return {{"observable_bruceton_s", cost.wall_s, "s", "lower", what},
          {"observable_bruceton_gib", cost.peak_gib, "GiB", "lower", what}};
}

// 1920 x 1080 of a mine of a million triangles, from a mesh to pixels.
std::vector<Figure> picture() {
  WorldSettings settings = load_scenario("bruceton").world;
  settings.mesh_edge_m = 0.2;
  const Mesh mesh = make_world(settings, 1).mesh;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& v : mesh.vertex) middle += v / static_cast<double>(mesh.vertex.size());
  Camera camera;
  camera.target = middle;
  camera.eye = middle + Vec3(-20, -120, 150);
  camera.height_m = 230;
  camera.far_m = 600;
  const double seconds = best_seconds(3, [&] {
    Scene scene;
    scene.skins.push_back(skin_of(mesh, [](std::uint32_t, Label) { return rgb(0x9a938a); }));
    scene.skins.back().sides = Skin::Sides::inner;
    take_picture(scene, camera, 1920, 1080);
  });
  return {{"picture_1mtri_s", seconds, "s", "lower",
           "1920 x 1080, 2 x 2 samples a pixel, crevices darkened, of " + std::to_string(mesh.face.size()) +
               " triangles, normals and colours worked out anew",
           3}};
}

// The page of a whole run of bruceton, which is in memory.
std::vector<Figure> report() {
  const Scenario s = load_scenario("bruceton");
  const World world = make_world(s.world, 1);
  const Vehicle vehicle = load_vehicle(s.vehicle);
  const Drive path = drive(world, plan_route(world, s.route, 1), vehicle, s.drive, 1);
  const Recording recording = record(world, path, load_rig(s.sensors), vehicle.hull, s.sensors, 1);
  const Estimate estimate = make_map(recording.log, s.map);
  const Score score = score_map(world, recording.truth, recording.log.rig, estimate, s.score);
  const std::string folder = (std::filesystem::temp_directory_path() / "adit_bench_report").string();
  const Cost cost = cost_of([&] {
    write_report(folder, {world, recording.log, recording.truth, estimate, score, "", s.name}, s.report);
  });
  const auto bytes = static_cast<double>(std::filesystem::file_size(folder + "/index.html"));
  std::filesystem::remove_all(folder);
  const std::string what = "page and pictures of a run of bruceton, which is in memory and counts to the peak";
  return {{"report_bruceton_s", cost.wall_s, "s", "lower", what},
          {"report_bruceton_gib", cost.peak_gib, "GiB", "lower", what},
          {"report_bruceton_mb", bytes / 1e6, "MB", "lower", "the page, one file"}};
}

}  // namespace

int main(int argc, char** argv) {
  return run(
      argc, argv,
      {{{"c2m_vs_cloudcompare"}, [] { return against_cloudcompare("c2m_vs_cloudcompare", 0); }},
       {{"c2m_outliers_vs_cloudcompare"}, [] { return against_cloudcompare("c2m_outliers_vs_cloudcompare", 0.1); }},
       {{"ate_500k_s", "ate_500k_interpolated_s"}, ate},
       {{"observable_bruceton_s", "observable_bruceton_gib"}, observable},
       {{"picture_1mtri_s"}, picture},
       {{"report_bruceton_s", "report_bruceton_gib", "report_bruceton_mb"}, report}});
}
