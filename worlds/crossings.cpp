// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/crossings.h"

#include "base/parallel.h"
#include "worlds/exact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace adit {
namespace {

constexpr size_t faces_in_slab = 20000;
// Of signs of products: rounding errs by some 1e-13 of their size, for faces down to a thousandth of their distance.
constexpr double relative_margin = 1e-9;

using Corners = std::array<Vec3, 3>;

Corners corners_of(const Mesh& mesh, size_t f) {
  return {mesh.corner(f, 0), mesh.corner(f, 1), mesh.corner(f, 2)};
}

struct Box3 {
  Vec3 low, high;
  bool meets(const Box3& o) const {
    return (low.array() <= o.high.array()).all() && (o.low.array() <= high.array()).all();
  }
};

Box3 box_of(const Corners& t) {
  return {t[0].cwiseMin(t[1]).cwiseMin(t[2]), t[0].cwiseMax(t[1]).cwiseMax(t[2])};
}

// Differences of corners are all but exact: those that lie within a factor of two of each other are (Sterbenz), and the
// others err by half a bit of the difference.
Corners from(const Corners& t, const Vec3& p) {
  return {t[0] - p, t[1] - p, t[2] - p};
}

double size_of(const Corners& a, const Corners& b) {
  double size = 0;
  for (int k = 0; k < 3; ++k) size = std::max({size, a[k].cwiseAbs().maxCoeff(), b[k].cwiseAbs().maxCoeff()});
  return size;
}

// Whether the plane through 0 with this normal has the points of p on one side and those of q on the other. Points
// that lie on it by construction are told (`on`, bits for p0 p1 q0 q1), and may do so on one of the two sides alone.
bool splits_corner(const Vec3& normal, const std::array<Vec3, 2>& p, const std::array<Vec3, 2>& q, double size,
                   unsigned on) {
  const double margin = relative_margin * normal.norm() * size;
  const auto sides = [&](const std::array<Vec3, 2>& points, unsigned flat) {
    unsigned found = 0;  // 1: below, 2: above, 4: on the plane, 8: not known
    for (int k = 0; k < 2; ++k) {
      const double d = normal.dot(points[k]);
      found |= (flat >> k & 1) != 0 ? 4 : d < -margin ? 1 : d > margin ? 2 : 8;
    }
    return found;
  };
  const unsigned a = sides(p, on & 3), b = sides(q, on >> 2);
  if (((a | b) & 8) != 0 || (a & b) != 0) return false;
  return (a & 3) != 3 && (b & 3) != 3 && ((a | b) & 3) != 0;
}

// Two faces with a corner in common, which is 0.
bool apart_at_corner(const std::array<Vec3, 2>& p, const std::array<Vec3, 2>& q) {
  const double size = std::max({p[0].norm(), p[1].norm(), q[0].norm(), q[1].norm()});
  const Vec3 np = p[0].cross(p[1]), nq = q[0].cross(q[1]);
  if (splits_corner(np, p, q, size, 3) || splits_corner(nq, p, q, size, 12)) return true;
  if (splits_corner(p[0] + p[1] - q[0] - q[1], p, q, size, 0)) return true;
  const Vec3 up = np / np.norm() + nq / nq.norm();
  return splits_corner(up.cross(p[0]), p, q, size, 1) || splits_corner(up.cross(p[1]), p, q, size, 2) ||
         splits_corner(up.cross(q[0]), p, q, size, 4) || splits_corner(up.cross(q[1]), p, q, size, 8);
}

// Two faces without a corner in common: parted by a plane beside one of them, or along two of their sides.
bool apart(const Corners& p, const Corners& q) {
  const Vec3 o = p[0];
  const Corners a = from(p, o), b = from(q, o);
  const double size = size_of(a, b);
  const auto splits = [&](const Vec3& n) {
    const double margin = relative_margin * n.norm() * size;
    const double a0 = n.dot(a[0]), a1 = n.dot(a[1]), a2 = n.dot(a[2]), b0 = n.dot(b[0]), b1 = n.dot(b[1]),
                 b2 = n.dot(b[2]);
    return std::max({a0, a1, a2}) < std::min({b0, b1, b2}) - margin ||
           std::max({b0, b1, b2}) < std::min({a0, a1, a2}) - margin;
  };
  const std::array<Vec3, 3> u{a[1] - a[0], a[2] - a[1], a[0] - a[2]}, v{b[1] - b[0], b[2] - b[1], b[0] - b[2]};
  const Vec3 na = u[0].cross(u[1]), nb = v[0].cross(v[1]);
  if (splits(na) || splits(nb)) return true;
  for (const Vec3& s : u)
    for (const Vec3& t : v)
      if (splits(s.cross(t))) return true;
  for (int k = 0; k < 3; ++k)
    if (splits(na.cross(u[k])) || splits(nb.cross(v[k]))) return true;
  return false;
}

// Two faces with a side in common fold up only where they lie in one plane, on the same side of it.
bool apart_at_side(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double size = std::max({u.norm(), v.norm(), w.norm()});
  const Vec3 nv = u.cross(v), nw = u.cross(w);
  if (std::abs(nv.dot(w)) > relative_margin * size * size * size) return true;
  return nv.dot(nw) < -relative_margin * size * size * size * size;  // flat, to either side
}

bool surely_apart(const Mesh& mesh, size_t f, size_t g) {
  const auto &a = mesh.face[f], &b = mesh.face[g];
  std::array<int, 3> at_a{}, at_b{};
  int shared = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (a[i] == b[j] && shared < 3) at_a[shared] = i, at_b[shared++] = j;
  const auto p = [&](int k) -> const Vec3& { return mesh.vertex[a[k % 3]]; };
  const auto q = [&](int k) -> const Vec3& { return mesh.vertex[b[k % 3]]; };
  bool is_apart = false;
  if (shared == 0) {
    is_apart = apart({p(0), p(1), p(2)}, {q(0), q(1), q(2)});
  } else if (shared == 1) {
    const Vec3& o = p(at_a[0]);
    is_apart = apart_at_corner({p(at_a[0] + 1) - o, p(at_a[0] + 2) - o}, {q(at_b[0] + 1) - o, q(at_b[0] + 2) - o});
  } else if (shared == 2) {
    is_apart = apart_at_side(p(at_a[0]), p(at_a[1]), p(3 - at_a[0] - at_a[1]), q(3 - at_b[0] - at_b[1]));
  }
  return is_apart;
}

// Cubes of space that a slab's faces reach into.
class Cells {
 public:
  Cells(const Mesh& mesh, const std::vector<std::uint32_t>& faces, double cell_m) : mesh_(mesh), cell_m_(cell_m) {
    low_ = Vec3::Constant(1e300);
    for (std::uint32_t f : faces) low_ = low_.cwiseMin(box_of(corners_of(mesh, f)).low);
    for (std::uint32_t f : faces) {
      const Box3 box = box_of(corners_of(mesh, f));
      const auto from = cell(box.low), to = cell(box.high);
      for (std::int64_t x = from[0]; x <= to[0]; ++x)
        for (std::int64_t y = from[1]; y <= to[1]; ++y)
          for (std::int64_t z = from[2]; z <= to[2]; ++z) entries_.push_back({key(x, y, z), f});
    }
    std::sort(entries_.begin(), entries_.end());
  }

