// SPDX-License-Identifier: BSD-3-Clause
#include "eval/true_scans.h"

#include "base/error.h"

#include <cmath>
#include <string>

namespace adit {

TrueScans::TrueScans(const Truth& truth, const Mesh& mesh) : truth_(&truth), mesh_(&mesh) {
  if (truth.scans.size() != truth.rig.mounts.size())
    throw Error("the truth has " + std::to_string(truth.rig.mounts.size()) + " lasers but scans of " +
                std::to_string(truth.scans.size()));
  for (size_t l = 0; l < lasers(); ++l) {
    const ScanTruth& s = truth.scans[l];
    const size_t n = s.stamp_s.size() * static_cast<size_t>(mount(l).laser.beams);
    if (s.range_m.size() != n || s.label.size() != n || s.part.size() != n || s.incidence_rad.size() != n ||
        s.face.size() != n)
      throw Error("the truth of laser '" + mount(l).name + "' needs " + std::to_string(n) + " beams in every array (" +
                  std::to_string(s.stamp_s.size()) + " scans), its ranges are " + std::to_string(s.range_m.size()));
    if (n && truth.drive.path.empty()) throw Error("the truth has scans but no path");
  }
}

Pose TrueScans::X_WS(size_t laser, size_t scan) const {
  return truth_->drive.path.at(truth_->scans[laser].stamp_s[scan]) * truth_->scans[laser].X_BS(mount(laser), scan);
}

bool TrueScans::echoes(const LaserModel& laser, std::int32_t face, double range_m, double incidence_rad) const {
  if (face < 0 || range_m > laser.range_max_m) return false;
  if (mesh_->reflectivity.empty()) return true;
  return mesh_->reflectivity.at(static_cast<size_t>(face)) * std::cos(incidence_rad) >=
         laser.least_reflectivity(range_m);
}

TrueBeam TrueScans::beam(size_t laser, size_t scan, int k) const {
  const Mount& m = mount(laser);
  const ScanTruth& s = truth_->scans[laser];
  const size_t at = scan * static_cast<size_t>(m.laser.beams) + static_cast<size_t>(k);
  const double angle = m.laser.beam_angle_rad(k);
  const Pose X_WS = truth_->drive.path.at(s.stamp_s[scan] + m.laser.beam_offset_s(k)) * s.X_BS(m, scan);
  const double range_m = static_cast<double>(s.range_m[at]);
  return {X_WS.translation(),
          X_WS.linear() * Vec3(std::cos(angle), std::sin(angle), 0),
          range_m,
          static_cast<double>(s.incidence_rad[at]),
          s.face[at],
          echoes(m.laser, s.face[at], range_m, static_cast<double>(s.incidence_rad[at]))};
}

std::vector<TrueBeam> TrueScans::fan(size_t laser, size_t scan, int step) const {
  std::vector<TrueBeam> beams;
  for (int k = 0; k < mount(laser).laser.beams; k += step) beams.push_back(beam(laser, scan, k));
  return beams;
}

}  // namespace adit
