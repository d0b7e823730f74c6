// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/volume.h"

#include "base/parallel.h"
#include "mapper/fan.h"
#include "mapper/stretches.h"
#include "mapper/surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_set>

namespace adit {
namespace {

/// A scan that bounds the void on one side of a wedge.
struct Section {
  size_t scan;
  Pose X_MS;  // of its first beam
};

/// Scans of a laser at least section_m apart, or turned by 2 degrees, be it by a nodding mount.
std::vector<Section> sections_of(const Log& log, int laser, const Trajectory& X_MB, const VolumeSettings& settings) {
  constexpr double turn_rad = 2 * std::numbers::pi / 180;
  std::vector<Section> sections;
  for (const size_t scan : covered_scans(log, laser, X_MB)) {
    const Scans& scans = log.scans[laser];
    const Pose X_MS = X_MB.at(scans.stamp_s[scan]) * scans.X_BS(log.rig.mounts[laser], scan);
    if (!sections.empty()) {
      const Pose step = sections.back().X_MS.inverse() * X_MS;
      if (step.translation().norm() < settings.section_m && Eigen::AngleAxisd(step.linear()).angle() < turn_rad)
        continue;
    }
    sections.push_back({scan, X_MS});
  }
  return sections;
}

bool joined(const Section& a, const Section& b, const VolumeSettings& settings) {
  constexpr double most_turn_rad = 20 * std::numbers::pi / 180;
  const Pose step = a.X_MS.inverse() * b.X_MS;
  return step.translation().norm() <= settings.section_gap_m &&
         Eigen::AngleAxisd(step.linear()).angle() <= most_turn_rad;
}

Vec3 shortened(const FanBeam& beam, double range_m) {
  return beam.range_m <= range_m ? beam.end : Vec3(beam.origin + (beam.end - beam.origin) * (range_m / beam.range_m));
}

/// Between equal triangles (apex, end, end) of two fans. Thinner ones, as of a fan that moves within its own plane, would
/// fill whole columns with next to nothing.
bool is_sheet(const std::array<Tetrahedron, 3>& wedge, double thin_m) {
  const auto area = [](const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a).norm() / 2; };
  const double sides =
      std::max(area(wedge[0][0], wedge[0][1], wedge[0][2]), area(wedge[2][1], wedge[2][2], wedge[2][3]));
  return !(enclosed_volume(wedge[0]) + enclosed_volume(wedge[1]) + enclosed_volume(wedge[2]) > thin_m * sides);
}

/// The wedge between beams k and k + 1 of the sections a and b as three tetrahedra.
void add_wedge(const std::vector<FanBeam>& a, const std::vector<FanBeam>& b, size_t k, const VolumeSettings& settings,
               std::vector<Tetrahedron>& into) {
  const std::array<double, 4> ranges = {a[k].range_m, a[k + 1].range_m, b[k].range_m, b[k + 1].range_m};
  for (const double r : ranges)
    if (!std::isfinite(r) || r > settings.range_m) return;
  const auto [nearest, farthest] = std::minmax_element(ranges.begin(), ranges.end());
  const double end_m = *farthest - *nearest > settings.jump_m + 0.2 * *nearest ? *nearest : *farthest;
  const Vec3 a0 = shortened(a[k], end_m), a1 = shortened(a[k + 1], end_m);
  const Vec3 b0 = shortened(b[k], end_m), b1 = shortened(b[k + 1], end_m);
  const Vec3 &o = a[a.size() / 2].origin, &p = b[b.size() / 2].origin;  // one apex for the whole fan: no slits inside
  const std::array<Tetrahedron, 3> wedge = {{{o, a0, a1, b1}, {o, a0, b0, b1}, {o, p, b0, b1}}};
  if (!is_sheet(wedge, settings.cell_m / 4)) into.insert(into.end(), wedge.begin(), wedge.end());
}

/// Adds what one laser swept.
void add_swept(const Log& log, int laser, const Trajectory& X_MB, const VolumeSettings& settings, DexelUnion& solid,
               const Progress& progress) {
  const std::vector<Section> sections = sections_of(log, laser, X_MB, settings);
  constexpr size_t batch = 200;
  for (size_t begin = 0; begin + 1 < sections.size(); begin += batch) {
    const size_t end = std::min(sections.size() - 1, begin + batch);
    std::vector<std::vector<FanBeam>> fans(end - begin + 1);
    parallel_for(fans.size(),
                 [&](size_t n) { fans[n] = fan_of(log, laser, sections[begin + n].scan, X_MB, settings.beam_step); });
    std::vector<std::vector<Tetrahedron>> wedges(fans.size() - 1);
    parallel_for(wedges.size(), [&](size_t n) {
      if (joined(sections[begin + n], sections[begin + n + 1], settings))
        for (size_t k = 0; k + 1 < fans[n].size(); ++k) add_wedge(fans[n], fans[n + 1], k, settings, wedges[n]);
    });
    std::vector<Tetrahedron> all;
    for (const auto& some : wedges) all.insert(all.end(), some.begin(), some.end());
    solid.add(all);
    progress("carve " + log.rig.mounts[laser].name, static_cast<double>(end), static_cast<double>(sections.size() - 1));
  }
}

/// The box in plan that the echoes and the path fill.
Dexels columns_around(const Log& log, const std::vector<int>& lasers, const Trajectory& X_MB,
                      const VolumeSettings& settings) {
  Eigen::AlignedBox2d all;
  for (const int laser : lasers) {
    const std::vector<size_t> scans = covered_scans(log, laser, X_MB);
    std::vector<Eigen::AlignedBox2d> boxes(scans.size());
    parallel_for(
        scans.size(),
        [&](size_t n) {
          for (const FanBeam& beam : fan_of(log, laser, scans[n], X_MB, settings.beam_step)) {
            boxes[n].extend(Vec2(beam.origin.head<2>()));
            if (std::isfinite(beam.range_m) && beam.range_m <= settings.range_m)
              boxes[n].extend(Vec2(beam.end.head<2>()));
          }
        },
        64);
    for (const auto& box : boxes) all.extend(box);
  }
  if (all.isEmpty()) return empty_dexels(Vec2::Zero(), Vec2::Zero(), settings.cell_m);
  return empty_dexels(all.min(), all.max(), settings.cell_m);
}

/// Fills gaps in height up to gap_m.
Dexels closed(const Dexels& solid, double gap_m) {
  Dexels result = solid;
  result.interval.clear();
  for (size_t c = 0; c < solid.columns(); ++c) {
    const size_t first = result.interval.size();
    for (const Interval& s : solid.column(c)) {
      if (result.interval.size() > first && s.low_m - result.interval.back().high_m <= gap_m)
        result.interval.back().high_m = s.high_m;
      else
        result.interval.push_back(s);
    }
    result.offset[c + 1] = static_cast<std::uint32_t>(result.interval.size());
  }
  return result;
}

/// The lasers of the views given, none where the rig has no upward one.
std::vector<int> lasers_of(const Rig& rig, std::initializer_list<View> views) {
  std::vector<int> lasers;
  if (find_view(rig, View::up) < 0) return lasers;
  for (const View view : views)
    if (const int laser = find_view(rig, view); laser >= 0) lasers.push_back(laser);
  return lasers;
}

std::vector<int> carving_lasers(const Rig& rig) {
  return lasers_of(rig, {View::up, View::down, View::forward_vertical, View::horizontal});
}

/// Those whose echoes bound nearly all of the surface.
std::vector<int> bounding_lasers(const Rig& rig) {
  return lasers_of(rig, {View::up, View::down});
}

/// Of the constant errors of two lasers, m^2.
double bias_variance(const Log& log, int a, int b, const Eigen::MatrixXd& given) {
  if (given.size() > 0) return given(a, b);
  return a == b ? std::pow(log.rig.mounts[a].laser.bias_m, 2) / 3 : 0;
}

/// Variance by the lasers' constant errors of a volume of 1 m3 with its share of the surface: the upward and the downward
/// laser saw half of it each.
double relative_variance(const Log& log, const Mesh& surface, double volume_m3, const Eigen::MatrixXd& given) {
  const std::vector<int> lasers = bounding_lasers(log.rig);
  double area_m2 = 0;
  for (size_t f = 0; f < surface.face.size(); ++f) area_m2 += surface.area(f);
  const double seen = volume_m3 > 0 ? area_m2 / volume_m3 / static_cast<double>(lasers.size()) : 0;
  double variance = 0;
  for (const int a : lasers)
    for (const int b : lasers) variance += seen * seen * bias_variance(log, a, b, given);
  return variance;
}

double sigma_of(double volume_m3, double relative_variance, const VolumeSettings& settings) {
  const double common = relative_variance + std::pow(settings.common_percent / 100, 2);
  return std::sqrt(common * volume_m3 * volume_m3 + std::pow(settings.local_sigma, 2) * volume_m3);
}

}  // namespace

