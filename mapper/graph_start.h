// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/pose_graph.h"

#include <vector>

namespace adit {

/// Poses from the edges alone, node 0 where it is: along a tree of edges that follows the numbering of the nodes as far
/// as it goes. The graph must be in one part.
std::vector<Pose2> odometric_start(const PoseGraph& graph);

/// Poses from the edges alone, node 0 where it is: the turns by one linear least squares over unit complex numbers
/// whose length is left free, then the positions by another. Needs no guess and sees all loops at once.
/// Source: Martinec and Pajdla, CVPR 2007; Carlone et al., ICRA 2015 ("chordal relaxation").
std::vector<Pose2> chordal_start(const PoseGraph& graph);

}  // namespace adit
