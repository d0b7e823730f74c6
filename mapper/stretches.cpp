// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/stretches.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr double step_s = 0.1, sample_m = 0.5, bucket_m = 4;
constexpr double least_m = 3;        // of a stretch
constexpr double beside_m = 1.2;     // passes of one passage
constexpr double parallel = 0.7071;  // cosine
constexpr size_t chord = 3;          // samples to either side that tell the direction
constexpr size_t fresh = 12;         // samples: nearer ones along the path are no earlier pass

}  // namespace

/// visit(sample) for the buckets of one ring about that of p.
template <typename Visit>
void Stretches::around(const Vec2& p, int ring, Visit&& visit) const {
  const int i = static_cast<int>(std::floor((p.x() - origin_.x()) / bucket_m)),
            j = static_cast<int>(std::floor((p.y() - origin_.y()) / bucket_m));
  for (int b = std::max(0, j - ring); b <= std::min(height_ - 1, j + ring); ++b)
    for (int a = std::max(0, i - ring); a <= std::min(width_ - 1, i + ring); ++a)
      if (std::max(std::abs(a - i), std::abs(b - j)) == ring)
        for (const std::uint32_t n : bucket_[static_cast<size_t>(b) * width_ + a]) visit(n);
}

/// Stretch of an earlier pass beside a sample, or -1.
int Stretches::driven_before(const Sample& here, size_t until) const {
  int found = -1;
  double least = beside_m;
  for (const int ring : {0, 1})
    around(here.p, ring, [&](std::uint32_t n) {
      const double away = (sample_[n].p - here.p).norm();
      if (n >= until || !(away < least) || !(std::abs(sample_[n].direction.dot(here.direction)) > parallel)) return;
      least = away;
      found = sample_[n].stretch;
    });
  return found;
}

Stretches::Stretches(const Trajectory& X_MB) {
  ADIT_CHECK(!X_MB.empty());
  std::vector<double> stamp_s;
  // Evenly in time: the same stretches however densely the path is told.
  for (double t = X_MB.stamp_s.front(); t <= X_MB.stamp_s.back(); t += step_s) {
    const Vec2 p = X_MB.at(t).translation().head<2>();
    if (!sample_.empty() && (p - sample_.back().p).norm() < sample_m) continue;
    sample_.push_back({p, Vec2::UnitX(), -1});
    stamp_s.push_back(t);
  }
  Eigen::AlignedBox2d box;
  for (const Sample& s : sample_) box.extend(s.p);
  origin_ = box.min();
  width_ = static_cast<int>(box.sizes().x() / bucket_m) + 1;
  height_ = static_cast<int>(box.sizes().y() / bucket_m) + 1;
  bucket_.resize(static_cast<size_t>(width_) * height_);

  Vec2 mean = Vec2::Zero();
  int before = -1;     // stretch of the sample before
  bool again = false;  // it had been driven earlier
  for (size_t n = 0; n < sample_.size(); ++n) {
    Sample& here = sample_[n];
    const Vec2 ahead = sample_[std::min(n + chord, sample_.size() - 1)].p - sample_[n - std::min(n, chord)].p;
    if (ahead.norm() > 0) here.direction = ahead.normalized();
    const int old = n > fresh ? driven_before(here, n - fresh) : -1;
    if (old >= 0) {
      here.stretch = old;
    } else {
      const bool turned = mean.norm() > 0 && std::abs(mean.normalized().dot(here.direction)) < parallel;
      if (before < 0 || again || turned) {
        stretch_.push_back({stamp_s[n], stamp_s[n], 0});
        mean = Vec2::Zero();
      }
      here.stretch = static_cast<int>(stretch_.size()) - 1;
      mean += mean.dot(here.direction) < 0 ? Vec2(-here.direction) : here.direction;
      Stretch& own = stretch_.back();
      if (own.to_s < stamp_s[n] && n > 0) own.length_m += (here.p - sample_[n - 1].p).norm();
      own.to_s = stamp_s[n];
    }
    again = old >= 0;
    before = here.stretch;
    keep(n);
  }
  drop_short();
}

void Stretches::keep(size_t n) {
  const Vec2 at = (sample_[n].p - origin_) / bucket_m;
  bucket_[static_cast<size_t>(at.y()) * width_ + static_cast<size_t>(at.x())].push_back(static_cast<std::uint32_t>(n));
}

/// Turning about at a corner makes stretches of next to no length: what lies there belongs to those beside it.
void Stretches::drop_short() {
  std::vector<int> number(stretch_.size(), -1);
  std::vector<Stretch> kept;
  for (size_t k = 0; k < stretch_.size(); ++k)
    if (stretch_[k].length_m >= least_m) {
      number[k] = static_cast<int>(kept.size());
      kept.push_back(stretch_[k]);
    }
  if (kept.empty()) return;
  for (Sample& s : sample_) s.stretch = number[s.stretch];
  for (auto& bucket : bucket_) std::erase_if(bucket, [&](std::uint32_t n) { return sample_[n].stretch < 0; });
  stretch_ = std::move(kept);
}

int Stretches::nearest(const Vec2& p_M) const {
  int found = 0;
  double least = std::numeric_limits<double>::infinity();
  const int rings = static_cast<int>(std::max({std::abs(p_M.x() - origin_.x()), std::abs(p_M.y() - origin_.y()),
                                               bucket_m * width_, bucket_m * height_}) /
                                     bucket_m) +
                    width_ + height_;
  // What lies in ring r is at least (r - 1) buckets away.
  for (int ring = 0; ring <= rings && (ring - 1) * bucket_m <= least; ++ring)
    around(p_M, ring, [&](std::uint32_t n) {
      const double away = (sample_[n].p - p_M).norm();
      if (!(away < least)) return;
      least = away;
      found = sample_[n].stretch;
    });
  return found;
}

}  // namespace adit
