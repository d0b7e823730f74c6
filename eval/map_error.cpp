// SPDX-License-Identifier: BSD-3-Clause
#include "eval/map_error.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr size_t grain = 1024;

// 1 / points in the same cube.
std::vector<float> density_weights(const std::vector<Vec3>& p, double edge_m) {
  struct Keyed {
    std::uint64_t key;
    std::uint32_t point;
    bool operator<(const Keyed& o) const { return key != o.key ? key < o.key : point < o.point; }
  };
  std::vector<Keyed> keyed(p.size());
  parallel_for(
      p.size(),
      [&](size_t i) {
        std::uint64_t key = 0;
        for (int k = 0; k < 3; ++k) {
          const double c = std::floor(p[i][k] / edge_m + 0.5) + (1 << 20);
          key = key << 21 | static_cast<std::uint64_t>(std::isfinite(c) ? std::clamp(c, 0.0, 2097151.0) : 0.0);
        }
        keyed[i] = {key, static_cast<std::uint32_t>(i)};
      },
      grain);
  std::sort(keyed.begin(), keyed.end());
  std::vector<float> weight(p.size());
  for (size_t begin = 0, end; begin < keyed.size(); begin = end) {
    end = begin;
    while (end < keyed.size() && keyed[end].key == keyed[begin].key) ++end;
    for (size_t k = begin; k < end; ++k) weight[keyed[k].point] = 1 / static_cast<float>(end - begin);
  }
  return weight;
}

bool inside(const Dexels& solid, const Vec3& p) {
  const Vec2 c = ((p.head<2>() - solid.origin) / solid.cell_m).array().floor();
  if (!(c.x() >= 0 && c.y() >= 0 && c.x() < solid.width && c.y() < solid.height)) return false;
  for (const Interval& s : solid.column(static_cast<int>(c.x()), static_cast<int>(c.y())))
    if (p.z() > s.low_m && p.z() < s.high_m) return true;
  return false;
}

// The points column by column of a raster over the plan, so that those that look at the same faces come after one another
// and find them in the cache; what is not finite comes last.
std::vector<std::uint32_t> neighbours_together(const std::vector<Vec3>& p) {
  constexpr double edge_m = 2;
  constexpr size_t most = 2048;  // columns a side; they are wider where the points are spread farther
  Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const Vec3& q : p)
    if (q.head<2>().allFinite()) low = low.cwiseMin(q.head<2>()), high = high.cwiseMax(q.head<2>());
  const Vec2 cell_m = ((high - low) / (most - 1)).cwiseMax(edge_m);
  const size_t across = static_cast<size_t>(std::max(0.0, (high - low).y() / cell_m.y())) + 1;
  std::vector<std::uint32_t> column(p.size());
  std::vector<std::uint32_t> begin(most * across + 2);
  for (size_t i = 0; i < p.size(); ++i) {
    const Vec2 c = (p[i].head<2>() - low).cwiseQuotient(cell_m);
    column[i] = static_cast<std::uint32_t>(
        c.allFinite() ? static_cast<size_t>(c.x()) * across + static_cast<size_t>(c.y()) : most * across);
    ++begin[column[i] + 1];
  }
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<std::uint32_t> order(p.size());
  for (size_t i = 0; i < p.size(); ++i) order[begin[column[i]]++] = static_cast<std::uint32_t>(i);
  return order;
}

// Near first: a small radius prunes best.
std::optional<Closest> nearest(const Caster& caster, const Vec3& p, const std::optional<Vec3>& seen_along) {
  constexpr double everywhere = 1e6;
  for (const double radius_m : {0.5, 5.0, everywhere})
    if (const auto found = caster.closest(p, radius_m, seen_along)) return found;
  return seen_along ? nearest(caster, p, {}) : std::nullopt;
}

