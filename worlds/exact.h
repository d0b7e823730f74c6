// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"

namespace adit {

/// Whether two faces of a mesh have a point in common besides the corners and the side that both have. Exact for the
/// coordinates as they are.
bool faces_cross(const Mesh& mesh, size_t f, size_t g);

/// Whether the corners of a face lie on one line. Exact.
bool no_area(const Mesh& mesh, size_t f);

}  // namespace adit
