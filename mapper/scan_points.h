// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/recording.h"
#include "mapper/stance.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

namespace adit {

/// What of a horizontal scan is taken for ribs, and how their directions are fitted.
struct ScanPointSettings {
  double range_min_m = 0.3;
  double range_max_m = 14;  // on pitching ground a horizontal beam meets floor or roof beyond
  double fit_half_m = 0.6;  // longest reach of a line fit to either side of a point
  double fit_sigmas = 1.6;  // a fit is taken while its rms residual is below so many sigma
  double graze_deg = 4;     // beams that meet a rib more flatly than this do not join it
};
Fields fields(ScanPointSettings& s);

/// The ribs that one scan saw, in B at the scan's stamp, in the order of the beams. Only points that lie on a line of
/// neighbouring beams: no-echo, drop-outs and mixed pixels (a beam half on either side of an edge) are left out.
struct ScanPoints {
  std::vector<Vec2> p_B;       // (n)
  std::vector<Vec2> normal_B;  // (n) unit, towards the laser
  std::vector<double>
      sigma_m;  // (n) of the point along its normal, 1 sd: laser noise and what the line does not explain
  std::vector<double> sigma_normal_rad;  // (n) of the normal's direction, 1 sd, by laser noise alone
  std::vector<double> z_m;               // (n) height in M; 0 where the laser's stance is not known
  std::vector<std::int32_t> beam;        // (n)

  size_t size() const { return p_B.size(); }
  void reserve(size_t n);
};

/// Motion of the body while a scan is taken: constant speed in B, per second.
struct Twist2 {
  double x_m_s = 0, y_m_s = 0, yaw_rad_s = 0;
};

/// The motion that takes dt_s from identity to X.
Twist2 twist_of(const Pose2& X, double dt_s);
/// Pose after dt_s of that motion, along an arc.
Pose2 pose_after(const Twist2& twist, double dt_s);

/// The beams of a mounted laser, level, in B: made once, used for every scan.
struct BeamFan {
  Vec2 origin_B = Vec2::Zero();
  std::vector<Vec2> direction_B;  // (beams) in plan; shorter than 1 where the mount tilts a beam
  std::vector<Vec2> direction_S;  // (beams) in the plane of the scan
  std::vector<double> offset_s;   // (beams) after the stamp
  double step_rad = 0;            // between neighbours
  double sigma_m = 0;             // of one range, 1 sd

  double scan_s() const { return offset_s.empty() ? 0 : *std::max_element(offset_s.begin(), offset_s.end()); }
};
BeamFan fan_of(const Mount& mount);

/// Points of one scan, each beam taken back to the stamp by the motion. @param range_m (beams of the fan)
/// @param stance  of the laser, if it is known; else its beams count as the fan has them, all at one height
ScanPoints scan_points(std::span<const float> range_m, const BeamFan& fan, const Twist2& twist,
                       const ScanPointSettings& settings, const Stance* stance = nullptr);

/// All scans, undone by the motion that the poses X_MB (one a scan) tell. Parallel.
/// @param stances  one a scan, or none
std::vector<ScanPoints> scan_points(const Scans& scans, const Mount& mount, const std::vector<Pose2>& X_MB,
                                    const ScanPointSettings& settings = {}, const std::vector<Stance>& stances = {});
/// The motion at each scan as told by poses: from the scan before to the scan after, the ends one-sided. (n)
std::vector<Twist2> twists_of(const std::vector<double>& stamp_s, const std::vector<Pose2>& X_MB);

}  // namespace adit
