// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/grid.h"
#include "base/mesh.h"
#include "base/points.h"
#include "base/pose_graph.h"
#include "base/trajectory.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace adit {

/// A claim that two scans of the mapping laser, i < j, saw the same place.
struct Closure {
  int i = 0, j = 0;
  Pose2 X_ij;             // measured, or (0, 0, 0 or pi) where the method asserts the place only
  bool measured = false;  // X_ij comes from matching
  bool accepted = false;
  bool ambiguous = false;  // could as well be elsewhere
};

/// One round of the global alignment, for the picture of its convergence.
struct AlignmentRound {
  std::vector<Vec2> nodes;                           // positions before the round, every few metres
  std::vector<std::pair<int, int>> correspondences;  // node indices
};

/// Where the scans leave a direction of motion open.
struct DegenerateStretch {
  double from_s, to_s;
  double sigma_m;  // along the weak direction, at the end of the stretch
};

/// A laser's constant range error as the mapper found it; it is taken off before points and volume are made.
struct RangeBias {
  std::string laser;
  double bias_m, sigma_m;  // measured minus true
};

/// The mapped void nearest to what was driven from from_s to to_s, whenever it was seen.
struct VolumePart {
  double from_s, to_s;
  double length_m;  // of the path
  double volume_m3, sigma_m3;
};

/// What a mapper says, in M (the frame of the first pose of the mapping laser's body).
struct Estimate {
  std::string method;
  Trajectory path;                          // X_MB at each scan of the mapping laser, six degrees of freedom
  std::vector<Eigen::MatrixXd> covariance;  // (path) or empty: 3 x 3 or 6 x 6, as base/path_file.h has them
  std::vector<Pose2> open_loop;             // (path) scan matching alone, in the plane
  std::vector<Pose2> planar;                // (path) after the global alignment
  std::vector<AlignmentRound> rounds;
  bool converged = false;  // the correspondences repeated
  std::vector<Closure> closures;
  std::optional<SolvedGraph> graph;  // that `planar` is laid on; none where the method has no pose graph
  std::vector<DegenerateStretch> degenerate;
  Grid grid;
  PointCloud points;
  Mesh surface;                     // boundary of the mapped void, closed; empty where the rig cannot see it
  std::optional<double> volume_m3;  // of the mapped void; none where the rig has no upward laser
  std::optional<double> volume_sigma_m3;
  std::vector<VolumePart> volume_parts;  // in the order of time; their volumes add up to volume_m3
  std::vector<RangeBias> range_bias;     // of the lasers that it could be found for
  std::vector<std::string> notes;        // what was dropped or could not be done, one sentence each
};

/// DIR/trajectory.tum open_loop.tum planar.tum path_covariance.txt grid.pgm grid.yaml ribs.geojson ribs.dxf points.ply
/// surface.ply surface.glb graph.g2o map.json. What the estimate lacks has no file. map.json comes last: a folder that holds it is whole.
void save_estimate(const std::string& dir, const Estimate& estimate);
/// The same; the grid's cells come back as free, occupied or unknown. A missing or foreign file is an Error.
Estimate load_estimate(const std::string& dir);

/// The same for a graph that is a map of its own: DIR/graph.g2o, covariance.txt ("id" and the upper triangle of each
/// node's covariance) and map.json; what an earlier map left there is removed.
void save_graph(const std::string& dir, const SolvedGraph& graph);

}  // namespace adit
