// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/trajectory.h"
#include "eval/score.h"

#include <string>
#include <vector>

namespace adit {

/// True pose of the body at one instant relative to the body at another: all that is known of a real log's path.
/// Source: Kuemmerle et al., "On measuring the accuracy of SLAM algorithms", Autonomous Robots 27, 2009.
struct Relation {
  double from_s, to_s;
  Pose X;  // of the body at to_s in the body at from_s
};

/// Lines "t1 t2 x y z roll pitch yaw", metres and radians, '#' comments. Errors name file and line.
std::vector<Relation> read_relations(const std::string& file);

/// Holds a path against relations, each end matched to the nearest pose within max_diff_s.
/// relations.translation_m, translation_sd_m, translation_sq_m2, translation_sq_sd_m2: distance between the estimated and
/// the true relative position; rotation_deg, ...: angle between the relative orientations; matched_share.
/// @throws Error (not_comparable) where less than 95 % of the relations find their poses
Score score_relations(const std::vector<Relation>& relations, const Trajectory& path, double max_diff_s);

}  // namespace adit
