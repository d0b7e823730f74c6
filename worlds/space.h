// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/world.h"
#include "rays/caster.h"
#include "worlds/plan_grid.h"

#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace adit {

/// Where water would stand.
struct Basin {
  LevelPatch patch;
  double level_z;
};

/// A piece of a mine's void into which bodies are put, one after the other. Bodies keep off the rock and off one another
/// by a millimetre or more: what is put is asked for by exact predicates, and refused where it would touch.
class Space {
 public:
  /// @param rock    its faces 2 k and 2 k + 1 are floor and roof over triangle k of the plan, for k < levels; kept by
  ///                reference
  Space(const Mesh& rock, size_t levels);

  static constexpr double gap_m = 1e-3;  // between what follows the rock and the rock

  /// What a convex polygon (counter-clockwise) cuts out of floor and roof; none where it reaches beyond them.
  std::optional<LevelPatch> patch(const Loop& polygon) const;
  /// Floor and roof over a point.
  std::optional<LevelPoint> level(const Vec2& p) const;
  /// How far it is to the rock, +inf: no rock.
  double sight_m(const Vec3& from, const Vec3& direction) const;
  /// The triangles about a place that lie under water up to `depth_m` over it, off the ribs and off what stands there; none
  /// where they reach farther than reach_m, or are too few.
  std::optional<Basin> basin(const Vec2& lowest, double depth_m, double reach_m) const;

  /// Puts one thing made of bodies. Says whether it could be put: closed, clear of rock and of all before it.
  bool put(Label label, int passage, std::vector<Solid> bodies, double yaw_rad, bool blocks = false);
  const std::vector<MineObject>& objects() const { return objects_; }

  /// Adds the bodies to the rock's mesh, as parts first, first + 1, ...: faces turned, since the mesh bounds the void.
  void append_to(Mesh& mesh, int first) const;

 private:
  struct Placed {
    Solid body;
    Vec3 low, high;
    size_t object;
  };
  bool meets_rock(const Solid& body) const;
  bool meets_bodies(const Solid& body, const Vec3& low, const Vec3& high) const;

  bool stands_in(const std::array<Vec2, 3>& triangle, double below_z) const;
  void keep_sheet(std::vector<char>& wet, std::uint32_t from) const;
  void find_neighbours() const;
  LevelPoint corner(std::uint32_t k, int c) const;
  bool on_rim(std::uint32_t k, int c) const { return rim_[name(k, c)] != 0; }
  std::uint32_t name(std::uint32_t k, int c) const { return rock_.face[2 * size_t{k} + 1][c]; }

  const Mesh& rock_;
  size_t levels_;
  mutable std::vector<std::array<std::int32_t, 3>>
      next_;                       // (levels) beyond side c of a triangle, -1 none; made when asked for
  mutable std::vector<char> rim_;  // (vertices of the roof) at the ribs
  Caster caster_;
  PlanGrid plan_, faces_;  // triangles of the plan; faces
  std::vector<Placed> placed_;
  std::map<std::pair<long, long>, std::vector<std::uint32_t>> placed_at_;
  std::vector<MineObject> objects_;
};

/// Diffuse reflectivity of a material at 905 nm.
float reflectivity_of(Material material);

}  // namespace adit
