// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"

namespace adit {

/// Pairs of faces that share more than a corner or a side that both have, counted exactly. Most pairs of neighbours are
/// found apart by signs that rounding cannot turn; the few that are left are asked by exact predicates. Time grows with
/// the number of faces; memory is that of the mesh and some slabs of it.
size_t crossing_pairs(const Mesh& mesh);

/// Faces whose corners lie on one line, exactly.
size_t degenerate_faces(const Mesh& mesh);

}  // namespace adit
