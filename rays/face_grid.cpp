// SPDX-License-Identifier: BSD-3-Clause
#include "rays/face_grid.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr std::uint32_t nothing = 0xffffffff;
constexpr int side = 8;  // of a block, in cells
constexpr size_t grain = 4096;

Eigen::Matrix4f planes_of(const Mesh& mesh, size_t face, const Vec3& middle) {
  std::array<Vec3, 3> p;
  for (int k = 0; k < 3; ++k) p[static_cast<size_t>(k)] = mesh.corner(face, k) - middle;
  const Vec3 n = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
  Eigen::Matrix4d rows;
  rows.row(0) << n.transpose(), -n.dot(p[0]);
  for (size_t k = 0; k < 3; ++k) {
    const Vec3 out = (p[(k + 1) % 3] - p[k]).cross(n).normalized();
    rows.row(static_cast<Eigen::Index>(k) + 1) << out.transpose(), -out.dot(p[k]);
  }
  // A face without area may be anywhere: it is always looked at.
  if (!rows.allFinite()) rows.setZero();
  return rows.cast<float>();
}

// The square of a distance that no point of the face is nearer than.
inline float least_m2(const Eigen::Matrix4f& planes, const Eigen::Vector4f& p, float slack_m) {
  const Eigen::Vector4f d = planes * p;
  const float height = std::max(std::abs(d[0]) - slack_m, 0.0F);
  const float beside = std::max(std::max(std::max(d[1], d[2]), d[3]) - slack_m, 0.0F);
  return height * height + beside * beside;
}

}  // namespace

FaceGrid::FaceGrid(const Mesh& mesh) : mesh_(&mesh) {
  if (mesh.face.empty()) throw Error("a mesh without faces has no nearest one");
  low_ = mesh.vertex[0];
  Vec3 high = low_;
  for (const Vec3& v : mesh.vertex) low_ = low_.cwiseMin(v), high = high.cwiseMax(v);
  middle_ = (low_ + high) / 2;
  choose_cells(high);
  planes_.resize(mesh.face.size());
  parallel_for(
      planes_.size(), [&](size_t f) { planes_[f].row = planes_of(mesh, f, middle_); }, grain);
  sort_faces();
}

// As large as a face, and larger until neither the faces' boxes nor the mine's has too many.
void FaceGrid::choose_cells(const Vec3& high) {
  const size_t n = mesh_->face.size();
  const double area_m2 = parallel_sum(n, [&](size_t f) { return mesh_->area(f); });
  cell_m_ = std::max(1.5 * std::sqrt(area_m2 / static_cast<double>(n)), 1e-3);
  for (;; cell_m_ *= 1.5) {
    const Vec3 size = (high - low_) / (side * cell_m_);
    if ((size.array() + 1).prod() > 4e6) continue;
    const double boxes = parallel_sum(n, [&](size_t f) {
      const Vec3 a = mesh_->corner(f, 0), b = mesh_->corner(f, 1), c = mesh_->corner(f, 2);
      return ((a.cwiseMax(b).cwiseMax(c) - a.cwiseMin(b).cwiseMin(c)) / cell_m_).array().ceil().max(1).prod();
    });
    if (boxes > 30 * static_cast<double>(n)) continue;
    for (int k = 0; k < 3; ++k) blocks_[static_cast<size_t>(k)] = static_cast<int>(size[k]) + 1;
    break;
  }
  const double extent_m = (high - middle_).cwiseAbs().maxCoeff() + 2 * cell_m_;
  slack_m_ = static_cast<float>(32 * extent_m) * std::numeric_limits<float>::epsilon();
}

// First and last cell along each axis.
std::array<int, 6> FaceGrid::cells_of(std::uint32_t face) const {
  const Vec3 a = mesh_->corner(face, 0), b = mesh_->corner(face, 1), c = mesh_->corner(face, 2);
  const Vec3 from = ((a.cwiseMin(b).cwiseMin(c) - low_) / cell_m_).array().floor(),
             to = ((a.cwiseMax(b).cwiseMax(c) - low_) / cell_m_).array().floor();
  return {static_cast<int>(from.x()), static_cast<int>(to.x()),   static_cast<int>(from.y()),
          static_cast<int>(to.y()),   static_cast<int>(from.z()), static_cast<int>(to.z())};
}

