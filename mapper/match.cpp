// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/match.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace adit {
namespace {

using Mat3 = Eigen::Matrix3d;
constexpr double inf = std::numeric_limits<double>::infinity();

// The cost about one pose: sum of w (r / sigma)^2, its slope and curvature in e of X * (ex, ey, eyaw).
struct Linear {
  Mat3 H = Mat3::Zero();        // curvature
  Mat3 H_noise = Mat3::Zero();  // what noisy normals alone add to it on average
  Vec3 g = Vec3::Zero();        // the step that the data ask for is H^-1 g
  double weights = 0, squares = 0;
  double inlier_squares_m2 = 0;
  int pairs = 0, inliers = 0;
};

Linear linearise(const ScanPoints& scan, const LocalMap& map, const Pose2& X, double gate_m, const MatchSettings& s) {
  Linear out;
  const double c = std::cos(X.yaw_rad), sn = std::sin(X.yaw_rad);
  const double map_var = s.map_sigma_m * s.map_sigma_m;
  const double robust_var = s.robust_sigmas * s.robust_sigmas;
  for (size_t k = 0; k < scan.size(); ++k) {
    const Vec2 &p = scan.p_B[k], &m = scan.normal_B[k];
    const Vec2 q(X.x_m + c * p.x() - sn * p.y(), X.y_m + sn * p.x() + c * p.y());
    const std::optional<LocalMap::Rib> rib =
        map.rib_near(q, scan.z_m[k], Vec2(c * m.x() - sn * m.y(), sn * m.x() + c * m.y()), gate_m);
    if (!rib) continue;
    ++out.pairs;
    const double r = rib->distance_m;
    const double lean = rib->sigma_normal_rad * rib->nearest_m;
    const double var = scan.sigma_m[k] * scan.sigma_m[k] + map_var + lean * lean + rib->sigma_m * rib->sigma_m;
    const double chi2 = r * r / var;
    const double root_w = 1 / (1 + chi2 / robust_var);  // Geman-McClure
    const double w = root_w * root_w;
    const Vec2 n(c * rib->normal.x() + sn * rib->normal.y(), -sn * rib->normal.x() + c * rib->normal.y());
    const Vec3 J(n.x(), n.y(), n.y() * p.x() - n.x() * p.y());
    const Vec3 J_turned(-n.y(), n.x(), n.x() * p.x() + n.y() * p.y());
    out.H.noalias() += (w / var) * J * J.transpose();
    out.H_noise.noalias() +=
        (w / var * rib->sigma_normal_rad * rib->sigma_normal_rad) * J_turned * J_turned.transpose();
    out.g -= (w / var * r) * J;
    out.weights += w;
    out.squares += w * chi2;
    if (chi2 < 9) ++out.inliers, out.inlier_squares_m2 += r * r;
  }
  return out;
}

// How well the data alone hold the position, yaw being free.
struct Weakness {
  double sigma_m = inf;
  Vec2 direction = Vec2::UnitX();
  double information = 0;      // 1 / m^2 along it, noise of the normals taken off; >= 0
  double information_raw = 0;  // with it
};

Weakness weakness_of(const Linear& at) {
  Weakness out;
  const auto marginal = [](const Mat3& H) -> Eigen::Matrix2d {
    if (!(H(2, 2) > 0)) return Eigen::Matrix2d::Zero();
    return H.topLeftCorner<2, 2>() - H.block<2, 1>(0, 2) * H.block<1, 2>(2, 0) / H(2, 2);
  };
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> honest;
  honest.computeDirect(marginal(at.H - at.H_noise));  // closed form
  out.direction = honest.eigenvectors().col(0);
  out.information = std::max(0.0, honest.eigenvalues()[0]);
  out.information_raw = std::max(out.information, out.direction.dot(marginal(at.H) * out.direction));
  if (out.information > 0) out.sigma_m = 1 / std::sqrt(out.information);
  return out;
}

// Takes out of the data what they say along the weak direction beyond its honest share.
void hold_weak(Linear& at, const Weakness& weak) {
  const Vec3 v(weak.direction.x(), weak.direction.y(), 0);
  const Mat3 keep = Mat3::Identity() - v * v.transpose();
  const double share = weak.information_raw > 0 ? weak.information / weak.information_raw : 0;
  const Mat3 kept = keep * at.H;
  at.H = kept * keep;
  at.H += weak.information * v * v.transpose();
  at.g = keep * at.g + share * v.dot(at.g) * v;
}

Vec3 error_between(const Pose2& X, const Pose2& X_true) {
  const Pose2 e = X.inverse() * X_true;
  return {e.x_m, e.y_m, e.yaw_rad};
}

// One step of the pose; where nothing else holds a direction, it stays.
Vec3 solve_step(const Linear& at, const Pose2& X, const PosePrior& prior) {
  const Mat3 damping = Vec3(1e-3, 1e-3, 1e-3).asDiagonal();
  const Mat3 H = at.H + prior.information + damping;
  return H.ldlt().solve(at.g + prior.information * error_between(X, prior.X));
}

void limit(Vec3& step) {
  const double over = std::max(step.head<2>().norm() / 0.5, std::abs(step.z()) / 0.3);
  if (over > 1) step /= over;
}

double fine_score(const ScanPoints& scan, const LocalMap& map, const Pose2& X) {
  double sum = 0;
  const double c = std::cos(X.yaw_rad), s = std::sin(X.yaw_rad);
  for (size_t k = 0; k < scan.size(); ++k) {
    const Vec2& m = scan.normal_B[k];
    const Vec2 q = X * scan.p_B[k];
    const std::optional<LocalMap::Rib> rib =
        map.rib_near(q, scan.z_m[k], Vec2(c * m.x() - s * m.y(), s * m.x() + c * m.y()), 0.4);
    if (!rib) continue;
    const double r = rib->distance_m / 0.1;
    sum += std::exp(-r * r / 2);
  }
  return scan.size() > 0 ? sum / static_cast<double>(scan.size()) : 0;
}

// Closeness to a rib, 0..1, on a grid: exp(-d^2 / (2 * 0.2 m ^2)), wide enough for the steps of the search.
class CoarseMap {
 public:
  explicit CoarseMap(const LocalMap& map) {
    Vec2 high = Vec2::Constant(-inf);
    low_ = Vec2::Constant(inf);
    for (const Surfel& s : map.surfels()) low_ = low_.cwiseMin(s.p), high = high.cwiseMax(s.p);
    low_ -= Vec2::Constant((reach_ + 1) * cell_m);
    width_ = static_cast<int>((high.x() - low_.x()) / cell_m) + reach_ + 2;
    height_ = static_cast<int>((high.y() - low_.y()) / cell_m) + reach_ + 2;
    near_.assign(static_cast<size_t>(width_) * height_, 0);
    for (const Surfel& s : map.surfels()) splat(s.p);
  }
  static constexpr double cell_m = 0.1;
  Eigen::Vector2i cell(const Vec2& p) const {
    return {static_cast<int>(std::floor((p.x() - low_.x()) / cell_m)),
            static_cast<int>(std::floor((p.y() - low_.y()) / cell_m))};
  }
  float at(int i, int j) const {
    return i >= 0 && j >= 0 && i < width_ && j < height_ ? near_[static_cast<size_t>(j) * width_ + i] : 0;
  }

