// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/outline.h"

#include "base/error.h"
#include "base/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace adit {
namespace {

constexpr double lattice_m = 0.2;
constexpr double far_m = 1e3;
constexpr double deepest_m = 8;  // to which distances within polygons are told
constexpr int band_rows = 64;
constexpr int block_nodes = 512;  // side of the blocks in which ribs are traced
constexpr double seen_m = 3.2;    // beyond a window's frame

Lattice lattice_over(const Frame2& box, double margin) {
  Lattice f;
  f.cell_m = lattice_m;
  f.origin = ((box.low.array() - margin) / lattice_m).floor().matrix() * lattice_m;
  f.width = static_cast<int>(std::ceil((box.high.x() + margin - f.origin.x()) / lattice_m)) + 1;
  f.height = static_cast<int>(std::ceil((box.high.y() + margin - f.origin.y()) / lattice_m)) + 1;
  return f;
}

void fill_far(Lattice& f) {
  f.value.assign(static_cast<size_t>(f.width) * f.height, static_cast<float>(far_m));
}

// Calls f(i, j) for the nodes of rows [first, last) within `reach` of the piece a-b.
template <class F>
void near_piece(const Lattice& field, const Vec2& a, const Vec2& b, double reach, int first, int last, const F& f) {
  const Vec2 first_node(field.i0, field.j0);
  const Vec2 low = (a.cwiseMin(b).array() - reach - field.origin.array()) / field.cell_m - first_node.array();
  const Vec2 high = (a.cwiseMax(b).array() + reach - field.origin.array()) / field.cell_m - first_node.array();
  const int i0 = std::max(0, static_cast<int>(std::ceil(low.x()))),
            i1 = std::min(field.width - 1, static_cast<int>(high.x()));
  const int j0 = std::max(first, static_cast<int>(std::ceil(low.y()))),
            j1 = std::min(last - 1, static_cast<int>(high.y()));
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) f(i, j);
}

// Bands of rows are filled side by side: each node is written by one of them alone.
template <class F>
void for_bands(const Lattice& field, const F& fill) {
  const size_t bands = (field.height + band_rows - 1) / band_rows;
  parallel_for(bands, [&](size_t k) {
    const int first = static_cast<int>(k) * band_rows;
    fill(first, std::min(field.height, first + band_rows));
  });
}

double piece_distance(const Vec2& a, const Vec2& b, const Vec2& p) {
  const Vec2 u = b - a, w = p - a;
  const double uu = u.squaredNorm();
  const double t = uu > 0 ? std::clamp(w.dot(u) / uu, 0.0, 1.0) : 0.0;
  return (w - t * u).norm();
}

double widest_half_m(const Drift& drift) {
  double widest = 0;
  for (size_t k = 0; k < drift.line.size(); ++k) widest = std::max({widest, drift.left[k], drift.right[k]});
  return widest;
}

// Signed distance from the union of the drifts: outside it is exact, for the distance from a union is the least one.
void unite(const std::vector<Drift>& drifts, const std::vector<size_t>& which, double reach, Outline& o) {
  Lattice& f = o.depth;
  for_bands(f, [&](int first, int last) {
    for (size_t d : which) {
      const Drift& drift = drifts[d];
      const double widest = widest_half_m(drift);
      for (size_t k = 0; k + 1 < drift.line.size(); ++k) {
        near_piece(f, drift.line[k], drift.line[k + 1], widest + reach, first, last, [&](int i, int j) {
          const auto distance = static_cast<float>(signed_distance(drift, k, f.node(i, j)));
          float& least = f.value[f.index(i, j)];
          if (distance >= least) return;
          least = distance;
          o.nearest[f.index(i, j)] = static_cast<int>(d);
        });
      }
    }
  });
}

// The rock that is left when discs of the radius are rolled through it: erode by the radius, grow by it again. The
// result is the signed distance from the new ribs, up to a radius on the rock's side.
void open_rock(Lattice& f, double radius) {
  std::vector<Link> cores;
  add_links(f, radius, 0, f.width, 0, f.height, cores);
  std::vector<float> gap(f.value.size(), static_cast<float>(far_m));
  const double reach = radius + 1.0;
  for_bands(f, [&](int first, int last) {
    for (const Link& core : cores) {
      near_piece(f, core.at, core.next, reach, first, last, [&](int i, int j) {
        float& least = gap[f.index(i, j)];
        least = std::min(least, static_cast<float>(piece_distance(core.at, core.next, f.node(i, j))));
      });
    }
  });
  for (size_t n = 0; n < gap.size(); ++n) {
    const bool core = f.value[n] >= radius;
    const double from_core = std::min<double>(gap[n], reach);
    f.value[n] = static_cast<float>(core ? radius + from_core : radius - from_core);
  }
}

