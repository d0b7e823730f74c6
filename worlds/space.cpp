// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/space.h"

#include "worlds/exact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double placed_cell_m = 2;

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool before(const Vec2& a, const Vec2& b) {
  return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
}

// Where a side of a piece meets the line on which the two signed distances f, g vanish: the same bits from either end.
LevelPoint meeting(const LevelPoint& a, double f, const LevelPoint& b, double g) {
  if (before(b.p, a.p)) return meeting(b, g, a, f);
  const double t = f / (f - g);
  return {a.p + t * (b.p - a.p), a.floor_z + t * (b.floor_z - a.floor_z), a.roof_z + t * (b.roof_z - a.roof_z)};
}

// What of a convex piece lies to the left of a line (Sutherland, Hodgman 1974).
std::vector<LevelPoint> left_of(const std::vector<LevelPoint>& piece, const Vec2& from, const Vec2& to) {
  std::vector<LevelPoint> kept;
  std::vector<double> side;
  for (const LevelPoint& v : piece) side.push_back(cross(to - from, v.p - from));
  for (size_t i = 0; i < piece.size(); ++i) {
    const size_t j = (i + 1) % piece.size();
    if (side[i] >= 0) kept.push_back(piece[i]);
    if ((side[i] > 0 && side[j] < 0) || (side[i] < 0 && side[j] > 0))
      kept.push_back(meeting(piece[i], side[i], piece[j], side[j]));
  }
  return kept;
}

double area_of(const std::vector<LevelPoint>& piece) {
  double twice = 0;
  for (size_t i = 1; i + 1 < piece.size(); ++i) twice += cross(piece[i].p - piece[0].p, piece[i + 1].p - piece[0].p);
  return twice / 2;
}

// Solid angles under which the faces are seen add up to a whole ball within (van Oosterom, Strackee 1983).
bool within(const Solid& s, const Vec3& p) {
  double sum = 0;
  for (const auto& f : s.face) {
    const Vec3 a = s.vertex[f[0]] - p, b = s.vertex[f[1]] - p, c = s.vertex[f[2]] - p;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(sum) > 2 * std::numbers::pi;
}

struct Box3 {
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  void add(const Vec3& p) { low = low.cwiseMin(p), high = high.cwiseMax(p); }
  bool meets(const Box3& o) const {
    return (low.array() <= o.high.array()).all() && (o.low.array() <= high.array()).all();
  }
};

Box3 box_of(const std::vector<Vec3>& vertex, const std::array<std::uint32_t, 3>& face) {
  Box3 b;
  for (std::uint32_t v : face) b.add(vertex[v]);
  return b;
}

Box3 box_of(const Solid& s) {
  Box3 b;
  for (const Vec3& v : s.vertex) b.add(v);
  return b;
}

std::pair<long, long> cell_of(const Vec2& p) {
  return {std::lround(std::floor(p.x() / placed_cell_m)), std::lround(std::floor(p.y() / placed_cell_m))};
}

// Faces of two bodies in one mesh that shares nothing between them, and the pairs that may meet.
class Pairs {
 public:
  explicit Pairs(const Solid& body) : body_(body) {
    both_.vertex = body.vertex;
    both_.face = body.face;
    for (const auto& f : body.face) {
      const Box3 b = own_.emplace_back(box_of(body.vertex, f));
      const auto from = cell_of(b.low.head<2>()), to = cell_of(b.high.head<2>());
      for (long y = from.second; y <= to.second; ++y)
        for (long x = from.first; x <= to.first; ++x)
          near_[{x, y}].push_back(static_cast<std::uint32_t>(own_.size() - 1));
    }
  }
  /// Whether a face of something else crosses one of the body's.
  bool crosses(const std::array<Vec3, 3>& corner) {
    Box3 other;
    for (const Vec3& p : corner) other.add(p);
    both_.vertex.resize(body_.vertex.size());
    both_.vertex.insert(both_.vertex.end(), corner.begin(), corner.end());
    both_.face.resize(body_.face.size());
    const auto n = static_cast<std::uint32_t>(body_.vertex.size());
    both_.face.push_back({n, n + 1, n + 2});
    const auto from = cell_of(other.low.head<2>()), to = cell_of(other.high.head<2>());
    for (long y = from.second; y <= to.second; ++y)
      for (long x = from.first; x <= to.first; ++x)
        if (const auto found = near_.find({x, y}); found != near_.end())
          for (std::uint32_t f : found->second)
            if (own_[f].meets(other) && faces_cross(both_, f, own_.size())) return true;
    return false;
  }

 private:
  const Solid& body_;
  Mesh both_;
  std::vector<Box3> own_;
  std::map<std::pair<long, long>, std::vector<std::uint32_t>> near_;  // of own_, by squares of the plan
};

// Whether two triangles of the plan come within some millimetres of one another: no side of either parts them.
bool near_in_plan(const std::array<Vec2, 3>& a, const std::array<Vec2, 3>& b) {
  constexpr double margin_m = 0.004;
  for (const auto* of : {&a, &b}) {
    for (int k = 0; k < 3; ++k) {
      const Vec2 side = (*of)[(k + 1) % 3] - (*of)[k];
      if (side.squaredNorm() < 1e-18) continue;
      const Vec2 n = Vec2(side.y(), -side.x()).normalized();
      double low_a = 1e300, high_a = -1e300, low_b = 1e300, high_b = -1e300;
      for (int i = 0; i < 3; ++i) {
        low_a = std::min(low_a, n.dot(a[i])), high_a = std::max(high_a, n.dot(a[i]));
        low_b = std::min(low_b, n.dot(b[i])), high_b = std::max(high_b, n.dot(b[i]));
      }
      if (low_a > high_b + margin_m || low_b > high_a + margin_m) return false;
    }
  }
  return true;
}

}  // namespace

