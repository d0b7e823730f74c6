// SPDX-License-Identifier: BSD-3-Clause
// What the page shows in space.
#include "eval/page_space.h"

#include "eval/packed.h"
#include "eval/thinned.h"

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

constexpr size_t most_faces = 110000;
constexpr int moments = 160, beams_each = 40;

SpaceMesh packed_mesh(const ThinMesh& thin, const Raster& raster, const Ramp* ramp) {
  SpaceMesh mesh{thin.vertex.size(), thin.face.size(), thin.roof, ramp != nullptr, {}};
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<std::uint16_t> values;
    for (const Vec3& p : thin.vertex) values.push_back(raster.at(p[axis], axis));
    mesh.bytes += delta_bytes(values, 1);
  }
  for (size_t v = 0; ramp && v < thin.value.size(); ++v) {
    const double s = (thin.value[v] - ramp->low) / (ramp->high - ramp->low);
    mesh.bytes += static_cast<char>(std::isnan(s) ? 255 : std::lround(254 * std::clamp(s, 0.0, 1.0)));
  }
  std::vector<std::uint32_t> corners;
  for (const auto& f : thin.face) corners.insert(corners.end(), f.begin(), f.end());
  mesh.bytes += delta_bytes(corners, 1);
  return mesh;
}

// The scan of a laser that begins nearest to a time; -1 where there is none within half a second.
std::ptrdiff_t scan_at(const Scans& scans, double t_s) {
  const auto next = std::lower_bound(scans.stamp_s.begin(), scans.stamp_s.end(), t_s);
  std::ptrdiff_t best = next - scans.stamp_s.begin();
  const auto n = static_cast<std::ptrdiff_t>(scans.size());
  if (best == n || (best > 0 && t_s - scans.stamp_s[best - 1] < scans.stamp_s[best] - t_s)) --best;
  return best >= 0 && std::abs(scans.stamp_s[best] - t_s) < 0.5 ? best : -1;
}

void add_place(std::vector<std::uint16_t>& list, const Raster& raster, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis) list.push_back(raster.at(p[axis], axis));
}

}  // namespace

bool Raster::holds(const Vec3& p) const {
  return ((p - low).array() >= 0).all() && ((p - low).array() <= most * step_m).all();
}

std::uint16_t Raster::at(double value, int axis) const {
  return static_cast<std::uint16_t>(std::lround(std::clamp((value - low[axis]) / step_m, 0.0, most)));
}

Raster raster_of(const Exhibit& x) {
  Vec3 low = Vec3::Constant(1e30), high = Vec3::Constant(-1e30);
  const auto take = [&](const Vec3& p) {
    if (!p.allFinite()) return;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  for (const Vec3& p : x.input.world.mesh.vertex) take(p);
  for (const Vec3& p : x.surface_W.vertex) take(p);
  for (const Pose& X : x.path_W.X_WB) take(X.translation());
  for (const Pose& X : x.input.truth.drive.path.X_WB) take(X.translation());
  if (low.x() > high.x()) return {};
  return {low, std::max(1e-3, (high - low).maxCoeff() / Raster::most)};
}

SpaceMesh map_in_space(const Exhibit& x, const Raster& raster) {
  return packed_mesh(thinned(x.surface_W, x.surface_error_m, most_faces), raster, &x.ramp);
}

SpaceMesh mine_in_space(const Exhibit& x, const Raster& raster) {
  return packed_mesh(thinned(x.input.world.mesh, {}, most_faces), raster, nullptr);
}

SpaceBeams beams_in_space(const Exhibit& x, const Raster& raster) {
  SpaceBeams all;
  const Log& log = x.input.log;
  const Trajectory& path = x.path_W;
  if (path.size() < 2 || log.scans.empty()) return all;
  const std::vector<double> along = distance_along(path);
  for (int k = 0; k < moments; ++k) {
    const double wanted = along.back() * (k + 0.5) / moments;
    const size_t i = std::lower_bound(along.begin(), along.end(), wanted) - along.begin();
    const double t = path.stamp_s[std::min(i, path.size() - 1)];
    all.stamp_s.push_back(t);
    for (size_t m = 0; m < log.rig.mounts.size(); ++m) {
      const Mount& mount = log.rig.mounts[m];
      const std::ptrdiff_t scan = m < log.scans.size() ? scan_at(log.scans[m], t) : -1;
      const Pose X_WS = path.at(t) * (scan < 0 ? mount.X_BS : log.scans[m].X_BS(mount, scan));
      add_place(all.from, raster, X_WS.translation());
      std::uint16_t n = 0;
      const int beams = scan < 0 ? 0 : log.scans[m].beams, step = std::max(1, beams / beams_each);
      for (int b = 0; b < beams; b += step) {
        const double range = log.scans[m][scan][b], a = mount.laser.beam_angle_rad(b);
        if (!(range > 0.1 && range < 60)) continue;
        const Vec3 p = X_WS * Vec3(range * std::cos(a), range * std::sin(a), 0);
        if (!raster.holds(p)) continue;
        add_place(all.to, raster, p);
        ++n;
      }
      all.count.push_back(n);
    }
  }
  return all;
}

}  // namespace adit