void build_walls(const std::vector<Wall>& walls, Lattice& f) {
  for (const Wall& w : walls) {
    const double reach = 0.5 * std::hypot(w.wide_m, w.thick_m) + 1;
    near_piece(f, w.middle, w.middle, reach, 0, f.height, [&](int i, int j) {
      float& depth = f.value[f.index(i, j)];
      depth = std::max(depth, static_cast<float>(-w.distance(f.node(i, j))));
    });
  }
}

// Marks the nodes of rows [first, last) inside of a polygon: those that a row reaches after an odd number of crossings.
void fill(const Lattice& f, const Polygon& polygon, int first, int last, std::vector<char>& inside) {
  for (int j = first; j < last; ++j) {
    const double y = f.node(0, j).y();
    std::vector<double> x;
    for (const Loop& ring : polygon) {
      for (size_t i = 0; i < ring.size(); ++i) {
        const Vec2 &a = ring[i], &b = ring[(i + 1) % ring.size()];
        if ((a.y() > y) != (b.y() > y)) x.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
    std::sort(x.begin(), x.end());
    for (size_t k = 0; k + 1 < x.size(); k += 2)
      for (int i = std::max(0, static_cast<int>(std::ceil((x[k] - f.origin.x()) / f.cell_m)));
           i < f.width && f.node(i, j).x() < x[k + 1]; ++i)
        inside[f.index(i, j)] = 1;
  }
}

// Nodes of the void that lie far from every drift belong to the one from which they are reached first.
void spread_nearest(Outline& o, double reach) {
  const Lattice& f = o.depth;
  std::vector<size_t> front;
  for (size_t n = 0; n < o.nearest.size(); ++n)
    if (o.nearest[n] >= 0) front.push_back(n);
  for (size_t k = 0; k < front.size(); ++k) {
    const size_t n = front[k];
    const size_t i = n % f.width, j = n / f.width;
    if (i == 0 || j == 0 || i + 1 >= static_cast<size_t>(f.width) || j + 1 >= static_cast<size_t>(f.height)) continue;
    for (size_t next : {n - 1, n + 1, n - f.width, n + f.width}) {
      if (o.nearest[next] >= 0 || f.value[next] > reach) continue;
      o.nearest[next] = o.nearest[n];
      front.push_back(next);
    }
  }
}

double reach_of(double corner_radius_m) {
  return 2 * corner_radius_m + 1.5;
}

}  // namespace

Workings::Workings(std::vector<Drift> drifts, std::vector<Wall> walls, double corner_radius_m)
    : drifts_(std::move(drifts)), walls_(std::move(walls)), radius_(corner_radius_m) {
  Frame2 box;
  for (const Drift& d : drifts_) {
    Frame2 own;
    for (const Vec2& p : d.line) own.add(p);
    box.add(own.low);
    box.add(own.high);
    const double half = widest_half_m(d);
    drift_frame_.push_back({own.low.array() - half, own.high.array() + half});
  }
  frame_ = lattice_over(box, 10 + reach_of(radius_));
}

Workings::Workings(Lattice depth, std::vector<Drift> drifts, double corner_radius_m)
    : drifts_(std::move(drifts)), radius_(corner_radius_m), given_(std::move(depth)) {}

// What is found near the border of a window lacks what lies beyond it: windows are taken with a margin.
Outline Workings::nodes(int i0, int j0, int i1, int j1) const {
  const int margin = static_cast<int>(std::ceil((radius_ + 1) / lattice_m)) + 2;
  Outline o;
  o.depth = frame_;
  o.depth.i0 = std::max(0, i0 - margin);
  o.depth.j0 = std::max(0, j0 - margin);
  o.depth.width = std::min(frame_.width, i1 + margin) - o.depth.i0;
  o.depth.height = std::min(frame_.height, j1 + margin) - o.depth.j0;
  fill_far(o.depth);
  o.nearest.assign(o.depth.value.size(), -1);
  const Frame2 seen{o.depth.node(0, 0), o.depth.node(o.depth.width - 1, o.depth.height - 1)};
  std::vector<size_t> near;
  for (size_t d = 0; d < drifts_.size(); ++d)
    if (drift_frame_[d].meets(seen, reach_of(radius_))) near.push_back(d);
  if (near.empty()) return o;
  unite(drifts_, near, reach_of(radius_), o);
  open_rock(o.depth, radius_);
  build_walls(walls_, o.depth);
  return o;
}

Outline Workings::whole() const {
  if (has_windows()) return nodes(0, 0, frame_.width, frame_.height);
  Outline o;
  o.depth = given_;
  fill_far(o.depth);
  o.nearest.assign(given_.value.size(), -1);
  std::vector<size_t> all(drifts_.size());
  std::iota(all.begin(), all.end(), size_t{0});
  unite(drifts_, all, reach_of(radius_), o);
  o.depth = given_;
  spread_nearest(o, reach_of(radius_));
  open_rock(o.depth, radius_);
  return o;
}

Outline Workings::window(const Frame2& frame) const {
  const Vec2 low = (frame.low.array() - seen_m - frame_.origin.array()) / lattice_m;
  const Vec2 high = (frame.high.array() + seen_m - frame_.origin.array()) / lattice_m;
  return nodes(static_cast<int>(std::floor(low.x())), static_cast<int>(std::floor(low.y())),
               static_cast<int>(std::ceil(high.x())) + 1, static_cast<int>(std::ceil(high.y())) + 1);
}

std::vector<Loop> Workings::ribs() const {
  std::vector<Link> links;
  if (!has_windows()) {
    const Outline all = whole();
    add_links(all.depth, 0, 0, all.depth.width, 0, all.depth.height, links);
  }
  for (int j = 0; has_windows() && j < frame_.height; j += block_nodes) {
    for (int i = 0; i < frame_.width; i += block_nodes) {
      const Lattice f = nodes(i, j, i + block_nodes + 1, j + block_nodes + 1).depth;
      add_links(f, 0, i - f.i0, i - f.i0 + block_nodes, j - f.j0, j - f.j0 + block_nodes, links);
    }
  }
  std::vector<Loop> ribs = join_links(std::move(links));
  const auto outer = [](const Loop& loop) { return enclosed_area(loop) > 0; };
  if (std::count_if(ribs.begin(), ribs.end(), outer) != 1)
    throw Error(std::string("world: the void falls into several parts; ") +
                (has_windows() ? "widths are too small for the wander (world.wall_wander_m)"
                               : "the polygons must form one mine"));
  std::rotate(ribs.begin(), std::find_if(ribs.begin(), ribs.end(), outer), ribs.end());
  return ribs;
}

Lattice depth_of(const std::vector<Polygon>& polygons, double corner_radius_m) {
  Frame2 box;
  for (const Polygon& polygon : polygons)
    for (const Vec2& p : polygon[0]) box.add(p);
  Lattice f = lattice_over(box, 10 + reach_of(corner_radius_m));
  fill_far(f);
  std::vector<char> inside(f.value.size(), 0);
  for_bands(f, [&](int first, int last) {
    for (const Polygon& polygon : polygons) {
      fill(f, polygon, first, last, inside);
      for (const Loop& ring : polygon) {
        for (size_t k = 0; k < ring.size(); ++k) {
          const Vec2 &a = ring[k], &b = ring[(k + 1) % ring.size()];
          near_piece(f, a, b, deepest_m, first, last, [&](int i, int j) {
            float& least = f.value[f.index(i, j)];
            least = std::min(least, static_cast<float>(piece_distance(a, b, f.node(i, j))));
          });
        }
      }
    }
  });
  for (size_t n = 0; n < inside.size(); ++n)
    if (inside[n]) f.value[n] = -std::clamp(f.value[n], 1e-3f, static_cast<float>(deepest_m));
  return f;
}

int passage_at(const Outline& o, const Vec2& p) {
  const Vec2 at = ((p - o.depth.origin) / o.depth.cell_m).array().round();
  const int i = std::clamp(static_cast<int>(at.x()) - o.depth.i0, 0, o.depth.width - 1);
  const int j = std::clamp(static_cast<int>(at.y()) - o.depth.j0, 0, o.depth.height - 1);
  return o.nearest[o.depth.index(i, j)];
}

}  // namespace adit
