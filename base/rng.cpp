// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"

#include <immintrin.h>

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

// philox, eight counters in step: each word of four of them in the low halves of a register's four places, where the
// processor's product of 32 by 32 bits wants them; what stands in the high halves is never looked at.
void Draws::eight_at(std::uint64_t i, std::uint64_t j, std::uint32_t (&words)[4][8]) const {
  const auto all = [](std::uint64_t word) { return _mm256_set1_epi64x(static_cast<long long>(word)); };
  const __m256i j_low = _mm256_add_epi64(all(j), _mm256_setr_epi64x(0, 1, 2, 3)),
                j_high = _mm256_add_epi64(j_low, all(4));
  const __m256i m0 = all(0xD2511F53), m1 = all(0xCD9E8D57);
  __m256i x[4][2] = {{all(i), all(i)}, {all(i >> 32), all(i >> 32)}, {j_low, j_high}, {}};
  for (int h = 0; h < 2; ++h) x[3][h] = _mm256_srli_epi64(x[2][h], 32);
  std::uint32_t k0 = key_[0], k1 = key_[1];
  for (int round = 0; round < 10; ++round) {
    const __m256i key0 = all(k0), key1 = all(k1);
    for (auto h : {0, 1}) {
      const __m256i a = _mm256_mul_epu32(m0, x[0][h]), b = _mm256_mul_epu32(m1, x[2][h]);
      x[0][h] = _mm256_xor_si256(_mm256_xor_si256(_mm256_srli_epi64(b, 32), x[1][h]), key0);
      x[1][h] = b;
      x[2][h] = _mm256_xor_si256(_mm256_xor_si256(_mm256_srli_epi64(a, 32), x[3][h]), key1);
      x[3][h] = a;
    }
    k0 += 0x9E3779B9;
    k1 += 0xBB67AE85;
  }
  const __m256i low = _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6);
  for (int w = 0; w < 4; ++w) {
    const __m256i first = _mm256_permutevar8x32_epi32(x[w][0], low), second = _mm256_permutevar8x32_epi32(x[w][1], low);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(words[w]), _mm256_blend_epi32(first, second, 0xF0));
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