 private:
  void splat(const Vec2& p) {
    const Eigen::Vector2i c = cell(p);
    for (int b = -reach_; b <= reach_; ++b)
      for (int a = -reach_; a <= reach_; ++a) {
        float& value = near_[static_cast<size_t>(c.y() + b) * width_ + c.x() + a];
        value = std::max(value, kernel_[static_cast<size_t>(a * a + b * b)]);
      }
  }
  static constexpr int reach_ = 5;
  static std::vector<float> make_kernel() {
    std::vector<float> k(2 * reach_ * reach_ + 1);
    for (size_t d2 = 0; d2 < k.size(); ++d2)
      k[d2] = static_cast<float>(std::exp(-double(d2) * cell_m * cell_m / (2 * 0.2 * 0.2)));
    return k;
  }
  std::vector<float> kernel_ = make_kernel();
  Vec2 low_;
  int width_ = 0, height_ = 0;
  std::vector<float> near_;
};

struct Candidate {
  Pose2 X;
  double score;
};

bool same_place(const Pose2& a, const Pose2& b, double m, double rad) {
  return (a.position() - b.position()).norm() < m && std::abs(wrap_angle(a.yaw_rad - b.yaw_rad)) < rad;
}

std::vector<Candidate> coarse_search(const ScanPoints& scan, const LocalMap& map, const Pose2& guess,
                                     const SearchWindow& window) {
  constexpr double step_rad = 0.03;
  constexpr int step_cells = 2;  // 0.2 m
  const CoarseMap coarse(map);
  const size_t stride = std::max<size_t>(1, scan.size() / 120);
  const int turns = static_cast<int>(std::ceil(window.reach_rad / step_rad));
  const int steps = static_cast<int>(std::ceil(window.reach_m / (step_cells * CoarseMap::cell_m)));
  std::vector<Candidate> all;
  all.reserve(static_cast<size_t>(2 * turns + 1) * (2 * steps + 1) * (2 * steps + 1));
  std::vector<Eigen::Vector2i> cells;
  for (int t = -turns; t <= turns; ++t) {
    const Pose2 turned{guess.x_m, guess.y_m, wrap_angle(guess.yaw_rad + t * step_rad)};
    cells.clear();
    for (size_t k = 0; k < scan.size(); k += stride) cells.push_back(coarse.cell(turned * scan.p_B[k]));
    for (int b = -steps; b <= steps; ++b)
      for (int a = -steps; a <= steps; ++a) {
        float sum = 0;
        for (const Eigen::Vector2i& c : cells) sum += coarse.at(c.x() + a * step_cells, c.y() + b * step_cells);
        const double unit = step_cells * CoarseMap::cell_m;
        all.push_back(
            {{turned.x_m + a * unit, turned.y_m + b * unit, turned.yaw_rad}, sum / static_cast<double>(cells.size())});
      }
  }
  // The best, and those that are no neighbours of a better one.
  const size_t most = std::min<size_t>(all.size(), 400);
  const auto better = [](const Candidate& a, const Candidate& b) { return a.score > b.score; };
  std::vector<Candidate> peaks;
  std::stable_sort(all.begin(), all.end(), better);
  for (size_t i = 0; i < most && peaks.size() < 8; ++i)
    if (std::none_of(peaks.begin(), peaks.end(),
                     [&](const Candidate& c) { return same_place(c.X, all[i].X, 0.55, 0.13); }))
      peaks.push_back(all[i]);
  return peaks;
}

}  // namespace