// The statistics of signed distances.
void add_distances(const MetricList& list, std::vector<double> signed_m, const std::string& why) {
  const auto n = static_cast<std::int64_t>(signed_m.size());
  const double count = n ? static_cast<double>(n) : none;
  double sum = 0, squares = 0;
  for (const double e : signed_m) sum += e, squares += e * e;
  for (double& e : signed_m) e = std::abs(e);
  double absolute = 0;
  for (const double e : signed_m) absolute += e;
  const auto add = [&](const std::string& name, double value, const std::string& unit, Better better) {
    list.add(name, value, unit, better, n, why);
  };
  add("bias_m", sum / count, "m", Better::lower);
  add("mae_m", absolute / count, "m", Better::lower);
  add("rmse_m", std::sqrt(squares / count), "m", Better::lower);
  for (const int p : {50, 95, 99})
    add("p" + std::to_string(p) + "_m", quantile(signed_m, p / 100.0), "m", Better::lower);
  for (const int cm : {2, 5, 10, 20}) {
    const auto within = std::count_if(signed_m.begin(), signed_m.end(), [&](double e) { return e <= cm / 100.0; });
    add("within_" + std::to_string(cm) + "cm", static_cast<double>(within) / count, "share", Better::higher);
  }
}

std::string threshold_name(double tau_m) {
  return std::to_string(std::lround(tau_m * 100)) + "cm";
}

// What precision and recall count at one threshold; all weighted by area.
struct Counts {
  double right = 0, wrong = 0, unobserved = 0;  // of the map
  std::int64_t points = 0;
};

bool far_and_unknown(const LaidPoints& laid, size_t i, const Observable& observable) {
  return !laid.phantom[i] && !observable.seen(laid.patch[i]);
}

Counts count_points(const MapPoints& points, const LaidPoints& laid, const Observable& observable, double tau_m) {
  Counts c;
  for (size_t i = 0; i < points.size(); ++i) {
    if (laid.face[i] < 0) continue;
    ++c.points;
    const double w = static_cast<double>(points.weight[i]);
    if (std::abs(laid.error_m[i]) <= tau_m)
      c.right += w;
    else if (far_and_unknown(laid, i, observable))
      c.unobserved += w;
    else
      c.wrong += w;
  }
  return c;
}

// Patches on which a point within the threshold has its foot.
std::vector<char> recalled(const LaidPoints& laid, size_t patches, double tau_m) {
  std::vector<char> found(patches, 0);
  for (size_t i = 0; i < laid.face.size(); ++i)
    if (laid.face[i] >= 0 && std::abs(laid.error_m[i]) <= tau_m) found[laid.patch[i]] = 1;
  return found;
}

struct Recall {
  double share = none;
  std::int64_t patches = 0;
};

Recall recall_of(const std::vector<char>& found, const Patches& patches, const Observable& observable,
                 std::optional<Label> label, int beams = 1) {
  double seen = 0, both = 0;
  Recall recall;
  for (std::uint32_t p = 0; p < patches.size(); ++p) {
    if (!observable.seen(p, beams) || (label && patches.label(p) != *label)) continue;
    ++recall.patches;
    seen += patches.area_m2(p);
    if (found[p]) both += patches.area_m2(p);
  }
  if (seen > 0) recall.share = both / seen;
  return recall;
}

void add_threshold(const MetricList& list, double tau_m, const MapPoints& points, const LaidPoints& laid,
                   const Patches& patches, const Observable& observable, const std::vector<char>& found,
                   const std::string& why) {
  const Counts c = count_points(points, laid, observable, tau_m);
  const double judged = c.right + c.wrong;
  const double precision = judged > 0 ? c.right / judged : none;
  const Recall recall = recall_of(found, patches, observable, {});
  const double sum = precision + recall.share;
  const std::string name = threshold_name(tau_m);
  const std::string no_point = why.empty() ? "no point lies where it could be judged" : why;
  const std::string unseen = why.empty() ? "no surface was observable" : why;
  list.add("precision_" + name, precision, "share", Better::higher, c.points, no_point);
  list.add("recall_" + name, why.empty() ? recall.share : none, "share", Better::higher, recall.patches, unseen);
  const Recall well_seen = recall_of(found, patches, observable, {}, 3);
  list.add("recall3_" + name, why.empty() ? well_seen.share : none, "share", Better::higher, well_seen.patches, unseen);
  list.add("f_" + name, sum > 0 ? 2 * precision * recall.share / sum : (sum == 0 ? 0 : none), "share", Better::higher,
           c.points, std::isfinite(precision) ? unseen : no_point);
}

}  // namespace

