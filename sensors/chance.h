// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/rng.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace adit {

/// What is drawn for every beam.
struct Chance {
  double range, angle;  // mean 0, sd 1
  double detect, drop;  // in (0, 1)
};

/// The same of many beams, by its numbers.
struct Chances {
  std::vector<double> range, angle, detect, drop;  // (n)

  void resize(size_t n) { range.resize(n), angle.resize(n), detect.resize(n), drop.resize(n); }
  size_t size() const { return range.size(); }
  Chance operator[](size_t i) const { return {range[i], angle[i], detect[i], drop[i]}; }
};

/// Which of the normal numbers are asked for; the others become 0.
enum class Normals { none, range, both };

/// The chance of beams 0 to n - 1 of a scan, into places `at` on: each at its own address, so that any part of them is
/// the same.
/// @param draws  of Draw::beam_chance
void draw_chances(const Draws& draws, std::uint64_t scan, size_t n, Normals normal, Chances& chances, size_t at);
/// That of one beam.
Chance chance_at(const Draws& draws, std::uint64_t scan, std::uint64_t beam);

}  // namespace adit
