// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/progress.h"
#include "base/recording.h"

#include <Eigen/Core>

#include <string>
#include <vector>

namespace adit {

struct TiltSettings {
  double knot_s = 0.2;         // of the spline while the vehicle moves
  double rest_knot_s = 2;      // and while it stands
  double node_m = 0.25;        // lattice of the floor's and the roof's heights
  double coarse = 2;           // times node_m: the lattice of all iterations but the last
  double spacing_m = 0.25;     // beams of a scan are thinned to this distance on the rock
  double forward_m = 10;       // use of the forward vertical laser, horizontally
  double sideways_m = 4;       // use of the upward and downward lasers, horizontally
  double sigma_m = 0.015;      // of a beam against the lattice: roughness between the nodes and noise
  double kernel = 2.5;         // width of the robust kernel in sigmas
  double curvature_m = 0.05;   // prior sd of the second difference of neighbouring nodes
  double rib_sigma_deg = 8;    // trust in a rib being vertical, for one rib in one scan; 0 = none
  double level_sigma_deg = 2;  // prior sd of pitch and roll where no forward vertical laser sees pitch
  double bias_sigma_m = 0.01;  // prior sd of each laser's constant range error; 0 = taken as none
  double bias_doubt = 4;       // the formal sd of the range errors is so many times too small
  int iterations = 3;
};
Fields fields(TiltSettings& s);

/// The path with its height, pitch and roll.
struct TiltSolution {
  Trajectory path;                   // X_MB at the stamps that were given
  Trajectory dense;                  // the same motion every 20 ms within them: what beams between the stamps need
  std::vector<double> range_bias_m;  // (lasers) estimated, measured minus true; 0 where not estimated
  std::vector<int> biased;           // lasers for which it was estimated
  Eigen::MatrixXd bias_covariance;   // (lasers x lasers) as solve_tilt says; where not estimated, of the sheet's band
  double rms_m = 0;                  // of the residuals of floor and roof, weighted by the kernel
  double factor_operations = 0;      // of one factorisation
  std::string note;                  // why the path stayed planar, or what of it is not seen; empty otherwise
};

/// Height, pitch and roll of the body from its planar path and the vertical lasers: ONE sparse least squares whose
/// unknowns are a cubic spline in time for z, pitch and roll, the heights of floor and roof on a lattice in plan
/// (bilinear between nodes, curvature prior) and a constant range error of each laser. Each beam that meets floor or
/// roof is one equation, at its own instant; all lasers and all visits meet in the same nodes, so loops in height close
/// by themselves. Ribs count as vertical with rib_sigma_deg: that holds roll. Solved by Gauss-Newton with a Cauchy
/// kernel, on a coarse lattice until the last iteration: the motion hardly needs the fine one, its factor costs most.
/// @param stamp_s  (n) of the horizontal laser, rising;  @param planar  (n) X_MB of the body, level
/// x and y: what the planar poses fix is where the horizontal laser stands; the body moves under it as it pitches and
/// rolls. The tilt of the whole is a gauge without gravity: the ribs fix it, else the start counts as level. A rig without
/// a forward vertical laser does not see pitch: the body counts as level, give or take level_sigma_deg. One that has no downward
/// laser either keeps the planar path, level at z = 0. Both are said in `note`.
/// bias_covariance: the formal one for residuals of rms_m, times bias_doubt squared, since what the lattice cannot follow
/// is not white; a laser without an estimate has that of its stated band, bias_m^2 / 3.
TiltSolution solve_tilt(const Log& log, const std::vector<double>& stamp_s, const std::vector<Pose2>& planar,
                        const TiltSettings& settings, const Progress& progress = {});

/// The log with each laser's constant range error taken off; an echo nearer than that keeps a range of zero.
Log without_bias(Log log, const std::vector<double>& range_bias_m);

/// The path of solve_tilt alone.
Trajectory estimate_tilt(const Log& log, const std::vector<double>& stamp_s, const std::vector<Pose2>& planar,
                         const TiltSettings& settings, const Progress& progress = {});

}  // namespace adit
