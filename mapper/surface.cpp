// SPDX-License-Identifier: BSD-3-Clause
#include "mapper/surface.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace adit {
namespace {

constexpr float level = 0.5F;

/// Values over a grid of which each column (i, j) keeps one stretch in k; `outside` elsewhere.
template <typename Value>
struct Columns {
  int width = 0, height = 0;
  Value outside{};
  std::vector<int> first;      // (columns) k of the first value
  std::vector<size_t> offset;  // (columns + 1)
  std::vector<Value> value;

  size_t index(int i, int j) const { return static_cast<size_t>(j) * width + i; }
  int begin(int i, int j) const { return first[index(i, j)]; }
  int end(int i, int j) const {
    const size_t c = index(i, j);
    return first[c] + static_cast<int>(offset[c + 1] - offset[c]);
  }
  Value* find(int i, int j, int k) {
    if (i < 0 || j < 0 || i >= width || j >= height || k < begin(i, j) || k >= end(i, j)) return nullptr;
    return &value[offset[index(i, j)] + (k - begin(i, j))];
  }
  Value at(int i, int j, int k) const {
    const Value* found = const_cast<Columns*>(this)->find(i, j, k);
    return found ? *found : outside;
  }
};

/// Makes room for the stretches [low, high) of the columns; low >= high is an empty one.
template <typename Value>
Columns<Value> room(int width, int height, const std::vector<std::pair<int, int>>& stretch, Value outside) {
  Columns<Value> made{width, height, outside, {}, {0}, {}};
  for (const auto& [low, high] : stretch) {
    made.first.push_back(low);
    made.offset.push_back(made.offset.back() + static_cast<size_t>(std::max(0, high - low)));
  }
  made.value.assign(made.offset.back(), outside);
  return made;
}

/// Share of each voxel that is filled; voxel (i, j, k) spans [i, i + 1) x [j, j + 1) x [k, k + 1) times h, from the
/// origin.
Columns<float> fill_fractions(const Dexels& solid, int cells) {
  const double h = solid.cell_m * cells;
  const int width = (solid.width + cells - 1) / cells, height = (solid.height + cells - 1) / cells;
  const auto columns_of = [&](size_t c, auto&& visit) {
    const int i0 = static_cast<int>(c) % width * cells, j0 = static_cast<int>(c) / width * cells;
    for (int j = j0; j < std::min(j0 + cells, solid.height); ++j)
      for (int i = i0; i < std::min(i0 + cells, solid.width); ++i)
        for (const Interval& s : solid.column(i, j)) visit(s);
  };
  std::vector<std::pair<int, int>> stretch(static_cast<size_t>(width) * height);
  for (size_t c = 0; c < stretch.size(); ++c) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    columns_of(c, [&](const Interval& s) {
      low = std::min(low, s.low_m);
      high = std::max(high, s.high_m);
    });
    if (low < high) stretch[c] = {static_cast<int>(std::floor(low / h)), static_cast<int>(std::floor(high / h)) + 1};
  }
  Columns<float> filled = room(width, height, stretch, 0.0F);
  const float share = 1.0F / static_cast<float>(cells * cells);
  parallel_for(
      stretch.size(),
      [&](size_t c) {
        columns_of(c, [&](const Interval& s) {
          for (int k = static_cast<int>(std::floor(s.low_m / h)); k * h < s.high_m; ++k) {
            const double inside = std::min(s.high_m, (k + 1) * h) - std::max(s.low_m, k * h);
            if (inside > 0)
              filled.value[filled.offset[c] + (k - stretch[c].first)] += share * static_cast<float>(inside / h);
          }
        });
      },
      1024);
  return filled;
}

