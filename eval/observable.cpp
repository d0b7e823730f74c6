// SPDX-License-Identifier: BSD-3-Clause
#include "eval/observable.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

namespace adit {
namespace {

Label label_of(const Mesh& mesh, size_t face) {
  return mesh.label.empty() ? Label::none : mesh.label[face];
}

// Cube and label as one number; +-100 km in cubes of 0.2 m.
std::uint64_t key_of(const Vec3& p_C, double edge_m, Label label) {
  // Shifted by half a cube, so that a plane through the frame's origin does not lie between two.
  const Vec3 c = (p_C / edge_m + Vec3::Constant(0.5)).array().floor() + (1 << 19);
  std::uint64_t key = static_cast<std::uint64_t>(label);
  for (int k = 0; k < 3; ++k) {
    if (!(c[k] >= 0 && c[k] < (1 << 20)))
      throw Error("a mesh reaches farther than 500000 patches from the path's start");
    key = key << 20 | static_cast<std::uint64_t>(c[k]);
  }
  return key;
}

}  // namespace

// The triangles of a face in rows along its second edge: row i has 2 (n - i) - 1 of them, upright and hanging in turn.
std::uint64_t Patches::triangle_of(std::int32_t face, double u, double v) const {
  const double n = cuts_[face];
  const double i = std::clamp(std::floor(u * n), 0.0, n - 1);
  const double j = std::clamp(std::floor(v * n), 0.0, n - 1 - i);
  const bool hanging = (u * n - i) + (v * n - j) > 1 && i + j < n - 1;
  return first_[face] + static_cast<std::uint64_t>(i * (2 * n - i) + 2 * j) + (hanging ? 1 : 0);
}

std::uint32_t Patches::at(std::int32_t face, const Vec3& p_W) const {
  if (whole(face)) return patch_[first_[face]];
  const Vec3 a = mesh_->corner(face, 0), ab = mesh_->corner(face, 1) - a, ac = mesh_->corner(face, 2) - a, ap = p_W - a;
  const double d00 = ab.dot(ab), d01 = ab.dot(ac), d11 = ac.dot(ac), d20 = ap.dot(ab), d21 = ap.dot(ac);
  const double det = d00 * d11 - d01 * d01;
  if (!(det > 0)) return patch_[first_[face]];
  return patch_[triangle_of(face, (d11 * d20 - d01 * d21) / det, (d00 * d21 - d01 * d20) / det)];
}

Patches::Patches(const Mesh& mesh, double patch_m, const Pose& X_WC) : mesh_(&mesh) {
  first_.push_back(0);
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    double edge = 0;
    for (int k = 0; k < 3; ++k) edge = std::max(edge, (mesh.corner(f, k) - mesh.corner(f, (k + 1) % 3)).norm());
    const double n = std::ceil(edge / patch_m * (1 - 1e-9));
    if (!(n < 10000))
      throw Error("a face of the mesh has an edge of " + std::to_string(edge) + " m, 10000 patches long");
    cuts_.push_back(std::max(1u, static_cast<std::uint32_t>(n)));
    first_.push_back(first_.back() + std::uint64_t{cuts_.back()} * cuts_.back());
  }
  if (first_.back() > 0xffffffffull) throw Error("the surface has more than 4e9 patches: take a larger patch_m");
  struct Keyed {
    std::uint64_t key;
    std::uint32_t triangle;
    bool operator<(const Keyed& o) const { return key != o.key ? key < o.key : triangle < o.triangle; }
  };
  std::vector<Keyed> keyed(first_.back());
  std::vector<std::uint32_t> face(first_.back());
  std::vector<Vec3> middle(first_.back());
  const Pose X_CW = X_WC.inverse();
  parallel_for(
      mesh.face.size(),
      [&](size_t f) {
        const Vec3 a = mesh.corner(f, 0), n_ab = (mesh.corner(f, 1) - a) / cuts_[f],
                   n_ac = (mesh.corner(f, 2) - a) / cuts_[f];
        std::uint64_t t = first_[f];
        for (std::uint32_t i = 0; i < cuts_[f]; ++i)
          for (std::uint32_t m = 0; m + 1 < 2 * (cuts_[f] - i); ++m, ++t) {
            const double third = m % 2 ? 2.0 / 3 : 1.0 / 3;
            middle[t] = a + (i + third) * n_ab + (m / 2 + third) * n_ac;
            keyed[t] = {key_of(X_CW * middle[t], patch_m, label_of(mesh, f)), static_cast<std::uint32_t>(t)};
            face[t] = static_cast<std::uint32_t>(f);
          }
      },
      256);
  std::sort(keyed.begin(), keyed.end());
  patch_.resize(keyed.size());
  for (size_t k = 0; k < keyed.size(); ++k) {
    const std::uint32_t t = keyed[k].triangle, f = face[t];
    if (k == 0 || keyed[k].key != keyed[k - 1].key) {
      area_m2_.push_back(0);
      centre_.push_back(Vec3::Zero());
      label_.push_back(label_of(mesh, f));
    }
    const double area = mesh.area(f) / (double{1} * cuts_[f] * cuts_[f]);
    patch_[t] = static_cast<std::uint32_t>(area_m2_.size() - 1);
    area_m2_.back() += area;
    centre_.back() += area * middle[t];
  }
  for (size_t p = 0; p < centre_.size(); ++p) centre_[p] /= area_m2_[p] > 0 ? area_m2_[p] : 1;
}

Observable observable_surface(const Patches& patches, const TrueScans& scans, size_t faces, double incidence_rad) {
  // Whole numbers added in any order give the same sum.
  std::vector<std::uint32_t> patch_hits(patches.size(), 0), face_hits(faces, 0);
  for (size_t l = 0; l < scans.lasers(); ++l) {
    const ScanTruth& truth = scans.truth(l);
    const size_t beams = static_cast<size_t>(scans.mount(l).laser.beams);
    const auto range_max = static_cast<float>(scans.mount(l).laser.range_max_m);
    parallel_for(
        scans.scans(l),
        [&](size_t i) {
          for (size_t at = i * beams; at < (i + 1) * beams; ++at) {
            const std::int32_t f = truth.face[at];
            if (f < 0 || truth.range_m[at] > range_max || truth.incidence_rad[at] > incidence_rad) continue;
            if (static_cast<size_t>(f) >= faces)
              throw Error("the truth names face " + std::to_string(f) + " of a mesh with " + std::to_string(faces),
                          Fault::not_comparable);
            const int k = static_cast<int>(at - i * beams);
            const std::uint32_t p = patches.whole(f) ? patches.at(f, {}) : patches.at(f, scans.beam(l, i, k).end());
            std::atomic_ref(patch_hits[p]).fetch_add(1, std::memory_order_relaxed);
            std::atomic_ref(face_hits[f]).fetch_add(1, std::memory_order_relaxed);
          }
        },
        16);
  }
  Observable seen;
  for (const std::uint32_t n : patch_hits) seen.patch_hits.push_back(static_cast<std::uint8_t>(std::min(n, 255u)));
  for (const std::uint32_t n : face_hits) seen.face_hits.push_back(static_cast<std::uint8_t>(std::min(n, 255u)));
  return seen;
}

}  // namespace adit
