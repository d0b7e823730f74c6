// SPDX-License-Identifier: BSD-3-Clause
#include "eval/volume_error.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double jump_m = 0.5;  // ends of neighbouring beams farther apart lie on two surfaces
constexpr double key_m = 0.05, key_rad = 5 * std::numbers::pi / 180;  // scans that moved by less span nothing yet

double area(const Vec3& a, const Vec3& b, const Vec3& c) {
  return (b - a).cross(c - a).norm() / 2;
}

// The prism between beams k and k + 1 of two scans: triangles (origin, end, end) joined. One that is thinner than
// thin_m, as between fans that move within their own plane, is left out: it holds next to nothing and covers many
// columns.
void add_prism(const std::array<TrueBeam, 4>& beam, double thin_m, std::vector<Tetrahedron>& out) {
  double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
  for (const TrueBeam& b : beam) {
    if (!b.met) return;
    nearest = std::min(nearest, b.range_m);
    farthest = std::max(farthest, b.range_m);
  }
  const bool jumps = farthest - nearest > jump_m;
  const auto end = [&](const TrueBeam& b) { return b.origin + (jumps ? nearest : b.range_m) * b.direction; };
  const Vec3 &o = beam[0].origin, &p = beam[2].origin;
  const Vec3 a = end(beam[0]), b = end(beam[1]), c = end(beam[2]), d = end(beam[3]);
  const std::array<Tetrahedron, 3> parts{{{o, a, b, d}, {o, a, d, c}, {o, c, d, p}}};
  const double thickness_m = (enclosed_volume(parts[0]) + enclosed_volume(parts[1]) + enclosed_volume(parts[2])) /
                             std::max(area(o, a, b), area(p, c, d));
  if (thickness_m > thin_m) out.insert(out.end(), parts.begin(), parts.end());
}

// A scan that has moved from the key scan before it enough to span something.
struct KeyScan {
  size_t scan;
  bool joined;  // to the key scan before: no two scans in between lie more than step_m apart
};

std::vector<KeyScan> key_scans(const TrueScans& scans, size_t laser, double step_m) {
  std::vector<KeyScan> keys;
  Pose last, before;
  bool joined = false;
  for (size_t i = 0; i < scans.scans(laser); ++i) {
    const Pose X = scans.X_WS(laser, i);
    joined = joined && (X.translation() - before.translation()).norm() <= step_m;
    before = X;
    const bool still = !keys.empty() && (X.translation() - last.translation()).norm() < key_m &&
                       Eigen::AngleAxisd(last.linear().transpose() * X.linear()).angle() < key_rad;
    if (still) continue;
    keys.push_back({i, joined});
    last = X;
    joined = true;
  }
  return keys;
}

std::vector<Tetrahedron> between(const std::vector<TrueBeam>& one, const std::vector<TrueBeam>& next, double thin_m) {
  std::vector<Tetrahedron> out;
  for (size_t k = 0; k + 1 < one.size(); ++k) add_prism({one[k], one[k + 1], next[k], next[k + 1]}, thin_m, out);
  return out;
}

Dexels swept_by(const TrueScans& scans, const Dexels& like, const ScoreSettings& settings, const Progress& progress) {
  DexelUnion swept(like);
  constexpr size_t batch = 256;
  for (size_t l = 0; l < scans.lasers(); ++l) {
    const LaserModel& laser = scans.mount(l).laser;
    const double spacing_rad = laser.fov_rad / (laser.beams - 1);
    const double wanted_rad = settings.domain_beam_deg * std::numbers::pi / 180;
    const int step = std::max(1, static_cast<int>(std::lround(wanted_rad / spacing_rad)));
    const std::vector<KeyScan> keys = key_scans(scans, l, settings.domain_step_m);
    for (size_t begin = 0; begin + 1 < keys.size(); begin += batch) {
      const size_t n = std::min(batch, keys.size() - 1 - begin);
      std::vector<std::vector<TrueBeam>> fans(n + 1);
      std::vector<std::vector<Tetrahedron>> prisms(n);
      parallel_for(
          n + 1, [&](size_t k) { fans[k] = scans.fan(l, keys[begin + k].scan, step); }, 8);
      parallel_for(
          n,
          [&](size_t k) {
            if (keys[begin + k + 1].joined) prisms[k] = between(fans[k], fans[k + 1], settings.domain_cell_m / 4);
          },
          8);
      std::vector<Tetrahedron> all;
      for (const auto& some : prisms) all.insert(all.end(), some.begin(), some.end());
      swept.add(all);
      const double share = static_cast<double>(begin + n) / static_cast<double>(keys.size() - 1);
      progress("score: domain", static_cast<double>(l) + share, static_cast<double>(scans.lasers()));
    }
  }
  return swept.solid();
}

