// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/rng.h"

#include <cstdint>
#include <span>

namespace adit {

/// What is drawn for every beam.
struct Chance {
  double range, angle;  // mean 0, sd 1
  double detect, drop;  // in (0, 1)
};

/// The chance of beams 0, 1, ... of a scan, all at once: each at its own address, so that any part of them is the same.
/// @param draws  of Draw::beam_chance
void draw_chances(const Draws& draws, std::uint64_t scan, std::span<Chance> chances);
/// That of one beam.
Chance chance_at(const Draws& draws, std::uint64_t scan, std::uint64_t beam);

}  // namespace adit