/// Drops filled voxels that meet another along an edge only: of the four voxels around no edge are just two opposite
/// filled.
void separate(Columns<float>& filled) {
  using Step = std::array<int, 3>;
  constexpr std::array<std::array<Step, 2>, 6> diagonals = {{{{{1, 0, 0}, {0, 1, 0}}},
                                                             {{{1, 0, 0}, {0, -1, 0}}},
                                                             {{{1, 0, 0}, {0, 0, 1}}},
                                                             {{{1, 0, 0}, {0, 0, -1}}},
                                                             {{{0, 1, 0}, {0, 0, 1}}},
                                                             {{{0, 1, 0}, {0, 0, -1}}}}};
  for (bool changed = true; changed;) {
    changed = false;
    for (int j = 0; j < filled.height; ++j)
      for (int i = 0; i < filled.width; ++i)
        for (int k = filled.begin(i, j); k < filled.end(i, j); ++k)
          for (const auto& [u, v] : diagonals) {
            float* here = filled.find(i, j, k);
            if (*here < level) break;
            float* there = filled.find(i + u[0] + v[0], j + u[1] + v[1], k + u[2] + v[2]);
            if (!there || *there < level || filled.at(i + u[0], j + u[1], k + u[2]) >= level ||
                filled.at(i + v[0], j + v[1], k + v[2]) >= level)
              continue;
            *(*here < *there ? here : there) = 0.49F;
            changed = true;
          }
  }
}

/// Cell (i, j, k) has the voxels (i - 1 .. i) x (j - 1 .. j) x (k - 1 .. k) at its corners. Number of its vertex, or
/// -1.
Columns<int> place_vertices(const Columns<float>& filled, const Vec2& origin, double h, std::vector<Vec3>& vertex) {
  const int width = filled.width + 1, height = filled.height + 1;
  std::vector<std::pair<int, int>> stretch(static_cast<size_t>(width) * height);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      int low = std::numeric_limits<int>::max(), high = std::numeric_limits<int>::min();
      for (int dj = -1; dj <= 0; ++dj)
        for (int di = -1; di <= 0; ++di) {
          if (i + di < 0 || j + dj < 0 || i + di >= filled.width || j + dj >= filled.height) continue;
          if (filled.begin(i + di, j + dj) == filled.end(i + di, j + dj)) continue;
          low = std::min(low, filled.begin(i + di, j + dj));
          high = std::max(high, filled.end(i + di, j + dj) + 1);
        }
      if (low < high) stretch[static_cast<size_t>(j) * width + i] = {low, high};
    }
  Columns<int> number = room(width, height, stretch, -1);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i)
      for (int k = number.begin(i, j); k < number.end(i, j); ++k) {
        float corner[8];
        for (int c = 0; c < 8; ++c) corner[c] = filled.at(i - 1 + (c & 1), j - 1 + (c >> 1 & 1), k - 1 + (c >> 2));
        Vec3 sum = Vec3::Zero();
        int crossed = 0;
        for (int c = 0; c < 8; ++c)
          for (int axis = 0; axis < 3; ++axis) {
            const int d = c | 1 << axis;
            if (d == c || (corner[c] >= level) == (corner[d] >= level)) continue;
            Vec3 at(c & 1, c >> 1 & 1, c >> 2);
            at[axis] = (level - corner[c]) / (corner[d] - corner[c]);
            sum += at;
            ++crossed;
          }
        if (crossed == 0) continue;
        *number.find(i, j, k) = static_cast<int>(vertex.size());
        const Vec3 in_cells = sum / crossed + Vec3(i - 0.5, j - 0.5, k - 0.5);
        vertex.push_back(h * in_cells + Vec3(origin.x(), origin.y(), 0));
      }
  return number;
}

Label slope_label(const Vec3& normal) {
  constexpr double cos45 = 0.7071;
  return normal.z() > cos45 ? Label::roof : normal.z() < -cos45 ? Label::floor : Label::rib;
}

/// Share of the box of edge h about a point that is solid.
double filled_about(const Dexels& solid, const Vec3& p, double h) {
  const double low_x = (p.x() - h / 2 - solid.origin.x()) / solid.cell_m, high_x = low_x + h / solid.cell_m;
  const double low_y = (p.y() - h / 2 - solid.origin.y()) / solid.cell_m, high_y = low_y + h / solid.cell_m;
  const double low_z = p.z() - h / 2, high_z = p.z() + h / 2;
  double filled = 0;
  for (int j = std::max(0, static_cast<int>(std::floor(low_y))); j < high_y && j < solid.height; ++j)
    for (int i = std::max(0, static_cast<int>(std::floor(low_x))); i < high_x && i < solid.width; ++i) {
      const double covered = (std::min(i + 1.0, high_x) - std::max<double>(i, low_x)) *
                             (std::min(j + 1.0, high_y) - std::max<double>(j, low_y));
      for (const Interval& s : solid.column(i, j))
        filled += covered * std::max(0.0, std::min(s.high_m, high_z) - std::max(s.low_m, low_z));
    }
  return filled * solid.cell_m * solid.cell_m / (h * h * h);
}

