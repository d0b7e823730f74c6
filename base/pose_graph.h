// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace adit {

/// A measured pose of node j in node i. The information is about frame j, of the error e in X_true = X_ij * (ex, ey,
/// eyaw): the convention of g2o's EDGE_SE2.
struct Relative {
  int i = 0, j = 0;
  Pose2 X_ij;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

/// Poses to be found and what was measured between them. Node 0 stays where it is.
struct PoseGraph {
  std::vector<Pose2> node;  // start values
  std::vector<Relative> edge;
  std::vector<double> kernel;  // (edge) or empty: width of the Cauchy kernel in standard deviations; 0 = quadratic
};

/// What can be proved of a solution of a planar pose graph. It speaks of the isotropic objective alone, the sum of
/// tau |t_j - t_i - R_i t_ij|^2 + kappa |R_j - R_i R_ij|_F^2: its optimum nearest to the given poses is `node`, and
/// `certified` says that no other poses have a lower value, up to `gap_bound`. The given poses, which minimise another
/// objective under the full informations, lie `distance` from it.
struct Certificate {
  double given_objective = 0;  // of the poses that were given
  double objective = 0;        // of `node`
  std::vector<Pose2> node;     // stationary point of the isotropic objective that descends from the given poses
  bool stationary = false;     // it was reached
  bool certified = false;
  double smallest_eigenvalue = 0;  // of the dual matrix over the turns; below -threshold: not certified
  double threshold = 0;
  double gap_bound = 0;  // no poses have a value below objective - gap_bound
  double distance_rms_m = 0, distance_max_m = 0, distance_max_rad = 0;
};

/// A pose graph at its solution.
struct SolvedGraph {
  PoseGraph graph;
  std::vector<int> id;  // (node) its number in the file, or the scan of the mapping laser that it stands for
  std::string start;    // of the search that led here: path, file, odometric or chordal
  bool converged = false;
  int iterations = 0;
  double chi2 = 0;
  std::vector<Eigen::Matrix3d> covariance;  // (node) of x, y, yaw relative to node 0, in the node's own frame
  Certificate certificate;
};

/// A graph as a file has it.
struct GraphFile {
  PoseGraph graph;
  std::vector<int>
      id;  // (node) the file's own number of each node; node 0 is the one that the file fixes, else its first
  bool has_poses = false;  // the nodes' poses come from the file; else they are all zero
};

/// Planar pose graphs in g2o's text form (VERTEX_SE2, EDGE_SE2, FIX) or TORO's (VERTEX2, EDGE2). Poses may be missing
/// altogether. Errors, with file and line: another kind of vertex or edge, what is no finite number, a node given
/// twice, an edge to a node that has no pose where others have, information that is not positive definite, two fixed
/// nodes; and a graph in several parts.
GraphFile read_g2o(const std::string& file);

/// Nodes, node 0 fixed, and edges, with as many digits as bring the same bits back.
/// @param id  (node) or empty: 0, 1, 2, ...
void write_g2o(const std::string& file, const PoseGraph& graph, const std::vector<int>& id = {});

}  // namespace adit
