// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/places.h"

#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

using Matrix3 = Eigen::Matrix3d;

/// Scans around scan i and their poses in body i.
struct Around {
  std::vector<const ScanPoints*> scan;
  std::vector<Pose2> X_iB;
};

/// A path and where it falls apart.
struct Shape {
  std::vector<Pose2> X_MB;  // (scans)
  std::vector<char> loose;  // (scans) the step to it is not known to a place's accuracy
};

Shape shape_of(const Odometry& odometry, double rigid_m) {
  Shape shape{odometry.X_MB, std::vector<char>(odometry.X_MB.size(), 0)};
  for (const DegenerateStretch& d : odometry.degenerate) {
    if (d.sigma_m <= rigid_m) continue;
    const std::vector<double>& stamp_s = odometry.stamp_s;
    for (size_t i = std::upper_bound(stamp_s.begin(), stamp_s.end(), d.from_s) - stamp_s.begin();
         i < stamp_s.size() && stamp_s[i] <= d.to_s; ++i)
      shape.loose[i] = 1;
  }
  return shape;
}

/// Those `step_m` of way apart, up to before_m before and after_m after it, as far as the path holds together.
struct Span {
  double before_m, after_m, step_m;
};

Around around(int i, const Span& span, const std::vector<ScanPoints>& scans, const Chain& chain, const Shape& shape) {
  const int n = static_cast<int>(scans.size());
  std::vector<int> chosen{i};
  for (int k = i - 1, last = i; k >= 0 && !shape.loose[k + 1] && chain.along_m[i] - chain.along_m[k] <= span.before_m;
       --k)
    if (chain.along_m[last] - chain.along_m[k] >= span.step_m) chosen.push_back(last = k);
  for (int k = i + 1, last = i; k < n && !shape.loose[k] && chain.along_m[k] - chain.along_m[i] <= span.after_m; ++k)
    if (chain.along_m[k] - chain.along_m[last] >= span.step_m) chosen.push_back(last = k);
  std::sort(chosen.begin(), chosen.end());
  Around a;
  for (int k : chosen) a.scan.push_back(&scans[k]), a.X_iB.push_back(shape.X_MB[i].inverse() * shape.X_MB[k]);
  return a;
}

/// The part of the path from which a place's map is made. A laser looks ahead: who comes the other way looks at what
/// was seen from further back.
Span map_span(const PlacePair& pair, const PlaceSettings& s) {
  const bool opposite = std::abs(pair.X_ij.yaw_rad) > std::numbers::pi / 2;
  return {s.map_half_m + (opposite ? s.map_back_m : 0), s.map_half_m, s.map_step_m};
}

/// The information without its part along a direction of the position.
Matrix3 without(const Matrix3& information, const Vec2& direction) {
  Matrix3 P = Matrix3::Identity();
  P.topLeftCorner<2, 2>() -= direction * direction.transpose();
  return P * information * P;
}

/// The second place lies off the first along nothing but the open direction of the match.
bool along_open(const Match& best, const Pose2& other_X_AB) {
  const Pose2 D = best.X_AB.inverse() * other_X_AB;
  const Vec2 off = D.position() - best.weak_direction * best.weak_direction.dot(D.position());
  return best.degenerate && off.norm() < 0.3 && std::abs(D.yaw_rad) < 0.05;
}

PlaceMatch verdict(const Match& best, const PlacePair& pair, const PlaceSettings& settings) {
  PlaceMatch m;
  const Pose2 off = pair.X_ij.inverse() * best.X_AB;
  m.found = best.converged && best.inlier_share >= settings.inlier_share &&
            off.position().norm() <= pair.reach_m + settings.sure_m;
  m.degenerate = best.degenerate;
  m.X_ij = best.X_AB;
  m.information = best.degenerate ? without(best.information, best.weak_direction) : best.information;
  return m;
}

PlaceMatch match_pair(const PlacePair& pair, const ScanPoints& scan, const LocalMap& map, const PlaceSettings& settings,
                      const MatchSettings& match) {
  if (pair.reach_m <= settings.sure_m) return verdict(match_scan(scan, map, pair.X_ij, match), pair, settings);
  const WideMatch wide = search_scan(scan, map, pair.X_ij, {pair.reach_m, std::max(pair.reach_rad, 0.1)}, match);
  PlaceMatch m = verdict(wide.best, pair, settings);
  const double off_m = (wide.runner_up_X_AB.position() - pair.X_ij.position()).norm();
  m.ambiguous = wide.runner_up_score >= settings.ambiguous_share * wide.score && off_m <= pair.reach_m &&
                !along_open(wide.best, wide.runner_up_X_AB);
  return m;
}

}  // namespace

Fields fields(PlaceSettings& s) {
  return {{"map_half_m", &s.map_half_m, "way before and behind that makes a place's map", 0.5, 50},
          {"map_back_m", &s.map_back_m, "more of the way behind, where the place is passed the other way", 0, 50},
          {"map_step_m", &s.map_step_m, "between the scans of a place's map", 0.05, 10},
          {"scan_half_m", &s.scan_half_m, "way that is joined to the scan which is placed in it", 0, 50},
          {"scan_step_m", &s.scan_step_m, "between the scans that are joined", 0.05, 10},
          {"rigid_m", &s.rigid_m, "a degenerate stretch less certain than this parts a place's scans", 0.01, 1000},
          {"sure_m", &s.sure_m, "a path known better than this needs no search", 0.05, 10},
          {"inlier_share", &s.inlier_share, "of the points, for a match to be one", 0, 1},
          {"ambiguous_share", &s.ambiguous_share, "of the best score, at which a second place makes a match ambiguous",
           0, 1}};
}

MatchPlaces match_by_scans(const std::vector<ScanPoints>& scans, const Chain& chain, const Odometry& odometry,
                           const PlaceSettings& settings, const MatchSettings& match) {
  return [&scans, &chain, shape = shape_of(odometry, settings.rigid_m), settings,
          match](const std::vector<PlacePair>& pairs) {
    std::vector<PlaceMatch> result(pairs.size());
    parallel_for(pairs.size(), [&](size_t k) {
      const PlacePair& pair = pairs[k];
      const Around place = around(pair.i, map_span(pair, settings), scans, chain, shape);
      const Around seen =
          around(pair.j, {settings.scan_half_m, settings.scan_half_m, settings.scan_step_m}, scans, chain, shape);
      const LocalMap map(place.scan, place.X_iB);
      result[k] = match_pair(pair, join_scans(seen.scan, seen.X_iB, {}), map, settings, match);
    });
    return result;
  };
}

}  // namespace adit
