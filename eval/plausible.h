// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "base/mesh.h"
#include "eval/path_error.h"

namespace adit {

/// Refuses what would score as a plausible wrong number: a path, points, a surface or a grid in millimetres, centimetres
/// or kilometres, told by their spread against that of the true path; a surface turned inside out, or with vertices that
/// are no numbers; points none of which is finite; covariances that are not as many as poses.
/// @throws Error naming the part, what it looks like and what would be right
void check_plausible(const Estimate& estimate, const PathMatch& match);

}  // namespace adit
