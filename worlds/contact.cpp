// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/contact.h"

#include "worlds/exact.h"

#include <cmath>
#include <numbers>

namespace adit {

Contact::Contact(const Solid& body) : body_(body) {
  both_.vertex = body.vertex;
  both_.face = body.face;
  for (const auto& f : body.face) {
    const Box3 b = own_.emplace_back(box_of(body.vertex, f));
    const auto from = cell_of(b.low.head<2>()), to = cell_of(b.high.head<2>());
    for (long y = from.second; y <= to.second; ++y)
      for (long x = from.first; x <= to.first; ++x)
        near_[{x, y}].push_back(static_cast<std::uint32_t>(own_.size() - 1));
  }
}

bool Contact::crosses(const std::array<Vec3, 3>& corner) {
  Box3 other;
  for (const Vec3& p : corner) other.add(p);
  both_.vertex.resize(body_.vertex.size());
  both_.vertex.insert(both_.vertex.end(), corner.begin(), corner.end());
  both_.face.resize(body_.face.size());
  const auto n = static_cast<std::uint32_t>(body_.vertex.size());
  both_.face.push_back({n, n + 1, n + 2});
  const auto from = cell_of(other.low.head<2>()), to = cell_of(other.high.head<2>());
  for (long y = from.second; y <= to.second; ++y)
    for (long x = from.first; x <= to.first; ++x)
      if (const auto found = near_.find({x, y}); found != near_.end())
        for (std::uint32_t f : found->second)
          if (own_[f].meets(other) && faces_cross(both_, f, own_.size())) return true;
  return false;
}

// Solid angles under which the faces are seen add up to a whole ball within (van Oosterom, Strackee 1983).
bool within(const Solid& s, const Vec3& p) {
  double sum = 0;
  for (const auto& f : s.face) {
    const Vec3 a = s.vertex[f[0]] - p, b = s.vertex[f[1]] - p, c = s.vertex[f[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(sum) > 2 * std::numbers::pi;
}

bool near_in_plan(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  constexpr double margin_m = 0.004;
  for (const auto* of : {&a, &b}) {
    for (int k = 0; k < 3; ++k) {
      const Vec2 side = (*of)[(k + 1) % 3] - (*of)[k];
      if (side.squaredNorm() < 1e-18) continue;
      const Vec2 n = Vec2(side.y(), -side.x()).normalized();
      double low_a = 1e300, high_a = -1e300, low_b = 1e300, high_b = -1e300;
      for (int i = 0; i < 3; ++i) {
        low_a = std::min(low_a, n.dot(a[i])), high_a = std::max(high_a, n.dot(a[i]));
        low_b = std::min(low_b, n.dot(b[i])), high_b = std::max(high_b, n.dot(b[i]));
      }
      if (low_a > high_b + margin_m || low_b > high_a + margin_m) return false;
    }
  }
  return true;
}

}  // namespace adit
