// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/scene.h"

#include <cstdint>
#include <functional>

namespace adit {

/// Where one stands in a mine with a lamp, and which way one looks (a unit vector), in W.
struct Lookout {
  Vec3 eye, ahead;
};

/// A camera there, as wide as one sees at a glance.
Camera camera_of(const Lookout& from);

/// Whether a place may be of a picture that is `aspect` times as wide as high, or of a face that touches it: faces that
/// fail need not be drawn. No farther than a lamp shows anything.
std::function<bool(const Vec3&)> lit_from(const Camera& camera, double aspect);

/// The faces of a mine that `keep` accepts, as rock, things and water look by a lamp.
std::vector<Skin> mine_skins(const Mesh& mesh, const std::function<Colour(std::uint32_t, Label)>& colour_of,
                             const std::function<bool(size_t)>& keep);

/// What a lamp at the eye shows of a scene.
Picture take_lamp_picture(Scene scene, const Camera& camera, int width, int height);

}  // namespace adit
