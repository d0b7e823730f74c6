// SPDX-License-Identifier: BSD-3-Clause
#include "eval/sight.h"

#include "base/error.h"
#include "base/parallel.h"
#include "eval/metric_list.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

namespace adit {
namespace {

constexpr double deg = std::numbers::pi / 180;
constexpr double cell_m = 0.5;        // of the table of nearest stations
constexpr double met_edge_on = 0.02;  // as eval/bound: below it noise drowns what a range says
constexpr double full_db = 60;        // of a deviation that a scan makes a thousand times smaller

double noise_m(const LaserModel& laser) {
  return std::hypot(laser.sigma_m, laser.resolution_m / std::sqrt(12.0));
}

// Where a beam leaves through or enters the boxes; infinity where none stands in it.
double blocked_at(const Hull& hull, const Vec3& from, const Vec3& along) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Box& box : hull) {
    if ((from.array() >= box.min_B.array()).all() && (from.array() <= box.max_B.array()).all()) continue;
    double enter = 0, leave = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
      const double a = (box.min_B[k] - from[k]) / along[k], b = (box.max_B[k] - from[k]) / along[k];
      if (along[k] == 0) {
        if (from[k] < box.min_B[k] || from[k] > box.max_B[k]) leave = -1;
        continue;
      }
      enter = std::max(enter, std::min(a, b)), leave = std::min(leave, std::max(a, b));
    }
    if (enter <= leave) nearest = std::min(nearest, enter);
  }
  return nearest;
}

// A beam of a mount in B and how far it is free.
struct FixedBeam {
  Vec3 along;
  double free_m;
};

std::vector<FixedBeam> beams_of(const Mount& mount, const Hull& hull, double step_deg, double& each_counts) {
  const LaserModel& laser = mount.laser;
  const double own_step = laser.fov_rad / (laser.beams - 1);
  const int every = std::max(1, static_cast<int>(std::lround(step_deg * deg / own_step)));
  std::vector<FixedBeam> beams;
  for (int k = (laser.beams - 1) % every / 2; k < laser.beams; k += every) {
    const double a = laser.beam_angle_rad(k);
    const Vec3 along = mount.X_BS.linear() * Vec3(std::cos(a), std::sin(a), 0);
    beams.push_back({along, blocked_at(hull, mount.X_BS.translation(), along)});
  }
  each_counts = static_cast<double>(laser.beams) / static_cast<double>(beams.size());
  return beams;
}

bool echoes(const LaserModel& laser, const Mesh& mesh, std::int32_t face, double range_m, double cosine) {
  if (range_m > laser.range_max_m) return false;
  return mesh.reflectivity.empty() || static_cast<double>(mesh.reflectivity[static_cast<size_t>(face)]) * cosine >=
                                          laser.least_reflectivity(range_m);
}

void mark(std::vector<std::uint64_t>& bits, std::int64_t i) {
  bits[static_cast<size_t>(i) / 64] |= std::uint64_t{1} << (i % 64);
}

Vec6 prior_of(const FastSettings& s) {
  Vec6 sd;
  sd << s.prior_m, s.prior_m, s.prior_m, s.prior_deg * deg, s.prior_deg * deg, s.prior_deg * deg;
  return sd;
}

}  // namespace

Fields fields(FastSettings& s) {
  return {{"step_m", &s.step_m, "between two stations of the path", 0.1, 100},
          {"beam_step_deg", &s.beam_step_deg, "of the beams that are cast", 0.1, 30},
          {"sector_deg", &s.sector_deg, "of the section about the path: the patches of rock that are counted", 1, 90},
          {"section_max_m", &s.section_max_m, "rock farther from the path does not count", 1, 100},
          {"slope", &s.slope, "of rock against the body's axes, below which it is roughness", 0, 0.7},
          {"again_m", &s.again_m, "rock this near to the fan at the next station is seen again", 0, 100},
          {"unknown_m", &s.unknown_m, "deviation of rock that is not seen again; 0: all rock is known", 0, 100},
          {"one_a_view", &s.one_a_view, "of each view the first laser counts, as for adit's mapper"},
          {"prior_m", &s.prior_m, "deviation of a pose before a scan", 1e-3, 1e3},
          {"prior_deg", &s.prior_deg, "and of its angles", 1e-3, 90},
          {"information", &s.information, "weight of what scans tell of the pose", 0, 1e6},
          {"surface", &s.surface, "weight of the rock that is met", 0, 1e6},
          {"volume", &s.volume, "weight of the void before it", 0, 1e6},
          {"hull", &s.hull, "what a laser costs all of whose beams end on the vehicle: a mapper takes it for rock", 0,
           1e6}};
}

