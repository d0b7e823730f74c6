// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/lattice.h"
#include "worlds/worlds.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

using Faults = std::vector<std::string>;

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", v);
  return text;
}

void expect_near(Faults& faults, const std::string& what, double truth, double found, double relative) {
  if (!(std::abs(truth - found) <= relative * std::max(1e-9, std::abs(found))))
    faults.push_back(what + ": the truth says " + number(truth) + ", the mesh " + number(found));
}

void check_ids(const World& truth, const MeshTally& mesh, Faults& faults) {
  const auto say = [&](int named, size_t listed, const char* what) {
    if (named > static_cast<int>(listed))
      faults.push_back("faces name " + std::string(what) + " " + std::to_string(named - 1) + ", the truth lists " +
                       std::to_string(listed));
  };
  say(mesh.passages, truth.passages.size(), "passage");
  say(mesh.pillars, truth.pillars.size(), "pillar");
  say(mesh.objects, truth.objects.size(), "object");
  if (mesh.nameless > 0) faults.push_back(std::to_string(mesh.nameless) + " faces name no passage or pillar");
}

void check_areas(const World& world, Faults& faults) {
  double rock = 0;
  for (size_t i = 0; i < world.pillars.size(); ++i) {
    expect_near(faults, "area of pillar " + std::to_string(i), world.pillars[i].area_m2,
                enclosed_area(world.pillars[i].outline), 1e-9);
    rock += world.pillars[i].area_m2;
  }
  const double floor = world.numbers.floor_area_m2;
  if (!world.outline.empty()) expect_near(faults, "floor area", floor, enclosed_area(world.outline) - rock, 1e-9);
  expect_near(faults, "extraction ratio", world.numbers.extraction_ratio, floor / (floor + rock), 1e-9);
}

// Void and bodies make up the void of the rock alone, each body the volume that is told of it.
void check_objects(const World& world, const MeshTally& mesh, Faults& faults) {
  if (world.objects.empty()) return;
  expect_near(faults, "volume of the rock's void alone", world.numbers.bare_m3, mesh.rock_six_volumes / 6, 1e-9);
  double bodies = 0;
  for (size_t i = 0; i < world.objects.size(); ++i) {
    const MineObject& o = world.objects[i];
    if (o.ground) continue;
    bodies += o.volume_m3;
    const double found = i < mesh.body_six_volumes.size() ? mesh.body_six_volumes[i] / 6 : 0;
    // Summed about a far point: 1e-12 of the products of coordinates.
    if (std::abs(found - o.volume_m3) > 1e-6 * o.volume_m3 + 1e-7)
      faults.push_back("volume of object " + std::to_string(i) + " (" + label_name(o.label) + "): the truth says " +
                       number(o.volume_m3) + ", the mesh " + number(found));
  }
  expect_near(faults, "void and bodies", world.numbers.volume_m3 + bodies, world.numbers.bare_m3, 1e-9);
}

}  // namespace

std::vector<std::string> check_truth(const World& world, const MeshTally& mesh) {
  Faults faults;
  const double volume = mesh.six_volumes / 6;
  expect_near(faults, "volume", world.numbers.volume_m3, volume, 1e-9);
  double sum = 0;
  for (const Passage& p : world.passages) sum += p.volume_m3;
  expect_near(faults, "sum of the passages' volumes", sum, volume, 1e-9);
  check_ids(world, mesh, faults);
  check_objects(world, mesh, faults);
  check_areas(world, faults);
  const int loops = static_cast<int>(world.passages.size()) - static_cast<int>(world.junctions.size()) + 1;
  if (world.numbers.loops != loops)
    faults.push_back("loops: the truth says " + std::to_string(world.numbers.loops) + ", the graph has " +
                     std::to_string(loops));
  return faults;
}

std::vector<std::string> check_truth(const World& world) {
  MeshTally tally;
  if (!world.mesh.vertex.empty()) tally.add(world.mesh, world.mesh.vertex.front());
  return check_truth(world, tally);
}

}  // namespace adit