  // Calls f(a, b) once for each pair of faces, a < b, whose boxes meet.
  template <class F>
  void for_pairs(const F& f) const {
    std::vector<Box3> box;
    for (size_t begin = 0; begin < entries_.size();) {
      size_t end = begin;
      box.clear();
      for (; end < entries_.size() && entries_[end].first == entries_[begin].first; ++end)
        box.push_back(box_of(corners_of(mesh_, entries_[end].second)));
      for (size_t i = begin; i < end; ++i) {
        for (size_t j = i + 1; j < end; ++j) {
          const Box3 &a = box[i - begin], &b = box[j - begin];
          if (!a.meets(b)) continue;
          const auto first = cell(a.low.cwiseMax(b.low));  // in this cell alone the pair is reported
          if (key(first[0], first[1], first[2]) == entries_[begin].first) f(entries_[i].second, entries_[j].second);
        }
      }
      begin = end;
    }
  }

 private:
  std::array<std::int64_t, 3> cell(const Vec3& p) const {
    const Vec3 q = (p - low_) / cell_m_;
    return {static_cast<std::int64_t>(q.x()), static_cast<std::int64_t>(q.y()), static_cast<std::int64_t>(q.z())};
  }
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    return static_cast<std::uint64_t>(x) << 42 | static_cast<std::uint64_t>(y) << 21 | static_cast<std::uint64_t>(z);
  }