Fields fields(MatchSettings& s) {
  return {
      {"gate_m", &s.gate_m, "points farther from the map are not paired, at first", 0.05, 1},
      {"gate_end_m", &s.gate_end_m, "and at last", 0.05, 1},
      {"robust_sigmas", &s.robust_sigmas, "residuals beyond so many sigma lose their weight", 0.5, 100},
      {"iterations", &s.iterations, "most steps of one match", 1, 1000},
      {"map_sigma_m", &s.map_sigma_m, "how far ribs leave their line between beams, 1 sd", 0, 1},
      {"even_m", &s.even_m, "ribs are even where points leave the map by less, 1 sd, their noise taken off", 0, 1},
      {"swallowed", &s.swallowed, "how many times what uneven ribs leave of a match they move it", 0, 100},
      {"weak_sigma_m", &s.weak_sigma_m, "a position less certain than this in some direction is degenerate", 1e-4, 10},
      {"min_inlier_share", &s.min_inlier_share, "of a scan's points that must lie on the map", 0, 1}};
}

Match match_scan(const ScanPoints& scan, const LocalMap& map, const Pose2& guess_X_AB, const MatchSettings& s,
                 const std::optional<PosePrior>& prior) {
  Match out;
  out.X_AB = guess_X_AB;
  out.weak_sigma_m = inf;
  if (map.size() == 0 || scan.size() < 10) return out;
  double gate_m = s.gate_m;
  bool settled = false;
  Linear at;
  Weakness weak;
  for (int i = 0; i < s.iterations && !settled; ++i) {
    at = linearise(scan, map, out.X_AB, gate_m, s);
    weak = weakness_of(at);
    if (weak.sigma_m > s.weak_sigma_m) hold_weak(at, weak);
    Vec3 step = solve_step(at, out.X_AB, prior.value_or(PosePrior{}));
    limit(step);
    if (i >= 8) step *= 0.5;  // pairs that flip to and fro
    out.X_AB = out.X_AB * Pose2{step.x(), step.y(), step.z()};
    // Settled: the step is a small part of what the match is uncertain by. Pairs may flip to and fro below that.
    const bool small = step.dot(at.H * step) < 0.02 || (step.head<2>().norm() < 2e-4 && std::abs(step.z()) < 2e-5);
    settled = small && gate_m <= s.gate_end_m;
    gate_m = std::max(s.gate_end_m, gate_m * (step.head<2>().norm() < 0.02 ? 0.5 : 0.8));
  }
  out.known_share = static_cast<double>(at.pairs) / static_cast<double>(scan.size());
  out.inlier_share = static_cast<double>(at.inliers) / static_cast<double>(scan.size());
  out.rms_m = at.inliers > 0 ? std::sqrt(at.inlier_squares_m2 / at.inliers) : 0;
  out.weak_sigma_m = weak.sigma_m;
  out.weak_direction = weak.direction;
  out.degenerate = weak.sigma_m > s.weak_sigma_m;
  // Residuals larger than stated make the match less certain than its curvature says.
  const double excess = std::max(1.0, at.squares / std::max(1.0, at.weights - 3));
  out.information = at.H / excess;
  out.converged = settled && at.inliers >= 10 && out.inlier_share >= s.min_inlier_share;
  return out;
}

