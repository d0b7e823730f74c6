// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/estimate.h"
#include "base/progress.h"
#include "base/recording.h"
#include "mapper/match.h"
#include "mapper/scan_points.h"

#include <Eigen/Core>

#include <vector>

namespace adit {

/// Motion from the scans of one horizontal laser alone.
struct Odometry {
  std::vector<double> stamp_s;  // (n) one per scan
  std::vector<Pose2> X_MB;      // (n) chained steps, first = identity
  std::vector<Pose2> X_step;    // (n) X_step[i] = pose of body i in body i-1; [0] unused, identity
  std::vector<Eigen::Matrix3d>
      information;  // (n) of X_step, about frame B_i: of the error e in X_true = X_step * (ex, ey, eyaw)
  std::vector<Eigen::Matrix3d>
      jitter;  // (n) covariance of each pose about the map that it was matched to, in its frame
  std::vector<DegenerateStretch> degenerate;
  double steadiness = 1;       // how many times too wide the variances are that the steps add up to over a long way
  bool uneven = false;         // ribs were: matched with their own sigma
  double rib_sigma_m = 0;      // of the ribs that were matched, 1 sd: the median over the scans
  int lost = 0;                // scans that no match could place: their step is the prediction
  std::vector<size_t> breaks;  // rising; scans after a gap that nothing connects to those before it
};

struct OdometrySettings {
  ScanPointSettings points;
  MatchSettings match;
  int key_scans = 40;       // of the past that make the local map
  double key_step_m = 0.2;  // a scan this far from the last key scan is a new one
  double key_step_deg = 10;
  double speed_change_m_s2 = 0.5;  // 1 sd of the change of speed, for the prediction
  double turn_change_deg_s2 = 40;
  double speed_spread_m_s = 0.2;  // of the speed about its mean, 1 sd: what degenerate stretches may be wrong by
  double new_share = 0.1;         // of a scan's points not on the map, for it to be a new key scan
  double information_scale = 1;   // of a step against that of its match
  double uneven_from = 1.5;       // times match.map_sigma_m: ribs beyond that are uneven
  double uneven_range_m = 20;     // points.range_max_m there, if that is less: what is far holds the heading
  double steadiness = 8;          // see Odometry; where ribs are even
  double search_m = 0.6;          // half width of the search when the refiner fails
  double search_deg = 25;
  double most_speed_m_s = 3;  // a faster match is a wrong one
};
Fields fields(OdometrySettings& s);

/// What is other where scans are matched in space: a beam that met floor or roof lies at another height than the ribs, and
/// spoils less; what a scan adds to the map is at a height of its own.
struct SpaceSettings {
  bool use = true;
  double range_max_m = 20;  // in place of points.range_max_m, if that is less
  double key_step_m = 0.15;
  int key_scans = 50;
  double steadiness = 12;
};
Fields fields(SpaceSettings& s);

/// How a log is matched in space. Where its first path found uneven ribs neighbouring scans err alike, whatever they look like
/// once they are in space: nothing is steadier there than its scans.
OdometrySettings in_space(const OdometrySettings& settings, const SpaceSettings& space, const Odometry& first);

/// How scans of this log are best taken and matched: with points and match for ribs as uneven as the front end found them.
OdometrySettings at_ribs(const OdometrySettings& settings, const Odometry& odometry);

/// Motion of the body from one horizontal laser's scans alone: each scan is matched to a map of recent key scans from a
/// prediction of constant speed, with a correlative search where that fails. Where the ribs leave a direction open the
/// prediction is kept in it and the stretch is reported with the sigma to which it has grown.
/// After a gap of more than 1.5 s a scan must lie on the map for the most part, else the motion breaks off there and begins
/// anew, at the pose before it.
/// Where ribs turn out to be uneven (they lean, bulge, lie under talus: a laser that pitches and rolls sees others in every
/// scan) all is done again with the sigma that they are found to have, learnt along the way.
/// @param scans at least one, stamps that grow, else Error; a scan without a single rib point moves as predicted and
/// counts as lost
/// @param stances  of the laser at each scan, or none: with them scans are matched in space
/// @param first  an earlier path of the same scans without breaks, or none: with it pieces of the log are matched in parallel, each
/// begun some metres earlier on that path
Odometry estimate_motion(const Scans& scans, const Mount& horizontal, const OdometrySettings& settings,
                         const Progress& progress = {}, const std::vector<Stance>& stances = {},
                         const Odometry* first = nullptr);

}  // namespace adit