std::string blind_words(const FastScore& score) {
  constexpr std::array<const char*, 6> names{"along", "across", "up", "roll", "pitch", "yaw"};
  std::vector<std::string> blind;
  Eigen::Index most = 0;
  for (Eigen::Index k = 0; k < 6; ++k) {
    if (score.left[k] > 0.5) blind.emplace_back(names[static_cast<size_t>(k)]);
    if (score.left[k] > score.left[most]) most = k;
  }
  if (blind.empty()) return names[static_cast<size_t>(most)];
  std::string words = blind[0];
  for (size_t i = 1; i < blind.size(); ++i) words += (i + 1 == blind.size() ? " and " : ", ") + blind[i];
  return words;
}

Course::Course(const Caster& caster, const Trajectory& path, const FastSettings& settings)
    : caster_(caster), settings_(settings) {
  const std::vector<double> along = distance_along(path);
  for (size_t i = 0; i < along.size(); ++i)
    if (along[i] >= settings.step_m * static_cast<double>(X_WB_.size())) X_WB_.push_back(path.X_WB[i]);
  if (X_WB_.size() < 2)
    throw Error("a path of " + std::to_string(along.empty() ? 0 : along.back()) +
                " m is too short to judge lasers on: fast.step_m must leave two stations");
  for (const Pose& X : X_WB_) {
    const Vec3 up = X.linear().col(2), from = X.translation() + 0.5 * up;
    const Hit roof = caster.nearest(Ray{from, up}), floor = caster.nearest(Ray{from, -up});
    const double middle = roof.face < 0 || floor.face < 0 ? 0 : (roof.range_m - floor.range_m) / 2;
    middle_W_.push_back(from + middle * up);
  }
  sectors_ = static_cast<size_t>(std::max(1L, std::lround(360 / settings.sector_deg)));
  lay_cells();
  weigh();
  level_roughness();
}

void Course::lay_cells() {
  const double reach = settings_.section_max_m + settings_.step_m;
  Vec2 high = X_WB_[0].translation().head<2>();
  low_W_ = high;
  for (const Pose& X : X_WB_) {
    low_W_ = low_W_.cwiseMin(X.translation().head<2>());
    high = high.cwiseMax(X.translation().head<2>());
  }
  low_W_.array() -= reach, high.array() += reach;
  columns_ = static_cast<int>((high.x() - low_W_.x()) / cell_m) + 1;
  rows_ = static_cast<int>((high.y() - low_W_.y()) / cell_m) + 1;
  nearest_.assign(static_cast<size_t>(columns_) * static_cast<size_t>(rows_), -1);
  std::vector<double> distance(nearest_.size(), reach);
  const int around = static_cast<int>(reach / cell_m) + 1;
  for (size_t s = 0; s < X_WB_.size(); ++s) {
    const Vec2 p = middle_W_[s].head<2>();
    const int cx = static_cast<int>((p.x() - low_W_.x()) / cell_m),
              cy = static_cast<int>((p.y() - low_W_.y()) / cell_m);
    for (int y = std::max(0, cy - around); y <= std::min(rows_ - 1, cy + around); ++y)
      for (int x = std::max(0, cx - around); x <= std::min(columns_ - 1, cx + around); ++x) {
        const size_t i = static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x);
        const double d = (low_W_ + cell_m * Vec2(x + 0.5, y + 0.5) - p).norm();
        if (d < distance[i]) distance[i] = d, nearest_[i] = static_cast<std::int32_t>(s);
      }
  }
}

std::int32_t Course::station_at(const Vec3& p_W) const {
  const int x = static_cast<int>(std::floor((p_W.x() - low_W_.x()) / cell_m)),
            y = static_cast<int>(std::floor((p_W.y() - low_W_.y()) / cell_m));
  if (x < 0 || y < 0 || x >= columns_ || y >= rows_) return -1;
  return nearest_[static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x)];
}

std::int64_t Course::patch_of(const Vec3& p_W) const {
  const std::int32_t s = station_at(p_W);
  if (s < 0) return -1;
  const auto at = static_cast<size_t>(s);
  const Vec3 v = X_WB_[at].linear().transpose() * (p_W - middle_W_[at]);
  const double turn = std::atan2(v.z(), v.y()) / (2 * std::numbers::pi) + 0.5;
  const auto sector = std::min(sectors_ - 1, static_cast<size_t>(turn * static_cast<double>(sectors_)));
  return static_cast<std::int64_t>(at * sectors_ + sector);
}

