// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"
#include "cli/console.h"
#include "cli/scenario.h"
#include "cli/stages.h"
#include "sensors/sweep.h"
#include "tests/bench/bench.h"
#include "tests/bench/raw_rays.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace {

using namespace adit;
using namespace adit::bench;

// Bruceton at the edge length that gives some 0.75 million triangles.
const World& mine() {
  static const World world = [] {
    Scenario s = load_scenario("bruceton");
    s.world.mesh_edge_m = 0.25;
    return make_world(s.world, 1);
  }();
  return world;
}

// Down the middle of one passage after the other at 0.7 m/s, level.
Drive middle_drive(double seconds) {
  Drive drive;
  for (const Passage& passage : mine().passages)
    for (size_t i = 1; i < passage.centre_line.size(); ++i) {
      const Vec3 a = passage.centre_line[i - 1], b = passage.centre_line[i];
      const int steps = std::max(1, static_cast<int>((b - a).norm() / 0.7 * 120));
      for (int k = 0; k < steps; ++k) {
        drive.path.stamp_s.push_back(static_cast<double>(drive.path.size()) / 120);
        drive.path.X_WB.push_back(pose_of(a + (b - a) * k / steps, std::atan2(b.y() - a.y(), b.x() - a.x())));
        if (drive.path.stamp_s.back() > seconds) return drive;
      }
    }
  return drive;
}

struct Timed {
  double sweep_s = 0, raw_s = 0;
  size_t rays = 0;
};

// One laser on one thread, and Embree alone on the rays that it fires.
Timed time_laser(const SensorSettings& settings, const Mount& mount, const Caster& caster, const Drive& drive) {
  const Hull nothing;
  const Sweep sweep(caster, drive.path, mount, 0, nothing, settings, 0, 1);
  ScanTruth truth;
  for (Beat beat(mount, 0, 0, settings, 1); beat.time_s() + beat.scan_s() <= drive.path.stamp_s.back(); beat.next())
    truth.stamp_s.push_back(beat.time_s());
  const size_t scans = truth.stamp_s.size(), beams = static_cast<size_t>(mount.laser.beams), n = scans * beams;
  Scans log;
  log.beams = mount.laser.beams;
  log.range_m.resize(n), log.code.resize(n);
  truth.range_m.resize(n), truth.label.resize(n), truth.part.resize(n), truth.incidence_rad.resize(n);
  truth.face.resize(n), truth.passage.resize(n), truth.surfaces.resize(n), truth.fault.resize(n);
  const Bundle bundle = make_bundle(settings.sub_rays);
  std::vector<Ray> rays;
  for (size_t i = 0; i < scans; ++i)
    for (size_t k = 0; k < beams; ++k) {
      const double a = mount.laser.beam_angle_rad(static_cast<int>(k));
      const Pose X = drive.path.at(truth.stamp_s[i] + mount.laser.beam_offset_s(static_cast<int>(k))) * mount.X_BS;
      const Vec3 across = X.linear() * Vec3(-std::sin(a), std::cos(a), 0), above = X.linear().col(2);
      const Ray axis{X.translation(), X.linear() * Vec3(std::cos(a), std::sin(a), 0)};
      for (size_t j = 0; j < bundle.place.size(); ++j)
        rays.push_back(spot_ray(axis, across, above, mount.laser, bundle, j));
    }
  Timed timed{.rays = rays.size()};
  // In turns, so that what else the machine does meets both.
  for (int turn = 0; turn < 3; ++turn) {
    const double raw_s = raw_seconds(mine().mesh, rays, 1),
                 sweep_s = best_seconds(1, [&] { sweep.fire(0, scans, 0, log, truth); });
    if (turn == 0 || raw_s < timed.raw_s) timed.raw_s = raw_s;
    if (turn == 0 || sweep_s < timed.sweep_s) timed.sweep_s = sweep_s;
  }
  return timed;
}

