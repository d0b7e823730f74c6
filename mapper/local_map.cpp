// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/local_map.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr double index_m = 0.25;         // cell of the index
constexpr double like = 0.5;             // cosine between normals of one rib
constexpr double surfel_sigma_m = 0.02;  // of a surfel about the surface that it makes with its neighbours
constexpr double rib_slope = 0.6;        // of that surface, away from upright, 1 sd
constexpr double upright = surfel_sigma_m * surfel_sigma_m / (rib_slope * rib_slope);

struct Bounds {
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 high = Vec2::Constant(-std::numeric_limits<double>::infinity());
  void add(const Vec2& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
};

// What falls into one fine cell.
struct Bin {
  Vec2 p = Vec2::Zero(), normal = Vec2::Zero(), first_normal;
  double z_m = 0, weight = 0, sigma_normal_rad = 0, count = 0;
  int scans = 0, last_scan = -1;
  int layer = 0;
  std::int32_t below = -1;  // another layer of the same cell
};

}  // namespace

LocalMap::LocalMap(std::span<const ScanPoints* const> scans, std::span<const Pose2> X_AB, double cell_m) {
  ADIT_CHECK(scans.size() == X_AB.size());
  std::vector<Vec2> p, normal;
  Bounds box;
  for (size_t i = 0; i < scans.size(); ++i) {
    const double c = std::cos(X_AB[i].yaw_rad), s = std::sin(X_AB[i].yaw_rad);
    for (size_t k = 0; k < scans[i]->size(); ++k) {
      const Vec2 &q = scans[i]->p_B[k], &n = scans[i]->normal_B[k];
      p.emplace_back(X_AB[i].x_m + c * q.x() - s * q.y(), X_AB[i].y_m + s * q.x() + c * q.y());
      normal.emplace_back(c * n.x() - s * n.y(), s * n.x() + c * n.y());
      box.add(p.back());
    }
  }
  if (p.empty()) return;
  const Vec2 low = box.low;
  const size_t width = static_cast<size_t>((box.high.x() - low.x()) / cell_m) + 1;
  const size_t height = static_cast<size_t>((box.high.y() - low.y()) / cell_m) + 1;
  std::vector<std::int32_t> bin_of(width * height, -1);
  std::vector<Bin> bins;
  bins.reserve(p.size() / 2);
  size_t at = 0;
  for (size_t i = 0; i < scans.size(); ++i)
    for (size_t k = 0; k < scans[i]->size(); ++k, ++at) {
      const Vec2 cell = (p[at] - low) / cell_m;
      const int layer = static_cast<int>(std::floor(scans[i]->z_m[k] / cell_m));
      std::int32_t& top = bin_of[static_cast<size_t>(cell.y()) * width + static_cast<size_t>(cell.x())];
      std::int32_t b = top;
      while (b >= 0 && bins[b].layer != layer) b = bins[b].below;
      if (b < 0) {
        b = static_cast<std::int32_t>(bins.size());
        Bin& bin = bins.emplace_back();
        bin.first_normal = normal[at], bin.layer = layer, bin.below = top;
        top = b;
      }
      Bin& bin = bins[b];
      if (bin.first_normal.dot(normal[at]) < like) continue;  // the far side of a thin wall
      const double w = 1 / (scans[i]->sigma_m[k] * scans[i]->sigma_m[k]);
      bin.p += w * p[at], bin.z_m += w * scans[i]->z_m[k], bin.normal += w * normal[at], bin.weight += w;
      bin.sigma_normal_rad += scans[i]->sigma_normal_rad[k], bin.count += 1;
      if (bin.last_scan != static_cast<int>(i)) bin.last_scan = static_cast<int>(i), ++bin.scans;
    }
  surfel_.reserve(bins.size());
  // Normals of one scan share their points, those of different scans do not.
  for (const Bin& b : bins)
    surfel_.push_back({b.p / b.weight, b.normal.normalized(), b.z_m / b.weight,
                       b.sigma_normal_rad / b.count / std::sqrt(double(b.scans))});
  index();
}

