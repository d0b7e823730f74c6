// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/mesh.h"
#include "rays/caster.h"

#include <span>

namespace adit::bench {

/// Seconds of wall time in which Embree alone casts the rays, on this thread: rtcIntersect16, coherent, in the order
/// given, packets filled and ranges read back; the mesh, the instruction set and the flags are those of Caster.
/// @param repeats  the best of so many
double raw_seconds(const Mesh& mesh, std::span<const Ray> rays, int repeats);

}  // namespace adit::bench
