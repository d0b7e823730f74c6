// SPDX-License-Identifier: BSD-3-Clause
#include "rays/nearest_face.h"

#include <cmath>

namespace adit {
namespace {

constexpr double tie_m = 1e-10;  // rounding of coordinates a few hundred metres from their origin

// Ericson, Real-Time Collision Detection, 5.1.5.
Vec3 closest_on_triangle(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const Vec3 bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const Vec3 cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  const double w = 1 / (va + vb + vc);
  return a + vb * w * ab + vc * w * ac;
}

}  // namespace

NearestFace::NearestFace(const Mesh& mesh, const Vec3& p, double radius_m, const std::optional<Vec3>& seen_along)
    : mesh_(mesh), p_(p), seen_along_(seen_along), best_m_(radius_m), point_(p) {}

// Where p is nearest to an edge or a corner, the face whose plane it is farthest from tells on which side p lies; another
// one may have it behind its back.
double NearestFace::facing(std::int32_t face, const Vec3& at) const {
  return std::abs(mesh_.normal(static_cast<size_t>(face)).dot(p_ - at));
}

// Ties between faces that share an edge; equal ones go to the lower index, whatever the order of the visit.
bool NearestFace::beats(std::int32_t face, const Vec3& at) const {
  const double ours = facing(face, at), best = facing(face_, point_);
  return std::abs(ours - best) > tie_m ? ours > best : face < face_;
}

bool NearestFace::offer(std::uint32_t f) {
  const auto face = static_cast<std::int32_t>(f);
  if (face == face_) return false;
  const Vec3 a = mesh_.corner(f, 0), b = mesh_.corner(f, 1), c = mesh_.corner(f, 2);
  const Vec3 n = (b - a).cross(c - a);
  if (seen_along_ && n.dot(*seen_along_) <= 0) return false;
  const double reach = best_m_ + tie_m, far_m2 = (1 + 1e-9) * reach * reach;
  const double height = n.dot(p_ - a);  // over the face's plane, times |n|
  if (height * height > far_m2 * n.squaredNorm()) return false;
  const Vec3 at = closest_on_triangle(p_, a, b, c);
  if ((at - p_).squaredNorm() > far_m2) return false;
  const double d = (at - p_).norm();
  if (!(d <= best_m_ + tie_m) || (d >= best_m_ - tie_m && face_ >= 0 && !beats(face, at))) return false;
  best_m_ = d, point_ = at, face_ = face;
  return true;
}

std::optional<Closest> NearestFace::found() const {
  if (face_ < 0) return {};
  return Closest{point_, face_, best_m_};
}

}  // namespace adit
