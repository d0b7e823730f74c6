// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"

#include <vector>

namespace adit {

/// Where a vehicle shall go: a line in plan, corners rounded to what can be driven, and the passages that it follows.
struct Route {
  std::vector<Vec2> line;     // about every 0.25 m
  std::vector<int> passages;  // ids in the order of driving, repeated when driven again
  double length_m = 0;
};

}  // namespace adit
