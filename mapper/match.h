// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "mapper/local_map.h"

#include <Eigen/Core>

#include <optional>

namespace adit {

struct MatchSettings {
  double gate_m = 0.5;       // pairs farther apart than this at the first iteration are none
  double gate_end_m = 0.25;  // and at the last
  double robust_sigmas = 3;  // residuals beyond count less and less
  int iterations = 20;
  double map_sigma_m = 0.02;      // of a surfel along its normal: how far the rib leaves its line between beams
  double weak_sigma_m = 0.03;     // directions in which a match is less certain than this are left to the prior
  double even_m = 0.014;          // points that leave the map by less than this, 1 sd, beyond their noise: even ribs
  double swallowed = 3;           // uneven ribs move a scan by so many times what they leave of it
  double min_inlier_share = 0.4;  // of a scan's points, for a match to be one
};
Fields fields(MatchSettings& s);

/// What is known of X_AB before a match: information about frame B, of the error e in X_true = X * (ex, ey, eyaw).
struct PosePrior {
  Pose2 X;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

/// A scan placed in a local map.
struct Match {
  Pose2 X_AB;
  Eigen::Matrix3d information =
      Eigen::Matrix3d::Zero();  // of the scan alone, without any prior; same convention as above
  double known_share = 0;       // of the scan's points that have any rib of the map near them
  double inlier_share = 0;      // of the scan's points that lie on a rib of the map (within 3 sigma)
  double rms_m = 0;             // of the inliers' distances
  double weak_sigma_m = 0;      // 1 sd of the position in its least certain direction (yaw free); +inf: not seen at all
  Vec2 weak_direction = Vec2::UnitX();  // of it, in B
  bool degenerate = false;  // weak_sigma_m is above the setting: that direction of X_AB is the prior's (or the guess's)
  bool converged = false;   // settled, with enough inliers
};

/// Places a scan in a map from a guess: point to line, robust weights, Gauss-Newton.
/// A prior counts as one more quadratic term. Directions that the ribs leave open are its matter alone; without one
/// they stay at the guess.
Match match_scan(const ScanPoints& scan, const LocalMap& map, const Pose2& guess_X_AB, const MatchSettings& settings,
                 const std::optional<PosePrior>& prior = {});

/// How far uneven ribs may have moved the match that placed a scan at X_AB, 1 sd: `swallowed` times what its points lie off
/// the blended map by, their noise and `even_m` taken off; 0 where ribs are even, or none is near.
double uneven_m(const ScanPoints& scan, const LocalMap& map, const Pose2& X_AB, const MatchSettings& settings);

/// Where a wide search looks: +- around the guess.
struct SearchWindow {
  double reach_m = 1.0, reach_rad = 0.35;
};

/// The best place of a scan in a map, and the next best that is another place.
struct WideMatch {
  Match best;
  double score = 0;  // 0..1: mean over the scan's points of exp(-d^2 / (2 * 0.1 m ^2)), d to the nearest like rib
  double runner_up_score = 0;  // of the best place more than 0.7 m or 8 degrees off, refined too; 0 if none
  Pose2 runner_up_X_AB;
};

/// Correlative search over the whole window (steps of 0.2 m and 2 degrees on a map widened accordingly), the best few
/// peaks refined by match_scan. After Olson, "Real-time correlative scan matching", ICRA 2009.
/// With a scan joined from several neighbours (join_scans) the verdict is surer than with one.
WideMatch search_scan(const ScanPoints& scan, const LocalMap& map, const Pose2& guess_X_AB, const SearchWindow& window,
                      const MatchSettings& settings);

/// Several scans as one, in the body frame of the pose `X_AB` of one of them, thinned like a local map.
ScanPoints join_scans(std::span<const ScanPoints* const> scans, std::span<const Pose2> X_AB, const Pose2& X_AC);

}  // namespace adit