float reflectivity_of(Material material) {
  switch (material) {
    case Material::timber:
      return 0.30f;
    case Material::steel:
      return 0.18f;  // rusty
    case Material::block:
      return 0.40f;
    case Material::shale:
      return 0.22f;
    case Material::water:
      return 0.04f;
    case Material::mud:
      return 0.25f;
    default:
      return 0.08f;  // rubber
  }
}

template <class F>
void Space::Grid::build(const Vec2& from, const Vec2& to, double cell, size_t n, const F& box) {
  low = from;
  cell_m = cell;
  nx = static_cast<long>((to.x() - from.x()) / cell) + 1;
  ny = static_cast<long>((to.y() - from.y()) / cell) + 1;
  begin.assign(static_cast<size_t>(nx * ny) + 1, 0);
  const auto each = [&](auto&& take) {
    for (std::uint32_t i = 0; i < n; ++i) {
      const Box3 b = box(i);
      const Vec2 f = (b.low.head<2>() - low) / cell_m, t = (b.high.head<2>() - low) / cell_m;
      for (long y = static_cast<long>(f.y()); y <= static_cast<long>(t.y()); ++y)
        for (long x = static_cast<long>(f.x()); x <= static_cast<long>(t.x()); ++x)
          take(static_cast<size_t>(y * nx + x), i);
    }
  };
  each([&](size_t c, std::uint32_t) { ++begin[c + 1]; });
  for (size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  item.resize(begin.back());
  std::vector<std::uint32_t> next(begin.begin(), begin.end() - 1);
  each([&](size_t c, std::uint32_t i) { item[next[c]++] = i; });
}

// Items whose cells meet a box; some come several times.
template <class F>
void Space::Grid::for_near(const Vec2& from, const Vec2& to, const F& f) const {
  const auto at = [&](double v, long n) { return std::clamp(static_cast<long>(std::floor(v / cell_m)), 0L, n - 1); };
  for (long y = at(from.y() - low.y(), ny); y <= at(to.y() - low.y(), ny); ++y)
    for (long x = at(from.x() - low.x(), nx); x <= at(to.x() - low.x(), nx); ++x)
      for (std::uint32_t i = begin[static_cast<size_t>(y * nx + x)]; i < begin[static_cast<size_t>(y * nx + x) + 1];
           ++i)
        f(item[i]);
}

Space::Space(const Mesh& rock, size_t levels) : rock_(rock), levels_(levels), caster_(rock) {
  Box3 all;
  for (const Vec3& v : rock.vertex) all.add(v);
  const Vec2 from = all.low.head<2>(), to = all.high.head<2>();
  plan_.build(from, to, 0.5, levels, [&](std::uint32_t k) { return box_of(rock.vertex, rock.face[2 * k]); });
  faces_.build(from, to, 0.5, rock.face.size(), [&](std::uint32_t f) { return box_of(rock.vertex, rock.face[f]); });
}

// Floors run the other way round.
LevelPoint Space::corner(std::uint32_t k, int c) const {
  const Vec3 &up = rock_.vertex[name(k, c)], &down = rock_.vertex[rock_.face[2 * size_t{k}][c == 0 ? 0 : 3 - c]];
  return {up.head<2>(), down.z(), up.z()};
}

std::optional<LevelPatch> Space::patch(const Loop& polygon) const {
  Box3 frame;
  double area = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    frame.add({polygon[i].x(), polygon[i].y(), 0});
    if (i > 1) area += 0.5 * cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  }
  std::vector<std::uint32_t> near;
  plan_.for_near(frame.low.head<2>(), frame.high.head<2>(), [&](std::uint32_t k) { near.push_back(k); });
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  LevelPatch patch;
  std::map<std::pair<double, double>, std::uint32_t> index;
  double covered = 0;
  for (std::uint32_t k : near) {
    std::vector<LevelPoint> piece{corner(k, 0), corner(k, 1), corner(k, 2)};
    for (size_t i = 0; i < polygon.size() && piece.size() > 2; ++i)
      piece = left_of(piece, polygon[i], polygon[(i + 1) % polygon.size()]);
    if (piece.size() < 3) continue;
    covered += area_of(piece);
    patch.piece.emplace_back();
    for (const LevelPoint& v : piece) {
      const auto [found, fresh] =
          index.emplace(std::pair{v.p.x(), v.p.y()}, static_cast<std::uint32_t>(patch.vertex.size()));
      if (fresh) patch.vertex.push_back(v);
      patch.piece.back().push_back(found->second);
    }
  }
  if (patch.piece.empty() || std::abs(covered - area) > 1e-7) return std::nullopt;
  return patch;
}

