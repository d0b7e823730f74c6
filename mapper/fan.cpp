// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/fan.h"

#include <cmath>

namespace adit {

std::vector<FanBeam> fan_of(const Log& log, int laser, size_t scan, const Trajectory& X_MB, int step) {
  const Mount& mount = log.rig.mounts[laser];
  const Scans& scans = log.scans[laser];
  const LaserModel& model = mount.laser;
  const Pose X_BS = scans.X_BS(mount, scan);
  const double stamp_s = scans.stamp_s[scan];
  struct Turn {
    double start_s, end_s;
    Pose start, end;
  };
  std::vector<Turn> turns;
  const int interlace = std::max(1, model.interlace);
  for (int t = 0; t < interlace; ++t) {
    const int last = (scans.beams - 1 - t) / interlace * interlace + t;
    const double start_s = stamp_s + model.beam_offset_s(t), end_s = stamp_s + model.beam_offset_s(last);
    turns.push_back({start_s, end_s, X_MB.at(start_s) * X_BS, X_MB.at(end_s) * X_BS});
  }
  std::vector<FanBeam> fan;
  fan.reserve(scans.beams / step + 1);
  const auto range_m = scans[scan];
  for (int k = 0; k < scans.beams; k += step) {
    const Turn& turn = turns[k % interlace];
    const double at_s = stamp_s + model.beam_offset_s(k);
    const double s = turn.end_s > turn.start_s ? (at_s - turn.start_s) / (turn.end_s - turn.start_s) : 0;
    const double angle = model.beam_angle_rad(k);
    const Vec3 p_S(range_m[k] * std::cos(angle), range_m[k] * std::sin(angle), 0);
    const Vec3 origin = (1 - s) * turn.start.translation() + s * turn.end.translation();
    // Rotations a few hundredths of a degree apart: a blend of the matrices is orthogonal to 1e-7.
    const Vec3 ray = (1 - s) * (turn.start.linear() * p_S) + s * (turn.end.linear() * p_S);
    fan.push_back({origin, origin + ray, range_m[k]});
  }
  return fan;
}

std::vector<size_t> covered_scans(const Log& log, int laser, const Trajectory& X_MB) {
  const Scans& scans = log.scans[laser];
  const LaserModel& model = log.rig.mounts[laser].laser;
  double lasts_s = 0;
  for (int k = std::max(0, scans.beams - model.interlace - 1); k < scans.beams; ++k)
    lasts_s = std::max(lasts_s, model.beam_offset_s(k));
  std::vector<size_t> covered;
  for (size_t n = 0; n < scans.size(); ++n)
    if (X_MB.covers(scans.stamp_s[n]) && X_MB.covers(scans.stamp_s[n] + lasts_s)) covered.push_back(n);
  return covered;
}

}  // namespace adit