std::vector<Figure> against_raw(const std::string& name, const std::string& model, int sub_rays, double seconds) {
  SensorSettings settings;
  settings.beam_angle_deg = settings.late = settings.jitter_s = 0;  // the same rays, known beforehand
  settings.sub_rays = sub_rays;
  settings.range_curve = settings.energy = settings.warm_up = sub_rays > 1;
  const Caster caster(mine().mesh);
  const Drive drive = middle_drive(seconds);
  Timed sum;
  Rig rig = load_rig("cart4", 500000);
  for (Mount& mount : rig.mounts) {
    mount.laser = load_laser(model, 500000);
    mount.laser.sigma_m = std::max(mount.laser.sigma_m, 0.005);  // of an ideal one too, or no noise would be drawn
    const Timed t = time_laser(settings, mount, caster, drive);
    sum.sweep_s += t.sweep_s;
    sum.raw_s += t.raw_s;
    sum.rays += t.rays;
  }
  return {{name, sum.raw_s / sum.sweep_s, "ratio", "higher",
           "rays a second of the scans of " + model + " with noise and labels, " + std::to_string(sub_rays) +
               " rays a beam, to those of bare rtcIntersect16 on the same rays; one thread, four lasers of cart4, " +
               std::to_string(mine().mesh.face.size()) + " triangles",
           static_cast<std::int64_t>(sum.rays)}};
}

// The drive stage of bruceton: vehicle, lasers, files, streamed as `adit drive` does it.
std::vector<Figure> drive_stage(const std::string& name, int baud, int sub_rays) {
  Scenario s = load_scenario("bruceton");
  s.sensors.baud = baud;
  s.sensors.sub_rays = sub_rays;
  const World world = make_world(s.world, 1);
  const std::string dir = (std::filesystem::temp_directory_path() / ("adit_bench_" + name)).string();
  Console console(true, false);
  Stages stages(dir, console);
  double driven_s = 0;
  const double wall_s = best_seconds(1, [&] { driven_s = stages.drive(s, world, nullptr).drive.path.stamp_s.back(); });
  std::filesystem::remove_all(dir);
  return {{name, driven_s / wall_s, "ratio", "higher",
           "bruceton with cart4 at " + std::to_string(baud) + " Bd, " + std::to_string(sub_rays) +
               " rays a beam, vehicle, lasers and files: driven seconds a second, " + std::to_string(threads()) +
               " threads"}};
}

// What a second thread is worth to the lasers alone.
std::vector<Figure> two_threads() {
  SensorSettings settings;
  settings.sub_rays = 19;
  const Drive drive = middle_drive(120);
  const Rig rig = load_rig("cart4", 38400);
  double one_s = 0, two_s = 0;
  for (int turn = 0; turn < 3; ++turn) {
    const auto seconds = [&](int threads) {
      set_threads(threads);
      return best_seconds(1, [&] { record(mine(), drive, rig, {}, settings, 1); });
    };
    const double one = seconds(1), two = seconds(2);
    if (turn == 0 || one < one_s) one_s = one;
    if (turn == 0 || two < two_s) two_s = two;
  }
  set_threads(0);
  return {{"record_2_threads", one_s / two_s, "ratio", "higher",
           "seconds of 120 s of cart4 with 19 rays a beam on one thread to those on two, with the mine's tree"}};
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {{{"rays_ideal_vs_raw"}, [] { return against_raw("rays_ideal_vs_raw", "ideal", 1, 60); }},
              {{"rays_lms_vs_raw"}, [] { return against_raw("rays_lms_vs_raw", "lms200", 19, 10); }},
              {{"drive_rtf"}, [] { return drive_stage("drive_rtf", 38400, 1); }},
              {{"drive_rtf_500k"}, [] { return drive_stage("drive_rtf_500k", 500000, 1); }},
              {{"drive_rtf_spot"}, [] { return drive_stage("drive_rtf_spot", 38400, 19); }},
              {{"record_2_threads"}, two_threads}});
}