std::optional<LevelPoint> Space::level(const Vec2& p) const {
  std::optional<LevelPoint> found;
  const auto look = [&](std::uint32_t k) {
    if (found) return;
    const LevelPoint a = corner(k, 0), b = corner(k, 1), c = corner(k, 2);
    const Vec2 ab = b.p - a.p, ac = c.p - a.p, ap = p - a.p;
    const double area = cross(ab, ac), s = cross(ap, ac) / area, t = cross(ab, ap) / area;
    if (!(s >= 0 && t >= 0 && s + t <= 1)) return;
    found = LevelPoint{p, a.floor_z + s * (b.floor_z - a.floor_z) + t * (c.floor_z - a.floor_z),
                       a.roof_z + s * (b.roof_z - a.roof_z) + t * (c.roof_z - a.roof_z)};
  };
  plan_.for_near(p, p, look);
  return found;
}

void Space::find_neighbours() const {
  if (!next_.empty()) return;
  next_.assign(levels_, {-1, -1, -1});
  rim_.assign(rock_.vertex.size(), 0);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sides;  // lower and higher name; 3 k + c
  for (std::uint32_t k = 0; k < levels_; ++k)
    for (int c = 0; c < 3; ++c) {
      const std::uint64_t a = name(k, c), b = name(k, (c + 1) % 3);
      sides.emplace_back(std::min(a, b) << 32 | std::max(a, b), 3 * k + static_cast<std::uint32_t>(c));
    }
  std::sort(sides.begin(), sides.end());
  for (size_t i = 0; i + 1 < sides.size(); ++i) {
    if (sides[i].first != sides[i + 1].first) continue;
    const std::uint32_t a = sides[i].second, b = sides[i + 1].second;
    next_[a / 3][a % 3] = static_cast<std::int32_t>(b / 3);
    next_[b / 3][b % 3] = static_cast<std::int32_t>(a / 3);
  }
  for (std::uint32_t k = 0; k < levels_; ++k)
    for (int c = 0; c < 3; ++c)
      if (next_[k][c] < 0) rim_[name(k, c)] = rim_[name(k, (c + 1) % 3)] = 1;
}

bool Space::stands_in(const std::array<Vec2, 3>& t, double below_z) const {
  Box3 own;
  for (const Vec2& p : t) own.add({p.x(), p.y(), 0});
  const auto from = cell_of(own.low.head<2>()), to = cell_of(own.high.head<2>());
  for (long y = from.second; y <= to.second; ++y)
    for (long x = from.first; x <= to.first; ++x) {
      const auto found = placed_at_.find({x, y});
      if (found == placed_at_.end()) continue;
      for (std::uint32_t i : found->second) {
        const Placed& other = placed_[i];
        if (other.low.z() > below_z + 0.01 || (other.low.head<2>().array() > own.high.head<2>().array()).any() ||
            (other.high.head<2>().array() < own.low.head<2>().array()).any())
          continue;
        for (const auto& f : other.body.face)
          if (near_in_plan(t, {other.body.vertex[f[0]].head<2>(), other.body.vertex[f[1]].head<2>(),
                               other.body.vertex[f[2]].head<2>()}))
            return true;
      }
    }
  return false;
}