Fields fields(VolumeSettings& s) {
  return {
      {"cell_m", &s.cell_m, "edge of the columns on which the void is united", 0.01, 1},
      {"surface_cells", &s.surface_cells, "columns along the edge of a voxel of the surface", 1, 20},
      {"beam_step", &s.beam_step, "every beam_step-th beam bounds the void", 1, 60},
      {"section_m", &s.section_m, "least way between two sections", 0, 1},
      {"section_gap_m", &s.section_gap_m, "most way between two sections that are joined", 0.01, 5},
      {"jump_m", &s.jump_m, "neighbouring ranges that differ by more, plus a fifth, are two surfaces", 0, 100},
      {"close_m", &s.close_m, "gaps in height up to this are filled", 0, 1},
      {"range_m", &s.range_m, "farther echoes bound nothing", 0.1, 1000},
      {"point_voxel_m", &s.point_voxel_m, "one point a voxel of this edge", 0.001, 10},
      {"common_percent", &s.common_percent, "sd of the volume that is the same everywhere", 0, 100},
      {"local_sigma", &s.local_sigma, "sd of the volume of a cubic metre, growing with the root of the volume", 0, 10},
      {"end_sigma_m3", &s.end_sigma_m3, "sd of a stretch's volume by where it begins and ends", 0, 1000}};
}

