// SPDX-License-Identifier: BSD-3-Clause
#include "eval/plausible.h"

#include "base/error.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <vector>

namespace adit {
namespace {

constexpr double reach_m = 5;  // of lasers beyond the path, at least

// Root mean square distance from the mean; NaN of none.
double spread_of(const std::vector<Vec3>& points) {
  Vec3 mean = Vec3::Zero();
  size_t n = 0;
  for (const Vec3& p : points)
    if (p.allFinite()) mean += p, ++n;
  if (n == 0) return std::numeric_limits<double>::quiet_NaN();
  mean /= static_cast<double>(n);
  double squares = 0;
  for (const Vec3& p : points)
    if (p.allFinite()) squares += (p - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(n));
}

std::string rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

[[noreturn]] void refuse(const std::string& part, double times, const std::string& unit) {
  throw Error("the estimate's " + part + " is " + rounded(times) +
              " times as large as what was driven: it looks like " + unit + "; adit takes metres");
}

// A path has the length that it has; drift and slip change it by less than a third.
void check_path(const PathMatch& match) {
  std::vector<Vec3> truth, estimate;
  for (size_t k = 0; k < match.size(); ++k) {
    truth.push_back(match.X_WB[k].translation());
    estimate.push_back(match.X_MB[k].translation());
  }
  const double driven_m = spread_of(truth), times = spread_of(estimate) / driven_m;
  if (!(driven_m > 0.5)) return;
  const auto near = [&](double factor) { return times > factor / 1.5 && times < factor * 1.5; };
  if (near(1000)) refuse("path", times, "millimetres");
  if (near(100)) refuse("path", times, "centimetres");
  if (near(0.001)) refuse("path", times, "kilometres");
}

// Points lie about the path as far as lasers reach: a few times its spread for a short drive, never hundreds.
void check_extent(const std::string& part, const std::vector<Vec3>& points, const PathMatch& match) {
  if (points.empty() || match.size() == 0) return;
  std::vector<Vec3> truth;
  for (const Pose& X : match.X_WB) truth.push_back(X.translation());
  const double times = spread_of(points) / (spread_of(truth) + reach_m);
  if (!std::isfinite(times)) throw Error("the estimate's " + part + " has no point with finite coordinates");
  if (times > 200) refuse(part, times, "millimetres");
  if (times > 25) refuse(part, times, "centimetres");
  if (times < 0.01) refuse(part, times, "kilometres");
}

void check_surface(const Mesh& surface) {
  for (const Vec3& v : surface.vertex)
    if (!v.allFinite()) throw Error("the estimate's surface has a vertex that is no number");
  if (open_edges(surface) > 0) return;  // the volume says so
  if (const double m3 = enclosed_volume(surface); m3 < 0)
    throw Error("the estimate's surface is inside out: it encloses " + rounded(m3) +
                " m3; faces must be counter-clockwise seen from the rock, normals out of the void");
}

}  // namespace

void check_plausible(const Estimate& estimate, const PathMatch& match) {
  if (!estimate.covariance.empty() && estimate.covariance.size() != estimate.path.size())
    throw Error("the estimate has " + std::to_string(estimate.covariance.size()) + " covariances for " +
                std::to_string(estimate.path.size()) + " poses");
  check_path(match);
  check_extent("points", estimate.points.p, match);
  check_extent("surface", estimate.surface.vertex, match);
  if (!estimate.surface.face.empty()) check_surface(estimate.surface);
  if (const Grid& g = estimate.grid; g.cell_m > 5)
    throw Error("the estimate's grid has cells of " + rounded(g.cell_m) +
                " m: its resolution looks like millimetres or centimetres; adit takes metres");
}

}  // namespace adit
