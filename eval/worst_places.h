// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "eval/map_error.h"
#include "eval/passage_map.h"

#include <vector>

namespace adit {

/// The error of a map by passage: each point counts where its nearest true surface lies, in the passage whose centre
/// line is nearest to that face. Passages without points are there with n = 0.
std::vector<PassageScore> passage_scores(const LaidPoints& laid, const Mesh& mesh, const PassageMap& passages);

/// Where the mean absolute error is largest: the surface is parted into squares of 2 m of the plan; squares with fewer
/// than 20 points are left out; at most ten, at least 10 m apart.
std::vector<WorstPlace> worst_places(const LaidPoints& laid, const PassageMap& passages);

}  // namespace adit
