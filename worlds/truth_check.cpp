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

void check_ids(const World& world, Faults& faults) {
  const Mesh& m = world.mesh;
  const int passages = static_cast<int>(world.passages.size()), pillars = static_cast<int>(world.pillars.size());
  size_t wrong_part = 0, wrong_passage = 0;
  for (size_t f = 0; f < m.part.size(); ++f) {
    const bool level = m.label[f] == Label::floor || m.label[f] == Label::roof;
    wrong_part += level ? m.part[f] < 0 || m.part[f] >= passages : m.part[f] < -1 || m.part[f] >= pillars;
  }
  for (int id : m.passage) wrong_passage += id < 0 || id >= passages;
  const auto say = [&](size_t n, const char* what) {
    if (n > 0) faults.push_back(std::to_string(n) + " faces name a " + what + " that the truth does not list");
  };
  say(wrong_part, "part");
  say(wrong_passage, "passage");
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

}  // namespace

std::vector<std::string> check_truth(const World& world) {
  Faults faults;
  const double volume = enclosed_volume(world.mesh);
  expect_near(faults, "volume", world.numbers.volume_m3, volume, 1e-9);
  double sum = 0;
  for (const Passage& p : world.passages) sum += p.volume_m3;
  expect_near(faults, "sum of the passages' volumes", sum, volume, 1e-9);
  if (!world.mesh.part.empty() && world.mesh.label.size() == world.mesh.part.size()) check_ids(world, faults);
  check_areas(world, faults);
  const int loops = static_cast<int>(world.passages.size()) - static_cast<int>(world.junctions.size()) + 1;
  if (world.numbers.loops != loops)
    faults.push_back("loops: the truth says " + std::to_string(world.numbers.loops) + ", the graph has " +
                     std::to_string(loops));
  return faults;
}

}  // namespace adit
