// SPDX-License-Identifier: BSD-3-Clause
// What the page carries of a run: thinned meshes, packed numbers, an animated picture.
#include "base/rng.h"
#include "eval/animation.h"
#include "eval/packed.h"
#include "eval/picture.h"
#include "eval/thinned.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

TEST(Thinned, ABoxKeepsItsSidesAndItsRoofComesLast) {
  const Mesh box = fine_box_mesh(Vec3(0, 0, 0), Vec3(20, 6, 2), 0.1);
  const ThinMesh thin = thinned(box, {}, 4000);
  ASSERT_LE(thin.face.size(), 4000u);
  ASSERT_GT(thin.face.size(), 400u);
  // A vertex is the mean of those of its cube, so it stands within the cube's diagonal of each of them.
  const double reach = thin.cube_m * std::sqrt(3.0);
  for (const Vec3& p : thin.vertex) {
    const double side = std::min({std::abs(p.x()), std::abs(20 - p.x()), std::abs(p.y()), std::abs(6 - p.y()),
                                  std::abs(p.z()), std::abs(2 - p.z())});
    EXPECT_LE(side, reach);
  }
  const auto height = [&](size_t f) {
    return (thin.vertex[thin.face[f][0]].z() + thin.vertex[thin.face[f][1]].z() + thin.vertex[thin.face[f][2]].z()) / 3;
  };
  ASSERT_LT(thin.roof, thin.face.size());
  for (size_t f = thin.roof; f < thin.face.size(); ++f) EXPECT_GT(height(f), 2 - reach);
}

TEST(Thinned, AMeshThatIsSmallEnoughKeepsItsVolume) {
  const Mesh ball = sphere_mesh(Vec3(1, 2, 3), 5, 4);
  const ThinMesh thin = thinned(ball, {}, ball.face.size());
  Mesh back;
  back.vertex = thin.vertex;
  back.face = thin.face;
  // Edges of 0.35 m, cubes of at most 0.25 m: vertices move by half a cube's diagonal at most.
  EXPECT_NEAR(enclosed_volume(back) / enclosed_volume(ball), 1, 3 * thin.cube_m / 5);
}

TEST(Thinned, ValuesAreMeansAndWhatHasNoneStaysWithout) {
  const Mesh box = fine_box_mesh(Vec3(0, 0, 0), Vec3(4, 4, 2), 0.2);
  std::vector<float> value;
  for (const Vec3& p : box.vertex) value.push_back(p.x() < 1 ? NAN : 0.25f);
  const ThinMesh thin = thinned(box, value, 1000);
  int without = 0;
  for (size_t v = 0; v < thin.vertex.size(); ++v) {
    if (std::isnan(thin.value[v]))
      ++without;
    else
      EXPECT_FLOAT_EQ(thin.value[v], 0.25f);
  }
  EXPECT_GT(without, 0);
  EXPECT_TRUE(thinned({}, {}, 10).face.empty());
}

// The reader in eval/page/src/unpack.js, in C++.
template <class Number>
std::vector<Number> undone(const std::string& bytes, size_t stride) {
  const size_t n = bytes.size() / sizeof(Number);
  std::vector<Number> values(n);
  for (size_t i = 0; i < n; ++i) {
    Number code = 0;
    for (size_t b = 0; b < sizeof(Number); ++b)
      code = static_cast<Number>(code | static_cast<Number>(static_cast<std::uint8_t>(bytes[b * n + i])) << (8 * b));
    const auto step = static_cast<Number>((code >> 1) ^ (code & 1 ? static_cast<Number>(~Number{0}) : 0));
    values[i] = static_cast<Number>(step + (i >= stride ? values[i - stride] : 0));
  }
  return values;
}

TEST(Packed, DifferencesGiveTheNumbersBack) {
  for (const size_t stride : {1u, 3u}) {
    std::vector<std::uint16_t> small = {0, 65535, 0, 32768, 1, 32767, 65535, 65535};
    std::vector<std::uint32_t> large = {0, ~0u, 0, 1u << 31, 1, 7};
    for (std::uint64_t i = 0; i < 500; ++i) {
      small.push_back(static_cast<std::uint16_t>(65536 * uniform(1, Draw::test, i)));
      large.push_back(static_cast<std::uint32_t>(4294967296.0 * uniform(2, Draw::test, i)));
    }
    EXPECT_EQ(undone<std::uint16_t>(delta_bytes(small, stride), stride), small);
    EXPECT_EQ(undone<std::uint32_t>(delta_bytes(large, stride), stride), large);
  }
}

TEST(Packed, WhatIsAlikePacksSmall) {
  EXPECT_LT(packed(std::string(100000, 'a')).size(), 400u);
  EXPECT_EQ(packed("abc"), packed("abc"));
}

TEST(Animation, ItsFirstPictureIsAPngAndItsFramesAreNumbered) {
  std::vector<std::string> frames;
  for (int k = 0; k < 3; ++k) frames.push_back(encode_png(Picture(40, 30, rgb(0x102030u * (k + 1)))));
  const std::string file = encode_animation(frames, 400);
  // libpng reads the first picture, and checks the sums of what it reads.
  EXPECT_EQ(decode_png(file, "animation").pixel, decode_png(frames[0], "frame").pixel);
  std::vector<std::string> kinds;
  std::vector<int> numbers;
  for (size_t at = 8; at + 12 <= file.size();) {
    const auto byte = [&](size_t i) { return static_cast<std::uint8_t>(file[at + i]); };
    const size_t length = byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
    kinds.push_back(file.substr(at + 4, 4));
    if (kinds.back() == "fcTL" || kinds.back() == "fdAT") numbers.push_back(byte(11));
    at += 12 + length;
  }
  EXPECT_EQ(kinds, (std::vector<std::string>{"IHDR", "acTL", "fcTL", "IDAT", "fcTL", "fdAT", "fcTL", "fdAT", "IEND"}));
  EXPECT_EQ(numbers, (std::vector<int>{0, 1, 2, 3, 4}));
}

}  // namespace
}  // namespace adit