// The section at each station as rays from its middle find it.
void Course::weigh() {
  constexpr int rays_a_sector = 4;
  const size_t n = X_WB_.size(), rays = sectors_ * rays_a_sector;
  surface_m2_.assign(n * sectors_, 0), volume_m3_.assign(n * sectors_, 0);
  parallel_for(n, [&](size_t s) {
    if (station_at(middle_W_[s]) != static_cast<std::int32_t>(s)) return;  // another visit of the same place counts
    std::vector<double> range(rays);
    const double step = 2 * std::numbers::pi / static_cast<double>(rays);
    for (size_t k = 0; k < rays; ++k) {
      const double a = step * (static_cast<double>(k) + 0.5) - std::numbers::pi;
      const Hit hit = caster_.nearest(Ray{middle_W_[s], X_WB_[s].linear() * Vec3(0, std::cos(a), std::sin(a))});
      range[k] = std::min(hit.range_m, settings_.section_max_m);
    }
    for (size_t k = 0; k < rays; ++k) {
      const double a = range[k], b = range[(k + 1) % rays];
      if (std::max(a, b) >= settings_.section_max_m) continue;  // an open side
      const double chord = std::sqrt(a * a + b * b - 2 * a * b * std::cos(step));
      surface_m2_[s * sectors_ + k / rays_a_sector] += settings_.step_m * chord;
      volume_m3_[s * sectors_ + k / rays_a_sector] += settings_.step_m * 0.5 * a * b * std::sin(step);
    }
  });
  for (const double v : surface_m2_) surface_all_ += v;
  for (const double v : volume_m3_) volume_all_ += v;
}

namespace {

size_t side_of(const Mesh& mesh, size_t face) {
  if (mesh.label.empty()) return 2;
  return mesh.label[face] == Label::floor ? 0 : is_roof(mesh.label[face]) ? 1 : 2;
}

// A direction without its components below `slope`.
Vec3 main_directions(Vec3 n, double slope) {
  for (int k = 0; k < 3; ++k)
    if (std::abs(n[k]) < slope) n[k] = 0;
  return n.normalized();
}

}  // namespace

void Course::level_roughness() {
  const Mesh& mesh = caster_.mesh();
  patch_normal_W_.assign(stations() * sectors_ * 3, Vec3::Zero());
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const Vec3 a = mesh.corner(f, 0), b = mesh.corner(f, 1), c = mesh.corner(f, 2);
    const std::int64_t patch = patch_of((a + b + c) / 3);
    if (patch >= 0) patch_normal_W_[static_cast<size_t>(patch) * 3 + side_of(mesh, f)] += (b - a).cross(c - a);
  }
  for (Vec3& n : patch_normal_W_)
    if (n.squaredNorm() > 0) n.normalize();
}

Vec3 Course::normal_W(std::int32_t face, std::int64_t patch) const {
  const auto f = static_cast<size_t>(face);
  if (patch >= 0) {
    const Vec3& mean = patch_normal_W_[static_cast<size_t>(patch) * 3 + side_of(caster_.mesh(), f)];
    if (mean.squaredNorm() > 0) return mean;
  }
  return caster_.mesh().normal(f);
}

// From the station before or the next one.
bool Course::seen_again(const Mount& mount, size_t station, const Vec3& p_W) const {
  const auto from = [&](size_t s) {
    const Vec3 p_S = (X_WB_[s] * mount.X_BS).inverse() * p_W;
    return std::abs(p_S.z()) <= settings_.again_m && p_S.norm() <= mount.laser.range_max_m &&
           std::abs(std::atan2(p_S.y(), p_S.x())) <= mount.laser.fov_rad / 2;
  };
  return (station > 0 && from(station - 1)) || (station + 1 < stations() && from(station + 1));
}

// What a mapper uses: of each view the first.
std::vector<const Sight*> Course::that_count(std::span<const Sight* const> lasers) const {
  if (!settings_.one_a_view) return {lasers.begin(), lasers.end()};
  std::vector<const Sight*> some;
  for (const Sight* sight : lasers) {
    const auto same = [&](const Sight* other) { return other->view == sight->view; };
    if (sight->view != View::other && std::none_of(some.begin(), some.end(), same)) some.push_back(sight);
  }
  return some;
}

