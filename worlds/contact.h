// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "worlds/plan_grid.h"

#include <map>

namespace adit {

/// Asks of faces whether they cross a body, which must outlive it.
class Contact {
 public:
  explicit Contact(const Solid& body);
  /// Whether a face of something else crosses one of the body's.
  bool crosses(const std::array<Vec3, 3>& corner);

 private:
  const Solid& body_;
  Mesh both_;  // the body and the face asked for, which share nothing
  std::vector<Box3> own_;
  std::map<std::pair<long, long>, std::vector<std::uint32_t>> near_;  // of own_, by squares of the plan
};

/// Whether a point lies within a body.
bool within(const Solid& s, const Vec3& p);

/// Whether two triangles of the plan come within some millimetres of one another: no side of either parts them.
bool near_in_plan(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b);

}  // namespace adit