// Of the triangles marked those joined to one by sides, without points at which the sheet only touches itself.
void Space::keep_sheet(std::vector<char>& wet, std::uint32_t from) const {
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<char> reached(levels_, 0);
    std::vector<std::uint32_t> front;
    if (wet[from]) front.push_back(from), reached[from] = 1;
    std::map<std::uint32_t, int> rims;  // sides of the rim at each vertex
    std::vector<std::uint32_t> sheet;
    while (!front.empty()) {
      const std::uint32_t k = front.back();
      front.pop_back();
      sheet.push_back(k);
      for (int c = 0; c < 3; ++c) {
        const std::int32_t n = next_[k][c];
        if (n < 0 || !wet[n]) {
          ++rims[name(k, c)];
          ++rims[name(k, (c + 1) % 3)];
        } else if (!reached[n]) {
          reached[n] = 1;
          front.push_back(static_cast<std::uint32_t>(n));
        }
      }
    }
    wet = std::move(reached);
    for (std::uint32_t k : sheet)
      for (int c = 0; c < 3; ++c) {
        const auto at = rims.find(name(k, c));
        if (at == rims.end() || at->second <= 2) continue;
        changed = true;
        wet[k] = 0;
      }
    if (!changed || wet[from]) continue;
    const auto left = std::find_if(sheet.begin(), sheet.end(), [&](std::uint32_t k) { return wet[k] != 0; });
    if (left == sheet.end()) return;
    from = *left;
  }
}

std::optional<Basin> Space::basin(const Vec2& lowest, double depth_m, double reach_m) const {
  constexpr double thin_m = 0.012;
  find_neighbours();
  const auto here = level(lowest);
  if (!here) return std::nullopt;
  Basin basin{{}, here->floor_z + depth_m};
  std::uint32_t seed = 0;
  double nearest = 1e300;
  const auto middle = [&](std::uint32_t k) -> Vec2 { return (corner(k, 0).p + corner(k, 1).p + corner(k, 2).p) / 3; };
  std::vector<char> wet(levels_, 0), asked(levels_, 0);
  const auto holds = [&](std::uint32_t k) {
    std::array<Vec2, 3> plan;
    for (int c = 0; c < 3; ++c) {
      const LevelPoint v = corner(k, c);
      if (v.floor_z > basin.level_z - thin_m || v.roof_z < basin.level_z + 0.1 || on_rim(k, c)) return false;
      plan[c] = v.p;
    }
    return !stands_in(plan, basin.level_z);
  };
  std::vector<std::uint32_t> front;
  const Vec2 about = Vec2::Constant(1.0);
  plan_.for_near(lowest - about, lowest + about, [&](std::uint32_t k) {
    const double d = (middle(k) - lowest).norm();
    if (d < nearest && holds(k)) nearest = d, seed = k;
  });
  if (nearest > 1.5) return std::nullopt;
  front.push_back(seed);
  asked[seed] = wet[seed] = 1;
  size_t n = 1;
  while (!front.empty()) {
    const std::uint32_t k = front.back();
    front.pop_back();
    if ((middle(k) - lowest).norm() > reach_m) return std::nullopt;
    for (std::int32_t next : next_[k]) {
      if (next < 0 || asked[next]) continue;
      asked[next] = 1;
      if (!holds(static_cast<std::uint32_t>(next))) continue;
      wet[next] = 1;
      ++n;
      front.push_back(static_cast<std::uint32_t>(next));
    }
  }
  if (n < 12) return std::nullopt;
  keep_sheet(wet, seed);
  std::map<std::uint32_t, std::uint32_t> index;
  for (std::uint32_t k = 0; k < levels_; ++k) {
    if (!wet[k]) continue;
    basin.patch.piece.emplace_back();
    for (int c = 0; c < 3; ++c) {
      const auto [found, fresh] = index.emplace(name(k, c), static_cast<std::uint32_t>(basin.patch.vertex.size()));
      if (fresh) basin.patch.vertex.push_back(corner(k, c));
      basin.patch.piece.back().push_back(found->second);
    }
  }
  if (basin.patch.piece.size() < 12) return std::nullopt;
  return basin;
}

