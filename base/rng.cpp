// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"

#include <array>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

using Block = std::array<std::uint32_t, 4>;

// Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011: Philox 4x32, ten rounds.
Block philox(Block x, std::uint32_t k0, std::uint32_t k1) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * x[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57} * x[2];
    x = {static_cast<std::uint32_t>(b >> 32) ^ x[1] ^ k0, static_cast<std::uint32_t>(b),
         static_cast<std::uint32_t>(a >> 32) ^ x[3] ^ k1, static_cast<std::uint32_t>(a)};
    k0 += 0x9E3779B9;
    k1 += 0xBB67AE85;
  }
  return x;
}

// The counter is (i, j), the key the seed; the draw is mixed into both words of the key by two rounds of its own.
Block block_at(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j) {
  return Draws(seed, draw).at(i, j);
}

double to_unit(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace

Draws::Draws(std::uint64_t seed, Draw draw) {
  const Block key = philox({static_cast<std::uint32_t>(draw), 0x61646974u, 0, 0}, static_cast<std::uint32_t>(seed),
                           static_cast<std::uint32_t>(seed >> 32));
  key_[0] = key[0];
  key_[1] = key[1];
}

std::array<std::uint32_t, 4> Draws::at(std::uint64_t i, std::uint64_t j) const {
  return philox({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i >> 32), static_cast<std::uint32_t>(j),
                 static_cast<std::uint32_t>(j >> 32)},
                key_[0], key_[1]);
}

// philox, eight counters in step: plain loops that the compiler turns into vectors.
void Draws::eight_at(std::uint64_t i, std::uint64_t j, std::uint32_t (&x)[4][8]) const {
  for (std::uint64_t k = 0; k < 8; ++k) {
    x[0][k] = static_cast<std::uint32_t>(i);
    x[1][k] = static_cast<std::uint32_t>(i >> 32);
    x[2][k] = static_cast<std::uint32_t>(j + k);
    x[3][k] = static_cast<std::uint32_t>((j + k) >> 32);
  }
  std::uint32_t k0 = key_[0], k1 = key_[1];
  for (int round = 0; round < 10; ++round) {
    for (size_t k = 0; k < 8; ++k) {
      const std::uint64_t a = std::uint64_t{0xD2511F53} * x[0][k], b = std::uint64_t{0xCD9E8D57} * x[2][k];
      x[0][k] = static_cast<std::uint32_t>(b >> 32) ^ x[1][k] ^ k0;
      x[1][k] = static_cast<std::uint32_t>(b);
      x[2][k] = static_cast<std::uint32_t>(a >> 32) ^ x[3][k] ^ k1;
      x[3][k] = static_cast<std::uint32_t>(a);
    }
    k0 += 0x9E3779B9;
    k1 += 0xBB67AE85;
  }
}

std::uint64_t random_bits(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j) {
  const Block b = block_at(seed, draw, i, j);
  return (std::uint64_t{b[0]} << 32) | b[1];
}

double uniform(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j) {
  return to_unit(random_bits(seed, draw, i, j));
}

double normal(std::uint64_t seed, Draw draw, std::uint64_t i, std::uint64_t j) {
  const Block b = block_at(seed, draw, i, j);
  const double u = 1.0 - to_unit((std::uint64_t{b[0]} << 32) | b[1]);  // in (0, 1]
  const double v = to_unit((std::uint64_t{b[2]} << 32) | b[3]);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

}  // namespace adit
