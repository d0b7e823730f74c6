// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/estimate.h"
#include "base/progress.h"
#include "mapper/closures.h"
#include "mapper/odometry.h"

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace adit {

/// A path made consistent with itself where it meets itself.
struct Aligned {
  std::vector<Pose2> X_MB;  // (scans) first = that of the front end
  std::vector<AlignmentRound> rounds;
  bool converged = false;                   // the correspondences repeated those of the round before
  std::vector<Closure> closures;            // scan indices
  std::optional<SolvedGraph> graph;         // that X_MB is spread from
  std::vector<Eigen::Matrix3d> covariance;  // (scans) or empty: of X_MB relative to the first, each in its own frame
  std::vector<std::string> notes;
};

/// `icra2003`: what the paper publishes, with weights of our own (docs/mapper.md says why).
struct PublishedSettings {
  double node_m = 5;    // of way between two nodes
  double near_m = 2.5;  // between two passages of the same place
  double parallel_deg = 20;
  double orthogonal_deg = 30;
  double gap_m = 20;  // of way between two passages
  int max_rounds = 20;
  int relinearisations = 2;   // per round
  double sigma_along_m = 10;  // Z: of the pose of a place passed again, along and across the way, and its heading
  double sigma_across_m = 0.3;
  double sigma_yaw_deg = 5;
  std::string penalty = "matched";  // H: composed from the scan matcher's information, or "fixed"
  double bend_m = 0.01;             // H if fixed: per node
  double bend_deg = 0.05;
};
Fields fields(PublishedSettings& settings);

/// The alignment of Thrun et al., ICRA 2003, section III-B: nodes, correspondences by the three criteria, the
/// closed-form sparse solution of the linearised problem, iterated until the correspondences repeat; poses between
/// nodes by blending. The closures that it returns are claims of a place (measured = false), those of the last round.
Aligned align_published(const Odometry& odometry, const PublishedSettings& settings, const Progress& progress = {});

/// Two nodes of the path that may stand at the same place.
struct PlacePair {
  int i = 0, j = 0;    // scans, i < j
  Pose2 X_ij;          // as the path has it
  double reach_m = 0;  // how far that may be out
  double reach_rad = 0;
};

/// What the local maps of the two places say of it.
struct PlaceMatch {
  bool found = false;       // they fit
  bool ambiguous = false;   // they fit as well elsewhere within reach
  bool degenerate = false;  // one direction is left open: the information says which
  Pose2 X_ij;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // about frame j, as in Relative
};

/// Matches the places of each pair; see mapper/places.h for that by scans.
using MatchPlaces = std::function<std::vector<PlaceMatch>(const std::vector<PlacePair>&)>;

struct RobustSettings {
  double node_m = 1;           // of way between two nodes
  double closure_m = 2;        // of way between two candidates
  double near_m = 3;           // between two passages, if the path were exact
  double reach_m = 8;          // most that the path may be thought to be out when candidates are sought
  double least_reach_m = 0.3;  // that a settled path is thought to be out
  double doubt = 2;            // times the path's stated sigma is believed: errors of neighbouring steps hang together
  double wide_m = 1;           // a reach beyond this is searched for few candidates first
  double wide_step_m = 7;      // way between those
  double parallel_deg = 25;
  double orthogonal_deg = 35;
  double gap_m = 20;
  int max_rounds = 25;
  double neighbour_m = 20;   // of way within which closures are held against each other
  int neighbours = 6;        // of them, the nearest
  double agree_chi2 = 16.3;  // two closures agree below this; 0.999 of three degrees of freedom
  double agree_share = 0.6;  // of the neighbours must agree, and at least one
  double kernel = 3;         // width of the Cauchy kernel in standard deviations
  double drop_weight = 0.2;  // a closure that the kernel gives less is taken back
  double floor_m = 0.01;     // 1 sd that is added to each match: what local maps share and a match cannot know
  double floor_deg = 0.1;
};
Fields fields(RobustSettings& settings);

/// Closures that are measured before they may bend the path. Each round: candidates by the criteria of icra2003 within
/// a radius that grows with the uncertainty of the path between the two; each matched; sets that agree with each other
/// along the way; the pose graph solved to convergence under a Cauchy kernel, and what the kernel silences taken back.
/// The rounds end when no candidate is new and the accepted set is that of the round before. Returned closures are
/// measured; those that fit elsewhere too, or slide along a smooth passage, are flagged
/// ambiguous and bend nothing. Sources: Mangelson et al., "Pairwise
/// consistent measurement set maximization", ICRA 2018 (the test of agreement).
Aligned align_robust(const Odometry& odometry, const MatchPlaces& match_places, const RobustSettings& settings,
                     const Progress& progress = {});

}  // namespace adit