// The balls of radius_m about the middles of all patches that were seen.
Dexels near_surface(const Patches& patches, const Observable& observable, double radius_m, const Dexels& like) {
  constexpr int tile = 64;  // columns
  const int across = (like.width + tile - 1) / tile, down = (like.height + tile - 1) / tile;
  std::vector<std::vector<std::uint32_t>> of_tile(static_cast<size_t>(across) * down);
  const auto range = [&](double middle, double origin, int count) {  // columns whose axis may lie within the ball
    const double low = (middle - radius_m - origin) / like.cell_m - 0.5,
                 high = (middle + radius_m - origin) / like.cell_m - 0.5;
    return std::array<int, 2>{static_cast<int>(std::clamp(std::ceil(low), 0.0, double(count))),
                              static_cast<int>(std::clamp(std::floor(high) + 1, 0.0, double(count)))};
  };
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    if (!observable.seen(p)) continue;
    const auto i = range(patches.centre(p).x(), like.origin.x(), like.width),
               j = range(patches.centre(p).y(), like.origin.y(), like.height);
    if (i[0] >= i[1] || j[0] >= j[1]) continue;
    for (int tj = j[0] / tile; tj * tile < j[1]; ++tj)
      for (int ti = i[0] / tile; ti * tile < i[1]; ++ti) of_tile[static_cast<size_t>(tj) * across + ti].push_back(p);
  }
  std::vector<std::vector<Interval>> columns(like.columns());
  parallel_for(of_tile.size(), [&](size_t t) {
    const int i0 = static_cast<int>(t % across) * tile, j0 = static_cast<int>(t / across) * tile;
    const int i1 = std::min(like.width, i0 + tile), j1 = std::min(like.height, j0 + tile);
    std::vector<std::vector<Interval>> met(static_cast<size_t>(tile) * tile);
    for (const std::uint32_t p : of_tile[t]) {
      const Vec3& c = patches.centre(p);
      const auto i = range(c.x(), like.origin.x(), like.width), j = range(c.y(), like.origin.y(), like.height);
      for (int b = std::max(j[0], j0); b < std::min(j[1], j1); ++b)
        for (int a = std::max(i[0], i0); a < std::min(i[1], i1); ++a) {
          const double square = radius_m * radius_m - (like.axis(a, b) - c.head<2>()).squaredNorm();
          if (square <= 0) continue;
          const double half = std::sqrt(square);
          met[static_cast<size_t>(b - j0) * tile + (a - i0)].push_back({c.z() - half, c.z() + half});
        }
    }
    for (int b = j0; b < j1; ++b)
      for (int a = i0; a < i1; ++a) {
        auto& pieces = met[static_cast<size_t>(b - j0) * tile + (a - i0)];
        std::sort(pieces.begin(), pieces.end(), [](const Interval& x, const Interval& y) { return x.low_m < y.low_m; });
        auto& column = columns[like.index(a, b)];
        for (const Interval& s : pieces)
          if (!column.empty() && s.low_m <= column.back().high_m)
            column.back().high_m = std::max(column.back().high_m, s.high_m);
          else
            column.push_back(s);
      }
  });
  return dexels_of(columns, like);
}

// Each column goes to the passage whose centre line is nearest.
std::vector<PassageVolume> shares_of(const Dexels& swept, const std::vector<const Dexels*>& mapped,
                                     const PassageMap& passages) {
  if (passages.empty()) return {};
  std::vector<int> owner(swept.columns(), -1);
  parallel_for(
      static_cast<size_t>(swept.height),
      [&](size_t j) {
        for (int i = 0; i < swept.width; ++i) {
          const size_t c = swept.index(i, static_cast<int>(j));
          bool any = !swept.column(c).empty();
          for (const Dexels* d : mapped) any = any || !d->column(c).empty();
          if (any) owner[c] = passages.locate(swept.axis(i, static_cast<int>(j))).passage;
        }
      },
      16);
  std::vector<PassageVolume> shares(passages.size(), {0, mapped.empty() ? none : 0});
  const auto height = [](std::span<const Interval> column) {
    double sum = 0;
    for (const Interval& s : column) sum += s.high_m - s.low_m;
    return sum;
  };
  const double cell_m2 = swept.cell_m * swept.cell_m;
  for (size_t c = 0; c < owner.size(); ++c) {
    if (owner[c] < 0) continue;
    PassageVolume& share = shares[static_cast<size_t>(owner[c])];
    share.observable_m3 += cell_m2 * height(swept.column(c));
    for (const Dexels* d : mapped) share.mapped_m3 += cell_m2 * height(d->column(c));
  }
  return shares;
}

}  // namespace