MapPoints map_points(const PointCloud& points, const Trajectory& path_M, const Rig& nominal, double patch_m) {
  MapPoints map;
  map.p_M = points.p;
  if (points.stamp_s.size() == points.size()) map.stamp_s = points.stamp_s;
  map.weight = density_weights(points.p, patch_m);
  if (map.stamp_s.empty() || points.laser.size() != points.size() || path_M.empty() || nominal.mounts.empty())
    return map;
  map.seen_M.resize(points.size());
  parallel_for(
      points.size(),
      [&](size_t i) {
        if (points.laser[i] >= nominal.mounts.size())
          throw Error("point " + std::to_string(i) + " of the map names laser " + std::to_string(points.laser[i]) +
                      ", the rig has " + std::to_string(nominal.mounts.size()));
        const Vec3 from = path_M.at(points.stamp_s[i]) * nominal.mounts[points.laser[i]].X_BS.translation();
        map.seen_M[i] = (points.p[i] - from).normalized();
      },
      grain);
  return map;
}

LaidPoints lay(const MapPoints& points, const std::function<const Pose&(size_t)>& X_WM, const Surface& surface,
               const Patches& patches, const VolumeDomain* domain) {
  const size_t n = points.size();
  LaidPoints laid{std::vector<float>(n, static_cast<float>(none)), std::vector<std::int32_t>(n, -1),
                  std::vector<std::uint32_t>(n, 0), std::vector<std::uint8_t>(n, 0),
                  std::vector<Vec3>(n, Vec3::Zero())};
  const auto place = [&](size_t i) {
    std::pair<Vec3, std::optional<Vec3>> p_and_seen{X_WM(i) * points.p_M[i], {}};
    if (!points.seen_M.empty() && points.seen_M[i].allFinite()) p_and_seen.second = X_WM(i).linear() * points.seen_M[i];
    return p_and_seen;
  };
  const auto put = [&](size_t i, const Vec3& p, const Closest& found) {
    const double side = (found.point - p).dot(surface.mesh.normal(static_cast<size_t>(found.face)));
    laid.error_m[i] = static_cast<float>(side < 0 ? -found.distance_m : found.distance_m);
    laid.face[i] = found.face;
    laid.foot_W[i] = found.point;
    laid.patch[i] = patches.at(found.face, found.point);
    laid.phantom[i] = domain && inside(domain->swept, p);
  };
  const std::vector<std::uint32_t> order = neighbours_together(points.p_M);
  std::vector<std::vector<std::uint32_t>> far((n + grain - 1) / grain);  // of the grid's reach
  parallel_chunks(n, grain, [&](size_t begin, size_t end) {
    for (size_t k = begin; k < end; ++k) {
      const size_t i = order[k], soon = order[std::min(k + 16, n - 1)];
      // They lie in the order of the file, far from one another.
      __builtin_prefetch(&points.p_M[soon]);
      if (!points.seen_M.empty()) __builtin_prefetch(&points.seen_M[soon]);
      __builtin_prefetch(&laid.error_m[soon], 1), __builtin_prefetch(&laid.face[soon], 1);
      __builtin_prefetch(&laid.foot_W[soon], 1), __builtin_prefetch(&laid.patch[soon], 1);
      const auto [p, seen_along] = place(i);
      if (!p.allFinite()) continue;
      if (const auto found = surface.grid.closest(p, seen_along))
        put(i, p, *found);
      else
        far[begin / grain].push_back(static_cast<std::uint32_t>(i));
    }
  });
  std::vector<std::uint32_t> rest;
  for (const auto& some : far) rest.insert(rest.end(), some.begin(), some.end());
  if (rest.empty()) return laid;
  std::optional<Caster> own;
  const Caster& caster = surface.caster ? *surface.caster : own.emplace(surface.mesh);
  parallel_for(
      rest.size(),
      [&](size_t k) {
        const auto [p, seen_along] = place(rest[k]);
        if (const auto found = nearest(caster, p, seen_along)) put(rest[k], p, *found);
      },
      grain / 8);
  return laid;
}

