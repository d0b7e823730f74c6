// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "mapper/graph.h"
#include "mapper/odometry.h"

#include <vector>

namespace adit {

/// The front end's path thinned to nodes, with what it measured from node to node.
struct Chain {
  std::vector<double> along_m;  // (scans) driven up to each scan; standing still adds nothing
  std::vector<int> scan;        // (nodes) scan of each node, the first and the last scan among them
  std::vector<Relative> step;   // (nodes - 1) from node k to node k + 1, steps of the scans composed along the way
};

/// A node every spacing_m of the way. A laser that stands still jitters by millimetres: only what leads further than 5
/// cm from the last counted scan counts as way.
Chain chain_of(const Odometry& odometry, double spacing_m);

/// The node at or before each scan. (scans)
std::vector<int> node_before(const Chain& chain);

/// Poses of all scans from poses of the nodes: between two nodes the front end's own path is laid rigidly on either
/// node and the two are blended along the way, so that its shape stays.
std::vector<Pose2> spread(const Chain& chain, const std::vector<Pose2>& open_loop, const std::vector<Pose2>& node);

/// Covariances of the poses of all scans, each in its own frame, from those of the nodes: carried from the node before
/// and the node after, weighed along the way.
std::vector<Eigen::Matrix3d> spread_covariances(const Chain& chain, const std::vector<Pose2>& X_MB,
                                                const std::vector<Eigen::Matrix3d>& node);

/// From A (s = 0) to B (s = 1): straight in position, the shorter way round in yaw.
Pose2 blend(const Pose2& A, const Pose2& B, double s);

}  // namespace adit
