// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "mapper/align.h"
#include "mapper/match.h"
#include "mapper/scan_points.h"

#include <vector>

namespace adit {

/// How two places are held against each other by what the laser saw there.
struct PlaceSettings {
  double map_half_m = 5;     // way before and behind that makes a place's map
  double map_back_m = 9;     // more of the way behind, where the place is passed the other way
  double map_step_m = 0.6;   // between its scans
  double scan_half_m = 1.5;  // way that is joined to the scan which is placed in it
  double scan_step_m = 0.5;
  double rigid_m = 0.5;          // scans that a degenerate stretch less certain than this parts make no common map
  double sure_m = 0.4;           // a path known better than this needs no search
  double inlier_share = 0.5;     // of the points, for a match to be one
  double ambiguous_share = 0.9;  // a second place that scores this share of the best makes a match ambiguous
};
Fields fields(PlaceSettings& settings);

/// Matches places by their scans: the scans around j, joined, are placed in the local map of the scans around i. Where
/// the path leaves more than sure_m open all of what it leaves open is searched, and a match that fits as well
/// elsewhere within that is ambiguous, unless the two lie along a direction that the ribs leave open: then the match is
/// degenerate and its information has none in that direction. Parallel over the pairs; scans and chain must outlive the
/// result. A place ends where the length of the way is not known: a stretch that was only predicted may be metres too short.
/// @param odometry  a path of which only the shape within some metres is used
MatchPlaces match_by_scans(const std::vector<ScanPoints>& scans, const Chain& chain, const Odometry& odometry,
                           const PlaceSettings& settings, const MatchSettings& match);

}  // namespace adit
