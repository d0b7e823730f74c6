// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/dexels.h"
#include "base/mesh.h"

namespace adit {

/// The boundary of a solid as a closed mesh, normals outward, faces labelled roof, floor or rib by their slope (45
/// deg).
/// @param cells  columns along the edge of a voxel; more smooth the surface and cost detail
/// The share of each voxel that is filled is a field whose level 1/2 is meshed by surface nets (Gibson, MICCAI 1998);
/// of two filled voxels that touch along an edge only, the emptier is dropped first, so that every mesh edge joins two
/// faces.
Mesh boundary_of(const Dexels& solid, int cells);

}  // namespace adit
