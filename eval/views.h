// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/exhibit.h"
#include "eval/scene.h"

#include <functional>

namespace adit {

// What the pictures in space share.

using Near = std::function<bool(const Vec3&)>;

/// The faces of the mapped surface near a place (all without one), coloured by error; heights stretched about z0_m.
Skin error_skin(const Exhibit& exhibit, double stretch = 1, double z0_m = 0, const Near& near = {});
/// Map points coloured by error; those on the roof are left out where the roof is to be lifted off.
Dots error_dots(const Exhibit& exhibit, bool with_roof, double stretch = 1, double z0_m = 0, const Near& near = {});
Colour rock_colour(Label label);
/// A camera that stands at a viewpoint.
Camera camera_at(const Viewpoint& viewpoint);

}  // namespace adit
