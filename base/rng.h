// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace adit {

/// What a random number is for; part of its address. Append only: the order is part of every seed's meaning.
enum class Draw : std::uint32_t {
  test,
  world_layout,
  world_wander,
  world_width,
  world_roll,
  world_roughness,
  world_height,
  world_material,
  push_speed,
  push_stop,
  push_wobble,
  push_gait,
  route,
  mount_error,
  laser_phase,
  laser_jitter,
  laser_device,
  beam_range,
  beam_angle,
  beam_drop,
  beam_detect,
  match_sample,
  eval_sample,
  bootstrap,
  ground_relief,
  beam_chance,
  beam_stray,
  laser_curve,
  laser_warm_up,
  fault_loss,
  world_decay,
  world_furniture,
  set_value,
  study_sample,
};

/// Random numbers have addresses, not an order: the same (seed, draw, i, j) always gives the same number.
/// Philox 4x32-10 (Salmon et al., SC 2011).
std::uint64_t random_bits(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j = 0);
/// In [0, 1).
double uniform(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j = 0);
/// Mean 0, sd 1 (Box-Muller on one address).
double normal(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j = 0);

/// The numbers of one draw of one seed, where many are needed at a time.
class Draws {
 public:
  Draws(std::uint64_t seed, Draw draw);
  /// Four independent words of 32 bits at an address; the first two are random_bits.
  std::array<std::uint32_t, 4> at(std::uint64_t i, std::uint64_t j) const;
  /// The words at (i, j), (i, j + 1), ..., (i, j + 7), side by side: words[w][k] is word w at j + k.
  void eight_at(std::uint64_t i, std::uint64_t j, std::uint32_t (&words)[4][8]) const;

 private:
  std::uint32_t key_[2];
};

}  // namespace adit
