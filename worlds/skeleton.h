// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/drift.h"
#include "worlds/lattice.h"

namespace adit {

/// Centre lines of a void that is only known by its outline, with their junctions and widths.
struct Skeleton {
  MinePlan plan;
  std::vector<Drift> drifts;  // (plan.passages)
};

/// The middle of the void by thinning (Zhang, Suen, "A fast parallel algorithm for thinning digital patterns", CACM
/// 1984) on a lattice of 0.4 m: spurs into corners are taken off, junctions that lie in one another's width are one.
/// @param depth  signed distance from the ribs, negative in the void
Skeleton skeleton_of(const Lattice& depth);

}  // namespace adit