double Space::sight_m(const Vec3& from, const Vec3& direction) const {
  return caster_.nearest(Ray{from, direction.normalized(), 1e3}).range_m;
}

bool Space::meets_rock(const Solid& body) const {
  const Box3 own = box_of(body);
  std::vector<std::uint32_t> near;
  faces_.for_near(own.low.head<2>(), own.high.head<2>(), [&](std::uint32_t f) {
    if (own.meets(box_of(rock_.vertex, rock_.face[f]))) near.push_back(f);
  });
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  Pairs pairs(body);
  for (std::uint32_t f : near)
    if (pairs.crosses({rock_.corner(f, 0), rock_.corner(f, 1), rock_.corner(f, 2)})) return true;
  // Not in the rock as a whole: what lies below is seen from the void.
  const Hit below = caster_.nearest(Ray{body.vertex[0], {0, 0, -1}, 1e3});
  return below.face < 0 || below.cosine <= 0;
}

bool Space::meets_bodies(const Solid& body, const Vec3& low, const Vec3& high) const {
  const Box3 own{low, high};
  std::vector<std::uint32_t> near;
  const auto from = cell_of(low.head<2>()), to = cell_of(high.head<2>());
  for (long y = from.second; y <= to.second; ++y)
    for (long x = from.first; x <= to.first; ++x)
      if (const auto found = placed_at_.find({x, y}); found != placed_at_.end())
        near.insert(near.end(), found->second.begin(), found->second.end());
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::optional<Pairs> pairs;
  for (std::uint32_t i : near) {
    const Placed& other = placed_[i];
    if (!own.meets({other.low, other.high})) continue;
    if (!pairs) pairs.emplace(body);
    for (const auto& f : other.body.face)
      if (own.meets(box_of(other.body.vertex, f)) &&
          pairs->crosses({other.body.vertex[f[0]], other.body.vertex[f[1]], other.body.vertex[f[2]]}))
        return true;
    if (within(other.body, body.vertex[0]) || within(body, other.body.vertex[0])) return true;
  }
  return false;
}

bool Space::put(Label label, int passage, std::vector<Solid> bodies, double yaw_rad, bool blocks) {
  if (bodies.empty()) return false;
  for (const Solid& body : bodies) {
    const Box3 b = box_of(body);
    if (!body.closed() || meets_rock(body) || meets_bodies(body, b.low, b.high)) return false;
  }
  const Eigen::Rotation2Dd turned(-yaw_rad);
  Box3 whole;
  MineObject object{label, passage};
  for (Solid& body : bodies) {
    object.volume_m3 += body.volume_m3();
    for (const Vec3& v : body.vertex) {
      const Vec2 q = turned * Vec2(v.head<2>());
      whole.add({q.x(), q.y(), v.z()});
    }
    const Box3 b = box_of(body);
    const auto from = cell_of(b.low.head<2>()), to = cell_of(b.high.head<2>());
    for (long y = from.second; y <= to.second; ++y)
      for (long x = from.first; x <= to.first; ++x)
        placed_at_[{x, y}].push_back(static_cast<std::uint32_t>(placed_.size()));
    placed_.push_back({std::move(body), b.low, b.high, objects_.size()});
  }
  const Vec3 middle = 0.5 * (whole.low + whole.high);
  const Vec2 p = turned.inverse() * Vec2(middle.head<2>());
  object.middle_W = {p.x(), p.y(), middle.z()};
  object.size_m = whole.high - whole.low;
  object.yaw_rad = yaw_rad;
  object.blocks = blocks;
  objects_.push_back(object);
  return true;
}

void Space::append_to(Mesh& mesh, int first) const {
  for (const Placed& p : placed_) {
    const MineObject& object = objects_[p.object];
    const auto base = static_cast<std::uint32_t>(mesh.vertex.size());
    mesh.vertex.insert(mesh.vertex.end(), p.body.vertex.begin(), p.body.vertex.end());
    for (const auto& f : p.body.face) {
      mesh.face.push_back({base + f[0], base + f[2], base + f[1]});
      mesh.label.push_back(object.label);
      mesh.part.push_back(first + static_cast<int>(p.object));
      mesh.reflectivity.push_back(reflectivity_of(p.body.material));
      mesh.passage.push_back(object.passage);
      mesh.material.push_back(p.body.material);
      mesh.wetness.push_back(p.body.material == Material::water ? 1.0f : 0.0f);
    }
  }
}

}  // namespace adit
