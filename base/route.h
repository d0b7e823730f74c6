// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <vector>

namespace adit {

/// Where a vehicle shall go: a line in plan, corners rounded to what can be driven, and the passages that it follows.
struct Route {
  struct Stretch {
    int first, last;  // points of the line
  };
  std::vector<Vec2> line;     // about every 0.25 m
  std::vector<int> passages;  // ids in the order of driving, repeated when driven again
  double length_m = 0;
  std::vector<Stretch> backwards = {};  // driven tail first, in their order; the vehicle halts at both ends of each
};

}  // namespace adit
