// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/hull.h"
#include "base/mesh.h"
#include "base/rig.h"
#include "eval/picture.h"

#include <vector>

namespace adit {

/// A vehicle that stands in a passage and what its lasers see there.
struct RigExhibit {
  const Mesh& passage;  // in W
  const Rig& rig;
  const Hull& hull;
  Pose X_WB;
  std::vector<std::vector<Vec3>> ends_W;  // (lasers x beams) where each beam ends
};

/// From where a rig is looked at.
enum class RigView { corner, side, front, above };

/// The passage cut open, the vehicle's boxes, each laser's mirror, its fan as every few beams, and what it covers of the
/// rock; a colour and a line of words for each laser.
Picture rig_picture(const RigExhibit& exhibit, RigView view);

}  // namespace adit