// A laser that pitches, rolls and heaves cuts ribs that lean, bulge or lie under talus at another height in every scan: all
// points of a rib shift together, by decimetres, and a fit takes most of that for motion. What it leaves is what tells of
// it: how the points lie about the map blended over more than the layers that it is made of. The median: where ribs are
// even and people, desks or timber stand before them, most points still lie on ribs.
double uneven_m(const ScanPoints& scan, const LocalMap& map, const Pose2& X_AB, const MatchSettings& s) {
  constexpr double blend_m = 0.3, reach_m = 0.4;
  const double c = std::cos(X_AB.yaw_rad), sn = std::sin(X_AB.yaw_rad);
  std::vector<double> off2;
  for (size_t k = 0; k < scan.size(); k += 2) {
    const Vec2& m = scan.normal_B[k];
    const auto rib = map.rib_near(X_AB * scan.p_B[k], scan.z_m[k], Vec2(c * m.x() - sn * m.y(), sn * m.x() + c * m.y()),
                                  reach_m, blend_m);
    if (rib) off2.push_back(rib->distance_m * rib->distance_m - scan.sigma_m[k] * scan.sigma_m[k]);
  }
  if (off2.empty()) return 0;
  const auto middle = off2.begin() + static_cast<std::ptrdiff_t>(off2.size() / 2);
  std::nth_element(off2.begin(), middle, off2.end());
  constexpr double median_chi2 = 0.4549;  // of one degree of freedom
  return s.swallowed * std::sqrt(std::max(0.0, *middle / median_chi2 - s.even_m * s.even_m));
}

WideMatch search_scan(const ScanPoints& scan, const LocalMap& map, const Pose2& guess_X_AB, const SearchWindow& window,
                      const MatchSettings& settings) {
  WideMatch out;
  out.best.X_AB = guess_X_AB;
  if (map.size() == 0 || scan.size() < 10) return out;
  MatchSettings wide = settings;
  wide.gate_m = std::max(settings.gate_m, 0.6);
  std::vector<std::pair<double, Match>> found;
  for (const Candidate& c : coarse_search(scan, map, guess_X_AB, window)) {
    const Match m = match_scan(scan, map, c.X, wide);
    found.emplace_back(fine_score(scan, map, m.X_AB), m);
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  out.score = found.front().first;
  out.best = found.front().second;
  for (const auto& [score, m] : found)
    if (!same_place(m.X_AB, out.best.X_AB, 0.7, 0.14)) {
      out.runner_up_score = score;
      out.runner_up_X_AB = m.X_AB;
      break;
    }
  return out;
}

ScanPoints join_scans(std::span<const ScanPoints* const> scans, std::span<const Pose2> X_AB, const Pose2& X_AC) {
  std::vector<Pose2> X_CB;
  double sigma_m = 0, count = 0;
  for (size_t i = 0; i < scans.size(); ++i) {
    X_CB.push_back(X_AC.inverse() * X_AB[i]);
    for (const double s : scans[i]->sigma_m) sigma_m += s, count += 1;
  }
  ScanPoints out;
  const LocalMap joined(scans, X_CB);
  out.reserve(joined.size());
  for (const Surfel& s : joined.surfels()) {
    out.p_B.push_back(s.p);
    out.normal_B.push_back(s.normal);
    out.z_m.push_back(s.z_m);
    out.sigma_m.push_back(sigma_m / count);
    out.sigma_normal_rad.push_back(s.sigma_normal_rad);
  }
  return out;
}

}  // namespace adit
