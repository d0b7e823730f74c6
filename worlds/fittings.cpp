// SPDX-License-Identifier: BSD-3-Clause
// Sizes: posts and crossbars 30 CFR 75.206; bolts 75.222; track gauge 42 in, the American mine standard; the rest practice.
#include "worlds/fittings.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr double gap_m = Space::gap_m;

using Height = std::function<double(const LevelPoint&)>;

Height on_floor() {
  return [](const LevelPoint& v) { return v.floor_z + gap_m; };
}
Height to_roof() {
  return [](const LevelPoint& v) { return v.roof_z - gap_m; };
}
Height at(double z) {
  return [z](const LevelPoint&) { return z; };
}

std::function<double(const Vec2&)> level_at(double z) {
  return [z](const Vec2&) { return z; };
}

// Adds a column if there is one; says whether.
bool add(Bodies& bodies, const std::optional<LevelPatch>& patch, const Height& bottom, const Height& top,
         Material material) {
  if (!patch) return false;
  auto solid = column(*patch, bottom, top);
  if (!solid) return false;
  solid->material = material;
  bodies.push_back(std::move(*solid));
  return true;
}

void add(Bodies& bodies, Solid solid, Material material) {
  solid.material = material;
  bodies.push_back(std::move(solid));
}

}  // namespace

double free_m(const Space& space, const Spot& spot, double sign, const std::vector<double>& shares) {
  const auto here = space.level(spot.p);
  if (!here) return 0;
  double least = 1e9;
  for (double share : shares)
    for (double along : {-0.15, 0.0, 0.15}) {
      const Vec2 p = spot.p + along * spot.along, way = sign * spot.left();
      const double z = here->floor_z + share * (here->roof_z - here->floor_z);
      least = std::min(least, space.sight_m({p.x(), p.y(), z}, {way.x(), way.y(), 0}));
    }
  return least;
}

Bodies post(const Space& space, const Vec2& p, const Vec2& along, double radius_m) {
  Bodies bodies;
  const auto cap = space.patch(rectangle(p, along, 0.2, radius_m + 0.03));
  const auto foot = space.patch(regular(p, radius_m, 10, 0.1));
  if (!cap || !foot) return {};
  const double z = cap->roof_low() - 0.07;
  if (!add(bodies, foot, on_floor(), at(z - gap_m), Material::timber)) return {};
  if (!add(bodies, cap, at(z), to_roof(), Material::timber)) return {};
  return bodies;
}

Bodies crossbar(const Space& space, const Spot& spot, double right_m, double left_m) {
  constexpr double half_width = 0.09, deep = 0.18;
  Bodies bodies;
  const Vec2 across = spot.left(), middle = spot.beside(0.5 * (left_m + right_m));
  const Loop bar = rectangle(middle, across, 0.5 * (left_m - right_m), half_width);
  const auto over = space.patch(bar);
  if (!over) return {};
  const double top = over->roof_low() - 2 * gap_m;
  add(bodies, slab(bar, level_at(top - deep), level_at(top)), Material::timber);
  for (double side : {left_m - 0.2, right_m + 0.2})
    if (!add(bodies, space.patch(regular(spot.beside(side), 0.08, 10, 0.1)), on_floor(), at(top - deep - gap_m),
             Material::timber))
      return {};
  return bodies;
}

Bodies crib(const Space& space, const Vec2& p, const Vec2& along, double side_m) {
  constexpr double timber = 0.15;
  Bodies bodies;
  const Vec2 across(-along.y(), along.x());
  const double off = 0.5 * (side_m - timber);
  const auto under = space.patch(rectangle(p, along, side_m / 2, side_m / 2));
  if (!under) return {};
  const double first = under->floor_high() + timber - 0.03;
  const int layers = static_cast<int>((under->roof_low() - 0.04 - first) / timber) + 1;
  if (layers < 3) return {};
  for (int k = 0; k < layers; ++k) {
    const Vec2 way = k % 2 ? across : along, beside = k % 2 ? along : across;
    for (double sign : {-1.0, 1.0}) {
      const auto patch = space.patch(rectangle(p + sign * off * beside, way, side_m / 2, timber / 2));
      const double low = first + (k - 1) * timber + gap_m, high = first + k * timber;
      if (!add(bodies, patch, k == 0 ? on_floor() : at(low), k + 1 == layers ? to_roof() : at(high), Material::timber))
        return {};
    }
  }
  return bodies;
}