/// Lays each vertex where the box of a voxel's size about it is half filled: level surfaces come out as exact as the
/// columns are, while a surface between the middles of voxels is off by up to a twelfth of their edge.
void settle(Mesh& mesh, const Dexels& solid, double h) {
  std::vector<Vec3> normal(mesh.vertex.size(), Vec3::Zero());
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const Vec3 twice = (mesh.corner(f, 1) - mesh.corner(f, 0)).cross(mesh.corner(f, 2) - mesh.corner(f, 0));
    for (const std::uint32_t v : mesh.face[f]) normal[v] += twice;
  }
  parallel_for(
      mesh.vertex.size(),
      [&](size_t v) {
        if (!(normal[v].norm() > 0)) return;
        const Vec3 n = normal[v].normalized();
        // A plane's share of a box grows by its section, h^2 over its steepest component, as it moves.
        const double step = (filled_about(solid, mesh.vertex[v], h) - 0.5) * h * n.cwiseAbs().maxCoeff();
        mesh.vertex[v] += std::clamp(step, -h / 4, h / 4) * n;
      },
      1024);
}

/// The quad between the cells a, b, c, d, which go counter-clockwise seen from outside.
void add_quad(Mesh& mesh, int a, int b, int c, int d) {
  ADIT_CHECK(a >= 0 && b >= 0 && c >= 0 && d >= 0);
  const auto& v = mesh.vertex;
  // The shorter diagonal.
  if ((v[a] - v[c]).squaredNorm() > (v[b] - v[d]).squaredNorm()) {
    const int first = a;
    a = b, b = c, c = d, d = first;
  }
  const auto add = [&](int p, int q, int r) {
    mesh.face.push_back({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q), static_cast<std::uint32_t>(r)});
    const Vec3 normal = (v[q] - v[p]).cross(v[r] - v[p]);
    mesh.label.push_back(slope_label(normal.norm() > 0 ? Vec3(normal.normalized()) : Vec3::UnitX()));
  };
  add(a, b, c);
  add(a, c, d);
}

}  // namespace

Mesh boundary_of(const Dexels& solid, int cells) {
  if (cells < 1) throw Error("surface_cells is " + std::to_string(cells) + ", must be 1 or more");
  Mesh mesh;
  if (solid.interval.empty()) return mesh;
  Columns<float> filled = fill_fractions(solid, cells);
  separate(filled);
  const Columns<int> number = place_vertices(filled, solid.origin, solid.cell_m * cells, mesh.vertex);
  // A quad for each pair of neighbouring voxels of which one is filled: along x, y, z.
  const auto quad = [&](bool inward, int a, int b, int c, int d) {
    if (inward) std::swap(b, d);
    add_quad(mesh, a, b, c, d);
  };
  for (int j = 0; j < number.height; ++j)
    for (int i = 0; i < number.width; ++i)
      for (int k = number.begin(i, j); k < number.end(i, j); ++k) {
        const bool here = filled.at(i, j, k) >= level;
        if (const bool before = filled.at(i - 1, j, k) >= level; before != here)
          quad(here, number.at(i, j, k), number.at(i, j + 1, k), number.at(i, j + 1, k + 1), number.at(i, j, k + 1));
        if (const bool before = filled.at(i, j - 1, k) >= level; before != here)
          quad(here, number.at(i, j, k), number.at(i, j, k + 1), number.at(i + 1, j, k + 1), number.at(i + 1, j, k));
        if (const bool before = filled.at(i, j, k - 1) >= level; before != here)
          quad(here, number.at(i, j, k), number.at(i + 1, j, k), number.at(i + 1, j + 1, k), number.at(i, j + 1, k));
      }
  settle(mesh, solid, solid.cell_m * cells);
  return mesh;
}

}  // namespace adit