void LocalMap::index() {
  Bounds box;
  for (const Surfel& s : surfel_) box.add(s.p);
  low_ = box.low;
  width_ = static_cast<int>((box.high.x() - low_.x()) / index_m) + 1;
  height_ = static_cast<int>((box.high.y() - low_.y()) / index_m) + 1;
  const auto cell = [&](const Vec2& p) {
    return static_cast<size_t>((p.y() - low_.y()) / index_m) * width_ +
           static_cast<size_t>((p.x() - low_.x()) / index_m);
  };
  start_.assign(static_cast<size_t>(width_) * height_ + 1, 0);
  for (const Surfel& s : surfel_) ++start_[cell(s.p) + 1];
  for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
  std::vector<std::int32_t> next(start_.begin(), start_.end() - 1);
  std::vector<Surfel> sorted(surfel_.size());
  for (const Surfel& s : surfel_) sorted[next[cell(s.p)]++] = s;
  surfel_.swap(sorted);
}

std::optional<LocalMap::Rib> LocalMap::rib_near(const Vec2& p, double z_m, const Vec2& normal, double radius_m,
                                                double blend_m) const {
  const double x = (p.x() - low_.x()) / index_m, y = (p.y() - low_.y()) / index_m, reach = radius_m / index_m;
  if (!(x + reach >= 0 && y + reach >= 0 && x - reach < width_ && y - reach < height_)) return {};
  const int i0 = std::max(0, static_cast<int>(x - reach)), i1 = std::min(width_ - 1, static_cast<int>(x + reach));
  const int j0 = std::max(0, static_cast<int>(y - reach)), j1 = std::min(height_ - 1, static_cast<int>(y + reach));
  struct Near {
    double d2;  // in space
    double above_m;
    const Surfel* surfel;
  };
  std::array<Near, 256> near;  // more in so small a place tell nothing new
  size_t found = 0;
  double least = std::numeric_limits<double>::infinity(), least_in_plan = radius_m * radius_m;
  for (int j = j0; j <= j1; ++j) {
    const size_t row = static_cast<size_t>(j) * width_;
    for (std::int32_t k = start_[row + i0]; k < start_[row + i1 + 1]; ++k) {
      const Surfel& s = surfel_[k];
      const double dx = s.p.x() - p.x(), dy = s.p.y() - p.y();
      const double above_m = z_m - s.z_m;
      const double in_plan = dx * dx + dy * dy, d2 = in_plan + above_m * above_m;
      if (in_plan >= radius_m * radius_m || s.normal.x() * normal.x() + s.normal.y() * normal.y() <= like) continue;
      if (found < near.size()) near[found++] = {d2, above_m, &s};
      least = std::min(least, d2), least_in_plan = std::min(least_in_plan, in_plan);
    }
  }
  if (found == 0) return {};
  // The blend reaches over a few surfels, farther where they lie sparsely.
  const double reach2 = std::max(blend_m * blend_m, 2.5 * least);
  double weight = 0, r = 0, lean = 0, nx = 0, ny = 0;
  double z = 0, zz = 0, zr = 0;
  for (size_t k = 0; k < found; ++k) {
    const double t = 1 - near[k].d2 / reach2;
    if (t <= 0) continue;
    const Surfel& s = *near[k].surfel;
    const double w = t * t;
    weight += w;
    const double off_m = s.normal.x() * (p.x() - s.p.x()) + s.normal.y() * (p.y() - s.p.y());
    r += w * off_m;
    z += w * near[k].above_m, zz += w * near[k].above_m * near[k].above_m, zr += w * near[k].above_m * off_m;
    nx += w * s.normal.x(), ny += w * s.normal.y();
    lean += w * s.sigma_normal_rad;
  }
  const double length = std::sqrt(nx * nx + ny * ny);
  r /= weight, z /= weight, zz /= weight, zr /= weight;
  // Of a line of the distance over the height, its slope about zero, the value at the height of p.
  const double spread = zz - z * z + upright / weight;
  const double slope = (zr - z * r) / spread;
  return Rib{r - slope * z, Vec2(nx / length, ny / length), lean / weight, std::sqrt(least_in_plan),
             std::abs(z) * surfel_sigma_m / std::sqrt(weight * spread)};
}

}  // namespace adit
