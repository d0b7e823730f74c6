// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"

#include <string>
#include <vector>

namespace adit {

/// A box that moves with the vehicle and stands in the rays: frame, wheels, the person who pushes.
struct Box {
  std::string name;
  Vec3 min_B, max_B;
  Label label = Label::vehicle;
};

using Hull = std::vector<Box>;

}  // namespace adit