Bodies bolt(const Space& space, const Vec2& p, const Vec2& along) {
  constexpr double half = 0.085, plate = 0.012, head = 0.05;
  const Loop square = rectangle(p, along, half, half);
  const auto patch = space.patch(square);
  const auto here = space.level(p);
  const auto ahead = space.level(p + half * along), beside = space.level(p + half * Vec2(-along.y(), along.x()));
  if (!patch || !here || !ahead || !beside) return {};
  // The roof's slope under it, lowered until nothing of the roof is below.
  const double ga = (ahead->roof_z - here->roof_z) / half, gb = (beside->roof_z - here->roof_z) / half;
  if (std::max(std::abs(ga), std::abs(gb)) > 1) return {};
  const auto slope = [&](const Vec2& q) {
    return (q - p).dot(along) * ga + (q - p).dot(Vec2(-along.y(), along.x())) * gb;
  };
  double z = 1e300;
  for (const LevelPoint& v : patch->vertex) z = std::min(z, v.roof_z - slope(v.p));
  z -= gap_m;
  std::vector<std::vector<Vec3>> rings;
  const auto ring = [&](double size, double below) {
    rings.emplace_back();
    for (const Vec2& q : rectangle(p, along, size, size)) rings.back().emplace_back(q.x(), q.y(), z - below + slope(q));
  };
  ring(0.018, plate + head);
  ring(0.022, plate + 0.001);
  ring(half, plate);
  ring(half, 0);
  Bodies bodies;
  add(bodies, loft(rings), Material::steel);
  return bodies;
}

Bodies tie(const Space& space, const Spot& spot, double half_length_m, double* top_z) {
  Bodies bodies;
  const auto patch = space.patch(rectangle(spot.p, spot.left(), half_length_m, 0.09));
  if (!patch) return {};
  // Bedded: it follows the floor, so that small wheels get over it.
  constexpr double proud_m = 0.013;
  *top_z = patch->floor_high() + proud_m;
  if (!add(
          bodies, patch, on_floor(), [](const LevelPoint& v) { return v.floor_z + proud_m; }, Material::timber))
    return {};
  return bodies;
}

Bodies rail(const Vec2& from, const Vec2& to, double from_z, double to_z) {
  const Vec2 way = (to - from).normalized();
  const double length = (to - from).norm();
  const auto z = [=](double over) {
    return [=](const Vec2& q) { return from_z + (to_z - from_z) * (q - from).dot(way) / length + over; };
  };
  // Foot, web and head in one outline would be concave: a bar as wide as the head is what a beam meets.
  Bodies bodies;
  add(bodies, slab(rectangle(0.5 * (from + to), way, 0.5 * length, 0.028), z(0), z(0.09)), Material::steel);
  return bodies;
}

Bodies belt(const Space& space, const Spot& spot, double length_m) {
  constexpr double half_width = 0.6, height = 0.9;
  const double half = 0.5 * length_m - 0.005;
  const auto back = space.level(spot.p - half * spot.along), front = space.level(spot.p + half * spot.along);
  if (!back || !front) return {};
  const double z0 = 0.5 * (back->floor_z + front->floor_z), grade = (front->floor_z - back->floor_z) / (2 * half);
  const auto z = [=](double over) {
    return [=](const Vec2& q) { return z0 + grade * (q - spot.p).dot(spot.along) + over; };
  };
  Bodies bodies;
  add(bodies, slab(rectangle(spot.p, spot.along, half, half_width - 0.08), z(height), z(height + 0.03)),
      Material::none);
  add(bodies, slab(rectangle(spot.p, spot.along, half, half_width - 0.12), z(0.4), z(0.42)), Material::none);
  for (double side : {-1.0, 1.0}) {
    const Vec2 beside = spot.beside(side * half_width);
    add(bodies, slab(rectangle(beside, spot.along, half, 0.04), z(height - 0.12), z(height)), Material::steel);
    for (double end : {-1.0, 1.0}) {
      const Vec2 p = beside + end * (half - 0.3) * spot.along;
      const auto top = z(height - 0.12 - gap_m);
      if (!add(
              bodies, space.patch(rectangle(p, spot.along, 0.03, 0.03)), on_floor(),
              [top](const LevelPoint& v) { return top(v.p); }, Material::steel))
        return {};
    }
  }
  return bodies;
}

Bodies car(const Spot& spot, double wheel_z, double pitch) {
  constexpr double wheel = 0.2, half_gauge = 0.535, half_base = 0.55;
  Pose X = Pose::Identity();
  X.translation() = Vec3(spot.p.x(), spot.p.y(), wheel_z + wheel);
  X.linear() = (Eigen::AngleAxisd(std::atan2(spot.along.y(), spot.along.x()), Vec3::UnitZ()) *
                Eigen::AngleAxisd(-pitch, Vec3::UnitY()))
                   .toRotationMatrix();
  Bodies bodies;
  for (double x : {-half_base, half_base})
    for (double y : {-half_gauge, half_gauge})
      add(bodies, tube_along({X * Vec3(x, y - 0.04, 0), X * Vec3(x, y + 0.04, 0)}, wheel, 14), Material::steel);
  add(bodies, box(X * Pose(Eigen::Translation3d(0, 0, 0.1)), {1.35, 0.35, 0.07}), Material::steel);
  std::vector<std::vector<Vec3>> rings;
  const auto ring = [&](double x, double y, double z) {
    rings.push_back({X * Vec3(-x, -y, z), X * Vec3(x, -y, z), X * Vec3(x, y, z), X * Vec3(-x, y, z)});
  };
  ring(1.1, 0.5, 0.22);  // the tub: up its outside, over its rim, down its inside
  ring(1.3, 0.7, 0.95);
  ring(1.25, 0.65, 0.95);
  ring(1.06, 0.46, 0.27);
  add(bodies, loft(rings), Material::steel);
  return bodies;
}