  const Mesh& mesh_;
  double cell_m_;
  Vec3 low_;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries_;
};

// Two faces that meet do so at a point, and that lies in some slab across the longest side that both of them reach
// into: the slabs can be searched side by side.
std::vector<std::vector<std::uint32_t>> slabs_of(const Mesh& mesh) {
  Vec3 low = mesh.vertex[mesh.face[0][0]], high = low;
  for (const auto& f : mesh.face)
    for (std::uint32_t v : f) low = low.cwiseMin(mesh.vertex[v]), high = high.cwiseMax(mesh.vertex[v]);
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const size_t count = std::max<size_t>(1, mesh.face.size() / faces_in_slab);
  const double thickness = std::max((high - low)[axis], 1e-9) / static_cast<double>(count);
  std::vector<std::vector<std::uint32_t>> slabs(count);
  const auto slab = [&](double x) {
    return static_cast<size_t>(std::clamp((x - low[axis]) / thickness, 0.0, static_cast<double>(count) - 1));
  };
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const Box3 box = box_of(corners_of(mesh, f));
    for (size_t k = slab(box.low[axis]); k <= slab(box.high[axis]); ++k)
      slabs[k].push_back(static_cast<std::uint32_t>(f));
  }
  return slabs;
}

double mean_size(const Mesh& mesh, const std::vector<std::uint32_t>& faces) {
  double sum = 0, reach = 0;
  for (std::uint32_t f : faces) {
    const Box3 box = box_of(corners_of(mesh, f));
    sum += (box.high - box.low).maxCoeff();
    reach = std::max(reach, (box.high - box.low).maxCoeff());
  }
  const double mean = sum / static_cast<double>(std::max<size_t>(1, faces.size()));
  return std::max({mean * 1.2, reach / 200, 1e-6});  // no face may fill too many cells
}

}  // namespace

size_t crossing_pairs(const Mesh& mesh) {
  if (mesh.face.empty()) return 0;
  const auto slabs = slabs_of(mesh);
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> found(slabs.size());
  parallel_for(slabs.size(), [&](size_t k) {
    if (slabs[k].empty()) return;
    Cells(mesh, slabs[k], mean_size(mesh, slabs[k])).for_pairs([&](std::uint32_t f, std::uint32_t g) {
      if (!surely_apart(mesh, f, g) && faces_cross(mesh, f, g)) found[k].emplace_back(std::min(f, g), std::max(f, g));
    });
  });
  std::vector<std::pair<std::uint32_t, std::uint32_t>> all;  // a pair may be found in two slabs
  for (const auto& pairs : found) all.insert(all.end(), pairs.begin(), pairs.end());
  std::sort(all.begin(), all.end());
  return static_cast<size_t>(std::unique(all.begin(), all.end()) - all.begin());
}

size_t degenerate_faces(const Mesh& mesh) {
  return static_cast<size_t>(parallel_sum(mesh.face.size(), [&](size_t f) { return no_area(mesh, f) ? 1.0 : 0.0; }));
}

}  // namespace adit
