// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/pose_graph.h"
#include "base/progress.h"

#include <string>

namespace adit {

struct GraphMapSettings {
  std::string start = "best";
};
Fields fields(GraphMapSettings& s);

/// The optimum of a bare pose graph under its full informations, to convergence, with what can be proved of it. `best`
/// starts from the chordal relaxation, from what lifting makes of it, from the file's poses (where it has some) and from the
/// tree of odometry until one leads to a certified optimum, and keeps the least chi2.
SolvedGraph solve_graph(const GraphFile& file, const GraphMapSettings& settings, const Progress& progress = {});

/// The optimum that the poses of the graph lead to.
/// @param multiplier  see certify
SolvedGraph solve_graph(GraphFile file, const std::string& start, const Eigen::VectorXd& multiplier = {});

}  // namespace adit