Sight Course::sight(const Mount& mount, const Hull& hull) const {
  double each_counts = 1;
  const std::vector<FixedBeam> beams = beams_of(mount, hull, settings_.beam_step_deg, each_counts);
  const Mesh& mesh = caster_.mesh();
  const double variance = std::pow(std::max(1e-6, noise_m(mount.laser)), 2), known = each_counts / variance,
               unknown = each_counts / (variance + settings_.unknown_m * settings_.unknown_m);
  Sight sight;
  sight.view = view_of(mount);
  sight.information.assign(stations(), Mat6::Zero());
  sight.seen.assign((stations() * sectors_ + 63) / 64, 0);
  RayColumns<float> rays;
  HitColumns<float> hits;
  rays.resize(beams.size()), hits.resize(beams.size());
  for (size_t s = 0; s < stations(); ++s) {
    const Eigen::Matrix3d R_WB = X_WB_[s].linear(), R_BW = R_WB.transpose();
    const Vec3 from_W = X_WB_[s] * mount.X_BS.translation(), from = from_W - caster_.middle();
    for (size_t k = 0; k < beams.size(); ++k) {
      const Vec3 d = R_WB * beams[k].along;
      rays.x[k] = static_cast<float>(from.x()), rays.y[k] = static_cast<float>(from.y());
      rays.z[k] = static_cast<float>(from.z()), rays.dx[k] = static_cast<float>(d.x());
      rays.dy[k] = static_cast<float>(d.y()), rays.dz[k] = static_cast<float>(d.z());
    }
    caster_.glance(rays, hits);
    Mat6& I = sight.information[s];
    for (size_t k = 0; k < beams.size(); ++k) {
      const double range = static_cast<double>(hits.range_m[k]);
      sight.blocked += std::isfinite(beams[k].free_m) && !(range <= beams[k].free_m);
      if (hits.face[k] < 0 || range > beams[k].free_m) continue;
      const Vec3& d = beams[k].along;
      if (!echoes(mount.laser, mesh, hits.face[k], range, static_cast<double>(hits.cosine[k]))) continue;
      const Vec3 p_W = from_W + range * (R_WB * d);
      const std::int64_t patch = patch_of(p_W);
      if (patch >= 0) mark(sight.seen, patch);
      const Vec3 n = main_directions(R_BW * normal_W(hits.face[k], patch), settings_.slope);
      const double cosine = n.dot(d);
      if (cosine < met_edge_on) continue;
      const Vec3 p = mount.X_BS.translation() + range * d;
      Vec6 g;
      g << n, p.cross(n);
      g /= cosine;
      I.selfadjointView<Eigen::Lower>().rankUpdate(g, seen_again(mount, s, p_W) ? known : unknown);
    }
    I = Mat6(I.selfadjointView<Eigen::Lower>());
  }
  sight.blocked /= static_cast<double>(beams.size() * stations());
  return sight;
}

FastScore Course::score(std::span<const Sight* const> all, bool with_directions) const {
  const std::vector<const Sight*> lasers = that_count(all);
  const Vec6 prior = prior_of(settings_);
  const Mat6 scale = prior.asDiagonal();
  FastScore score;
  Mat6 sum = Mat6::Zero();  // of what is left of the prior at each station
  std::array<std::vector<double>, 6> deviation;
  double log_det = 0;
  for (size_t s = 0; s < stations(); ++s) {
    Mat6 I = Mat6::Zero();
    for (const Sight* sight : lasers) I += sight->information[s];
    const Mat6 gain = scale * I * scale + Mat6::Identity();
    const Eigen::LLT<Mat6> factor(gain);
    const Mat6 L = factor.matrixL();
    for (int k = 0; k < 6; ++k) log_det += 2 * std::log10(L(k, k));
    if (!with_directions) continue;
    const Mat6 left = factor.solve(Mat6::Identity());
    for (int k = 0; k < 6; ++k) deviation[static_cast<size_t>(k)].push_back(std::sqrt(left(k, k)));
    sum += left;
  }
  // 10 log10 of a variance's gain, a sixth for each direction.
  score.information = 10 * log_det / 6 / static_cast<double>(stations()) / full_db;
  for (size_t i = 0; i * 64 < stations() * sectors_; ++i) {
    std::uint64_t bits = 0;
    for (const Sight* sight : lasers) bits |= sight->seen[i];
    for (; bits != 0; bits &= bits - 1) {
      const size_t patch = i * 64 + static_cast<size_t>(std::countr_zero(bits));
      score.surface += surface_m2_[patch], score.volume += volume_m3_[patch];
    }
  }
  score.surface /= std::max(surface_all_, 1e-9), score.volume /= std::max(volume_all_, 1e-9);
  if (settings_.one_a_view && std::none_of(lasers.begin(), lasers.end(), [](auto* l) { return l->view == View::up; }))
    score.volume = 0;
  for (const Sight* sight : all) score.hull += sight->blocked;
  score.value = settings_.information * score.information + settings_.surface * score.surface +
                settings_.volume * score.volume - settings_.hull * score.hull;
  if (!with_directions) return score;
  for (int k = 0; k < 6; ++k) {
    score.left[k] = quantile(deviation[static_cast<size_t>(k)], 0.5);
    score.sigma[k] = score.left[k] * prior[k] / (k < 3 ? 1 : deg);
  }
  const Eigen::SelfAdjointEigenSolver<Mat6> eigen(sum / static_cast<double>(stations()));
  score.blind_left = std::sqrt(std::min(1.0, eigen.eigenvalues()[5]));
  return score;
}

}  // namespace adit