Bodies fallen_beam(const Vec3& from, const Vec3& to) {
  const Vec3 x = (to - from).normalized(), y = Vec3::UnitZ().cross(x).normalized();
  Pose X = Pose::Identity();
  X.linear() << x, y, x.cross(y);
  X.translation() = 0.5 * (from + to);
  Bodies bodies;
  add(bodies, box(X, {0.5 * (to - from).norm(), 0.1, 0.11}), Material::timber);
  return bodies;
}

Bodies loose_block(const Space& space, const Loop& footprint, double height_m, const Vec2& lean) {
  Bodies bodies;
  const auto patch = space.patch(footprint);
  if (!patch) return {};
  const Vec2 middle = footprint[0];
  const double z = patch->floor_high() + height_m;
  add(
      bodies, patch, on_floor(), [=](const LevelPoint& v) { return z + lean.dot(v.p - middle); }, Material::shale);
  return bodies;
}

StoppingBodies stopping(const Space& space, const Spot& spot, double door_left_m, double rib_gap_m, double widest_m) {
  constexpr double half_thick = 0.1, door_half = 0.45, course = 0.2;
  StoppingBodies out;
  const auto here = space.level(spot.p);
  if (!here) return {};
  const Vec2 across = spot.left();
  const auto width = [&](double sign, double z0, double z1) {
    double least = 1e9;
    for (double z : {z0 + 0.01, 0.75 * z0 + 0.25 * z1, 0.5 * (z0 + z1), 0.25 * z0 + 0.75 * z1, z1 - 0.01})
      for (double t : {-half_thick, -0.5 * half_thick, 0.0, 0.5 * half_thick, half_thick}) {
        const Vec2 p = spot.p + t * spot.along;
        least = std::min(least, space.sight_m({p.x(), p.y(), z}, {sign * across.x(), sign * across.y(), 0}));
      }
    return std::isfinite(least) ? least - rib_gap_m : 0;
  };
  // Floor and roof across most of the way: what lies at the ribs is for the courses to end at.
  const std::vector<double> middle{0.3, 0.5, 0.7};
  const double wide = 0.85 * std::min(free_m(space, spot, 1, middle), free_m(space, spot, -1, middle));
  if (!(wide > 0.5) || wide > widest_m) return {};
  const auto whole = space.patch(rectangle(spot.p, across, wide, half_thick));
  if (!whole) return {};
  // Courses of blocks; the lowest stands on the floor, the highest ends at the roof.
  const double first = whole->floor_high() + 0.1, last = whole->roof_low() - 0.1;
  if (last - first < 1) return {};
  const int between = std::max(1, static_cast<int>(std::lround((last - first) / course)));
  const double door_top = std::min(whole->floor_high() + 1.2, last - 0.2);
  const auto add_part = [&](double from, double to, const Height& bottom, const Height& top) {
    if (to - from < 0.05) return true;
    return add(out.wall, space.patch(rectangle(spot.beside(0.5 * (from + to)), across, 0.5 * (to - from), half_thick)),
               bottom, top, Material::block);
  };
  for (int k = -1; k <= between; ++k) {
    const double low = first + (last - first) * k / between + (k >= 0 ? gap_m : 0),
                 high = first + (last - first) * (k + 1) / between;
    const double z0 = k < 0 ? here->floor_z + 0.02 : low, z1 = k == between ? here->roof_z - 0.02 : high;
    const double left = width(1, z0, z1), right = -width(-1, z0, z1);
    if (std::max(left, -right) > widest_m) return {};
    const Height bottom = k < 0 ? on_floor() : at(low), top = k == between ? to_roof() : at(high);
    const bool beside_door = z0 < door_top;
    if (beside_door) {
      if (!add_part(right, door_left_m - door_half, bottom, top)) return {};
      if (!add_part(door_left_m + door_half, left, bottom, top)) return {};
    } else if (!add_part(right, left, bottom, top)) {
      return {};
    }
  }
  const auto under = space.patch(rectangle(spot.beside(door_left_m), across, door_half, half_thick));
  if (!under) return {};
  add(out.door,
      slab(rectangle(spot.beside(door_left_m), across, door_half - 0.01, 0.025), level_at(under->floor_high() + 0.02),
           level_at(door_top - 0.01)),
      Material::steel);
  return out;
}

}  // namespace adit
