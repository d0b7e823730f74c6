// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"

#include <map>
#include <string>
#include <vector>

namespace adit {

/// Where passages meet or end. Its id is its index in World::junctions.
struct Junction {
  Vec3 p_W;                   // on the floor
  std::vector<int> passages;  // ids of those that meet here; one = a dead end

  int degree() const { return static_cast<int>(passages.size()); }
};

/// A driven way between two junctions. Its id is its index in World::passages.
struct Passage {
  int a, b;                       // junction ids
  std::vector<Vec3> centre_line;  // on the floor, from a to b, both included, about every metre
  double width_m, height_m;       // means over the passage
  double length_m;                // along the centre line, in plan
  double volume_m3 = 0;           // of its share of the void; all together are the mine's
  bool blocked = false;           // no vehicle gets through: routes leave it out
};

/// Rock encircled by passages. Its id is its index in World::pillars.
struct Pillar {
  std::vector<Vec2> outline;  // counter-clockwise, at mid height
  double area_m2;
};

/// A thing in a mine, or what fell in it. Its id is its index in World::objects.
struct MineObject {
  Label label;
  int passage = -1;              // in which it lies
  Vec3 middle_W = Vec3::Zero();  // of its box
  Vec3 size_m = Vec3::Zero();    // along x, y, z of the box
  double yaw_rad = 0;            // of the box's x
  double volume_m3 = 0;
  bool ground = false;  // a part of the rock's surface (rubble, cavity, scar): no closed body of its own
  bool blocks = false;  // no vehicle gets past it
};

/// Exact numbers of a mine.
struct WorldNumbers {
  double volume_m3 = 0;         // enclosed void
  double floor_area_m2 = 0;     // plan area of the void at mid height
  double extraction_ratio = 0;  // floor area / (floor area + pillar areas)
  int loops = 0;                // independent cycles of the junction graph
  double bare_m3 = 0;           // void with the bodies in it taken out, i.e. of the rock alone; 0: there are none
};

/// A mine with its truth, in W.
struct World {
  std::string name;
  Mesh mesh;
  std::vector<Junction> junctions;
  std::vector<Passage> passages;
  std::vector<Pillar> pillars;
  std::vector<Vec2> outline = {};  // outer rim of the void at mid height, counter-clockwise; empty where not known
  WorldNumbers numbers;
  std::vector<MineObject> objects = {};
  std::map<Label, int> left_out = {};  // things that chance asked for, and that had no room
};

/// A basis of the junction graph's cycles, each the passages that it runs through in their order: as many as
/// numbers.loops.
std::vector<std::vector<int>> cycle_basis(const World& world);

/// Ground that a wheel can stand on: floor, rubble, talus, sludge.
Mesh floor_of(const World& world);
/// Hex digest of mesh and numbers; scores are comparable only under the same one.
std::string world_hash(const World& world);

/// DIR/mine.ply, mine.glb, truth.json.
void save_world(const std::string& dir, const World& world);
World load_world(const std::string& dir);

}  // namespace adit