PointCloud map_points(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings,
                      const Eigen::MatrixXd& bias_covariance) {
  struct Scan {
    double stamp_s;
    int laser;
    size_t scan;
  };
  std::vector<Scan> scans;
  for (const View view : {View::up, View::down, View::forward_vertical})
    if (const int laser = find_view(log.rig, view); laser >= 0)
      for (const size_t n : covered_scans(log, laser, X_MB)) scans.push_back({log.scans[laser].stamp_s[n], laser, n});
  std::stable_sort(scans.begin(), scans.end(), [](const Scan& a, const Scan& b) { return a.stamp_s < b.stamp_s; });
  std::vector<double> sigma_m;  // (lasers)
  for (size_t m = 0; m < log.rig.mounts.size(); ++m)
    sigma_m.push_back(std::sqrt(std::pow(log.rig.mounts[m].laser.sigma_m, 2) +
                                bias_variance(log, static_cast<int>(m), static_cast<int>(m), bias_covariance)));
  PointCloud cloud;
  std::unordered_set<std::uint64_t> taken;  // asked only, never walked: its order is not in the result
  constexpr size_t batch = 512;
  for (size_t begin = 0; begin < scans.size(); begin += batch) {
    std::vector<std::vector<FanBeam>> fans(std::min(batch, scans.size() - begin));
    parallel_for(fans.size(),
                 [&](size_t n) { fans[n] = fan_of(log, scans[begin + n].laser, scans[begin + n].scan, X_MB); });
    for (size_t n = 0; n < fans.size(); ++n) {
      const Scan& scan = scans[begin + n];
      const LaserModel& model = log.rig.mounts[scan.laser].laser;
      for (size_t k = 0; k < fans[n].size(); ++k) {
        if (!std::isfinite(fans[n][k].range_m)) continue;
        std::uint64_t key = 0;
        for (int axis = 0; axis < 3; ++axis)
          key = key << 21 |
                (static_cast<std::uint64_t>(std::llround(fans[n][k].end[axis] / settings.point_voxel_m)) & 0x1fffff);
        if (!taken.insert(key).second) continue;
        cloud.p.push_back(fans[n][k].end);
        cloud.stamp_s.push_back(scan.stamp_s + model.beam_offset_s(static_cast<int>(k)));
        cloud.laser.push_back(static_cast<std::uint8_t>(scan.laser));
        cloud.sigma_m.push_back(static_cast<float>(sigma_m[scan.laser]));
      }
    }
  }
  return cloud;
}

Dexels swept_void(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings, const Progress& progress) {
  const std::vector<int> lasers = carving_lasers(log.rig);
  DexelUnion solid(columns_around(log, lasers, X_MB, settings));
  for (const int laser : lasers) add_swept(log, laser, X_MB, settings, solid, progress);
  return closed(solid.solid(), settings.close_m);
}

MappedVoid map_void(const Log& log, const Trajectory& X_MB, const VolumeSettings& settings, const Progress& progress,
                    const Eigen::MatrixXd& bias_covariance) {
  if (carving_lasers(log.rig).empty()) return {};
  MappedVoid mapped;
  mapped.solid = swept_void(log, X_MB, settings, progress);
  mapped.surface = boundary_of(mapped.solid, settings.surface_cells);
  mapped.volume_m3 = enclosed_volume(mapped.surface);
  mapped.relative_variance = relative_variance(log, mapped.surface, *mapped.volume_m3, bias_covariance);
  mapped.volume_sigma_m3 = sigma_of(*mapped.volume_m3, mapped.relative_variance, settings);
  return mapped;
}

std::vector<VolumePart> volume_parts(const MappedVoid& mapped, const Trajectory& X_MB, const VolumeSettings& settings) {
  const Dexels& solid = mapped.solid;
  if (solid.interval.empty()) return {};
  const Stretches stretches(X_MB);
  std::vector<std::vector<double>> of_row(solid.height, std::vector<double>(stretches.all().size(), 0));
  parallel_for(
      of_row.size(),
      [&](size_t j) {
        for (int i = 0; i < solid.width; ++i) {
          double height_m = 0;
          for (const Interval& s : solid.column(i, static_cast<int>(j))) height_m += s.high_m - s.low_m;
          if (height_m > 0) of_row[j][stretches.nearest(solid.axis(i, static_cast<int>(j)))] += height_m;
        }
      },
      16);
  // The surface rounds the columns' edges; what it loses there it loses everywhere alike.
  const double share = *mapped.volume_m3 / solid.volume_m3();
  std::vector<VolumePart> parts;
  for (size_t k = 0; k < stretches.all().size(); ++k) {
    const Stretch& s = stretches.all()[k];
    double height_m = 0;
    for (const auto& row : of_row) height_m += row[k];
    const double volume_m3 = share * height_m * solid.cell_m * solid.cell_m;
    parts.push_back({s.from_s, s.to_s, s.length_m, volume_m3,
                     std::hypot(sigma_of(volume_m3, mapped.relative_variance, settings), settings.end_sigma_m3)});
  }
  return parts;
}

}  // namespace adit