void add_map(const MetricList& list, const MapPoints& points, const LaidPoints& laid, const Mesh& mesh,
             const Patches& patches, const Observable& observable, const ScoreSettings& settings,
             const std::string& why) {
  std::vector<double> all;
  std::map<Label, std::vector<double>> by_label;
  for (const Label label : std::set<Label>(mesh.label.begin(), mesh.label.end())) by_label[label];
  for (size_t i = 0; i < laid.face.size(); ++i) {
    if (laid.face[i] < 0) continue;
    all.push_back(static_cast<double>(laid.error_m[i]));
    if (!mesh.label.empty()) by_label[mesh.label[static_cast<size_t>(laid.face[i])]].push_back(all.back());
  }
  add_distances(list, std::move(all), why);
  double widest_m = 0;
  for (const double tau_m : settings.thresholds_m) {
    const std::vector<char> found = recalled(laid, patches.size(), tau_m);
    add_threshold(list, tau_m, points, laid, patches, observable, found, why);
    for (const auto& [label, errors] : by_label) {
      const Recall recall = recall_of(found, patches, observable, label);
      list.under("by_label")
          .under(label_name(label))
          .add("recall_" + threshold_name(tau_m), why.empty() ? recall.share : none, "share", Better::higher,
               recall.patches, why.empty() ? "nothing of it was observable" : why);
    }
    widest_m = std::max(widest_m, tau_m);
  }
  const Counts c = count_points(points, laid, observable, widest_m);
  const double weight = c.right + c.wrong + c.unobserved;
  double phantom = 0;
  for (size_t i = 0; i < points.size(); ++i)
    if (laid.face[i] >= 0 && laid.phantom[i] && std::abs(laid.error_m[i]) > widest_m)
      phantom += static_cast<double>(points.weight[i]);
  list.add("phantom_share", weight > 0 ? phantom / weight : none, "share", Better::lower, c.points, why);
  list.add("unobserved_share", weight > 0 ? c.unobserved / weight : none, "share", Better::lower, c.points, why);
  for (auto& [label, errors] : by_label)
    add_distances(list.under("by_label").under(label_name(label)), std::move(errors),
                  why.empty() ? "no point of the map is nearest to it" : why);
}

const Pose& Windows::at(double stamp_s) const {
  ADIT_CHECK(!X_WM.empty());
  const auto next = std::upper_bound(from_s.begin(), from_s.end(), stamp_s);
  return X_WM[next == from_s.begin() ? 0 : static_cast<size_t>(next - from_s.begin()) - 1];
}

Windows windows_of(const PathMatch& match, double window_m) {
  Windows windows;
  for (size_t begin = 0, end; begin < match.size(); begin = end) {
    end = begin;
    constexpr double rounding_m = 1e-6;
    const double until_m = (std::floor((match.along_m[begin] + rounding_m) / window_m) + 1) * window_m - rounding_m;
    while (end < match.size() && (end == begin || match.along_m[end] < until_m)) ++end;
    windows.from_s.push_back(match.stamp_s[begin]);
    windows.X_WM.push_back(align_mean_pose(match, begin, end));
  }
  return windows;
}

}  // namespace adit