VolumeDomain volume_domain(const Mesh& mesh, const Patches& patches, const Observable& observable,
                           const TrueScans& scans, const ScoreSettings& settings, const Progress& progress) {
  if (const size_t open = open_edges(mesh); open > 0)
    throw Error("the mine's mesh has " + std::to_string(open) + " open edges: it encloses no volume");
  Vec2 low = mesh.vertex.at(0).head<2>(), high = low;
  for (const Vec3& v : mesh.vertex) low = low.cwiseMin(v.head<2>()), high = high.cwiseMax(v.head<2>());
  const Vec2 margin = Vec2::Constant(settings.domain_rock_m + settings.domain_cell_m);
  const Dexels like = empty_dexels(low - margin, high + margin, settings.domain_cell_m);
  const Dexels space = dexels_of(mesh, like);
  Dexels swept = intersect(swept_by(scans, like, settings, progress), space);
  Dexels rock = subtract(near_surface(patches, observable, settings.domain_rock_m, like), space);
  return {std::move(swept), std::move(rock), space};
}

std::vector<PassageVolume> add_volume(const MetricList& list, double true_m3, const std::optional<VolumeDomain>& domain,
                                      const std::string& why, const std::optional<Mesh>& mapped,
                                      const std::string& why_unmapped, std::optional<double> claimed_m3,
                                      std::optional<double> claimed_sigma_m3, const PassageMap& passages) {
  std::vector<PassageVolume> shares;
  double observable_m3 = none, mapped_m3 = none, over_m3 = none, under_m3 = none, extrapolated_m3 = none,
         unseen_m3 = none;
  std::int64_t columns = 0;
  std::string reason = why.empty() ? why_unmapped : why;
  if (domain) {
    observable_m3 = domain->swept.volume_m3();
    columns = static_cast<std::int64_t>(domain->swept.interval.size());
  }
  if (domain && mapped) {
    const Dexels solid = dexels_of(*mapped, domain->swept);
    const Dexels right = intersect(solid, domain->swept), over = intersect(solid, domain->rock);
    const double right_m3 = right.volume_m3();
    over_m3 = over.volume_m3();
    under_m3 = observable_m3 - right_m3;
    mapped_m3 = right_m3 + over_m3;
    extrapolated_m3 = enclosed_volume(*mapped) - mapped_m3;
    unseen_m3 = domain->space.offset.empty() ? 0 : intersect(solid, domain->space).volume_m3() - right_m3;
    shares = shares_of(domain->swept, {&right, &over}, passages);
  } else if (domain) {
    shares = shares_of(domain->swept, {}, passages);
  }
  const auto add = [&](const std::string& name, double value, const std::string& unit, Better better,
                       const std::string& because) { list.add(name, value, unit, better, columns, because); };
  add("true_m3", true_m3, "m3", Better::higher, why);
  add("observable_m3", observable_m3, "m3", Better::higher, why);
  add("mapped_m3", mapped_m3, "m3", Better::higher, reason);
  add("error_percent", observable_m3 > 0 ? 100 * (mapped_m3 - observable_m3) / observable_m3 : none, "percent",
      Better::lower, reason.empty() ? "nothing was observable" : reason);
  add("overbreak_m3", over_m3, "m3", Better::lower, reason);
  add("underbreak_m3", under_m3, "m3", Better::lower, reason);
  add("iou", observable_m3 > 0 ? (mapped_m3 - over_m3) / (observable_m3 + over_m3) : none, "share", Better::higher,
      reason.empty() ? "nothing was observable" : reason);
  add("extrapolated_m3", extrapolated_m3, "m3", Better::lower, reason);
  add("unseen_void_m3", unseen_m3, "m3", Better::lower, reason);
  const std::string unclaimed = "the mapper names no volume";
  add("claimed_m3", claimed_m3.value_or(none), "m3", Better::higher, unclaimed);
  add("sigma_percent", claimed_m3 && claimed_sigma_m3 && *claimed_m3 > 0 ? 100 * *claimed_sigma_m3 / *claimed_m3 : none,
      "percent", Better::lower, claimed_m3 ? "the mapper names no sigma" : unclaimed);
  const double off =
      claimed_m3 && claimed_sigma_m3 && *claimed_sigma_m3 > 0
          ? (*claimed_m3 - observable_m3 - (std::isfinite(unseen_m3) ? unseen_m3 : 0)) / *claimed_sigma_m3
          : none;
  const std::string no_claim = !why.empty() ? why : claimed_m3 ? "the mapper names no sigma" : unclaimed;
  add("claim_sigmas", off, "ratio", Better::lower, no_claim);
  add("claim_holds_95", std::isfinite(off) ? std::abs(off) <= 1.96 : none, "share", Better::higher, no_claim);
  return shares;
}

}  // namespace adit
