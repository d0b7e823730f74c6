// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/pose_graph.h"

#include <string>

namespace adit {

/// The dual test of SE-Sync in the plane, where turns are complex numbers and S is Hermitian: with the positions
/// eliminated, S = Q~ - diag(Lambda), Lambda_i = Re(conj(z_i) (Q~ z)_i). If S has no eigenvalue below -threshold, no
/// poses have a value below objective - threshold * nodes. That is decided by the signs of the pivots of one sparse
/// factorisation of S + threshold, not by an eigenvalue iteration that could stop too early.
/// Any multipliers make such a bound, the better the nearer they come to the optimum of the relaxed problem: those of
/// lifted_start bound a graph whose relaxation is not tight, or whose local optimum cannot be told by its own.
/// @param multiplier  (node) or empty
/// The graph's kernels are ignored. It must be in one part.
/// Source: Rosen, Carlone, Bandeira, Leonard, "SE-Sync", IJRR 2019; the complex form: Carlone and Calafiore, "Convex
/// relaxations for pose graph optimization with outliers", RA-L 2018.
Certificate certify(const PoseGraph& graph, const Eigen::VectorXd& multiplier = {});

/// One sentence: what is proved, or why nothing is.
std::string verdict(const Certificate& certificate);

}  // namespace adit