// The cells that a face reaches into, or may for all that its planes say.
void FaceGrid::sort_faces() {
  const size_t n = mesh_->face.size();
  const auto block_at = [&](int i, int j, int k) {
    return static_cast<std::uint32_t>((i / side * blocks_[1] + j / side) * blocks_[2] + k / side);
  };
  struct Reach {
    std::uint32_t block, cell, face;  // cell of the block
  };
  std::vector<std::vector<Reach>> reaches((n + grain - 1) / grain);
  const float half_m = static_cast<float>(cell_m_ * std::sqrt(0.75)) + slack_m_;
  parallel_chunks(n, grain, [&](size_t begin, size_t end) {
    std::vector<Reach>& out = reaches[begin / grain];
    out.reserve(6 * (end - begin));
    for (size_t f = begin; f < end; ++f) {
      const auto face = static_cast<std::uint32_t>(f);
      const std::array<int, 6> c = cells_of(face);
      for (int i = c[0]; i <= c[1]; ++i)
        for (int j = c[2]; j <= c[3]; ++j)
          for (int k = c[4]; k <= c[5]; ++k) {
            const Vec3 at = low_ + cell_m_ * Vec3(i + 0.5, j + 0.5, k + 0.5) - middle_;
            if (least_m2(planes_[f].row, at.cast<float>().homogeneous(), slack_m_) > half_m * half_m) continue;
            out.push_back(
                {block_at(i, j, k), static_cast<std::uint32_t>((i % side * side + j % side) * side + k % side), face});
          }
    }
  });
  block_.assign(static_cast<size_t>(blocks_[0]) * static_cast<size_t>(blocks_[1]) * static_cast<size_t>(blocks_[2]),
                nothing);
  std::uint32_t held = 0;
  for (const auto& some : reaches)
    for (const Reach& r : some)
      if (block_[r.block] == nothing) block_[r.block] = held++;
  first_.assign(static_cast<size_t>(held) * side * side * side + 1, 0);
  const auto slot = [&](const Reach& r) { return static_cast<size_t>(block_[r.block]) * side * side * side + r.cell; };
  for (const auto& some : reaches)
    for (const Reach& r : some) ++first_[slot(r) + 1];
  for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  face_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const auto& some : reaches)
    for (const Reach& r : some) face_[next[slot(r)]++] = r.face;
}

std::uint32_t FaceGrid::cell_at(int i, int j, int k) const {
  const auto block = [&](int c, size_t axis) { return c < 0 || c / side >= blocks_[axis] ? -1 : c / side; };
  const int a = block(i, 0), b = block(j, 1), c = block(k, 2);
  if (a < 0 || b < 0 || c < 0) return nothing;
  const std::uint32_t held =
      block_[(static_cast<size_t>(a) * static_cast<size_t>(blocks_[1]) + static_cast<size_t>(b)) *
                 static_cast<size_t>(blocks_[2]) +
             static_cast<size_t>(c)];
  if (held == nothing) return nothing;
  return held * side * side * side + static_cast<std::uint32_t>((i % side * side + j % side) * side + k % side);
}

std::optional<Closest> FaceGrid::closest(const Vec3& p, const std::optional<Vec3>& seen_along) const {
  NearestFace nearest(*mesh_, p, cell_m_, seen_along);
  const Vec3 at = (p - low_) / cell_m_;
  if (!(at.cwiseAbs().maxCoeff() < 1e9)) return {};
  const std::array<int, 3> own{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y())),
                               static_cast<int>(std::floor(at.z()))};
  const Eigen::Vector4f q = Vec3(p - middle_).cast<float>().homogeneous();
  // The likeliest face first: after it hardly another one needs to be looked at.
  const auto look = [&](std::uint32_t cell) {
    if (cell == nothing) return;
    constexpr std::uint32_t most = 64;
    std::array<float, most> least;
    for (std::uint32_t from = first_[cell], to; from < first_[cell + 1]; from = to) {
      to = std::min(from + most, first_[cell + 1]);
      std::uint32_t likeliest = from;
      for (std::uint32_t e = from; e < to; ++e) {
        least[e - from] = least_m2(planes_[face_[e]].row, q, slack_m_);
        if (least[e - from] < least[likeliest - from]) likeliest = e;
      }
      const auto offer = [&](std::uint32_t e) {
        const auto best_m = static_cast<float>(nearest.best_m());
        if (least[e - from] <= best_m * best_m * 1.000001F) nearest.offer(face_[e]);
      };
      offer(likeliest);
      for (std::uint32_t e = from; e < to; ++e) offer(e);
    }
  };
  look(cell_at(own[0], own[1], own[2]));
  // The square of the distance from p to the layer of cells below, to its own, and to that above, along each axis.
  double gap_m2[3][3];
  for (int a = 0; a < 3; ++a) {
    const double into_m = (at[a] - own[static_cast<size_t>(a)]) * cell_m_, left_m = cell_m_ - into_m;
    gap_m2[a][0] = into_m * into_m, gap_m2[a][1] = 0, gap_m2[a][2] = left_m * left_m;
  }
  const auto out_of_reach = [&](double m2) {
    const double reach_m = nearest.best_m() + 1e-6;
    return m2 > reach_m * reach_m;
  };
  for (int i = 0; i < 3; ++i) {
    if (out_of_reach(gap_m2[0][i])) continue;
    for (int j = 0; j < 3; ++j) {
      if (out_of_reach(gap_m2[0][i] + gap_m2[1][j])) continue;
      for (int k = 0; k < 3; ++k) {
        if ((i == 1 && j == 1 && k == 1) || out_of_reach(gap_m2[0][i] + gap_m2[1][j] + gap_m2[2][k])) continue;
        look(cell_at(own[0] + i - 1, own[1] + j - 1, own[2] + k - 1));
      }
    }
  }
  return nearest.found();
}

}  // namespace adit
