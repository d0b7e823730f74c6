// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "worlds/crossings.h"
#include "worlds/exact.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

namespace adit {
namespace {

double drawn(std::uint64_t seed, std::uint64_t i) {
  return uniform(seed, Draw::test, i);
}

size_t by_brute_force(const Mesh& mesh) {
  size_t count = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f)
    for (size_t g = f + 1; g < mesh.face.size(); ++g) count += faces_cross(mesh, f, g);
  return count;
}

// Triangles between random points of a small lattice share corners and sides, lie in one plane, touch and cross.
TEST(Crossings, OfTrianglesAtRandomAreThoseThatExactPredicatesFindAmongAllPairs) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Mesh mesh;
    for (int v = 0; v < 64; ++v) {
      const double jitter = seed % 2 ? 0.3 : 0;  // without it many are flat and touch
      mesh.vertex.emplace_back(v % 4 + jitter * drawn(seed, 3 * v), v / 4 % 4 + jitter * drawn(seed, 3 * v + 1),
                               v / 16 + jitter * drawn(seed, 3 * v + 2));
    }
    for (std::uint64_t k = 0; k < 120; ++k) {
      std::array<std::uint32_t, 3> face;
      for (int c = 0; c < 3; ++c) face[c] = static_cast<std::uint32_t>(64 * drawn(seed, 1000 + 3 * k + c));
      if (face[0] == face[1] || face[1] == face[2] || face[0] == face[2]) continue;
      mesh.face.push_back(face);
      if (no_area(mesh, mesh.face.size() - 1)) mesh.face.pop_back();
    }
    EXPECT_EQ(crossing_pairs(mesh), by_brute_force(mesh)) << "seed " << seed;
  }
}

TEST(Crossings, AVertexPushedThroughTheRoofIsFoundInAMine) {
  WorldSettings s;
  s.kind = "panel";
  s.panel.crosscuts = 2;
  s.mesh_edge_m = 0.5;
  Mesh mesh = make_world(s, 1).mesh;
  ASSERT_EQ(crossing_pairs(mesh), 0u);
  mesh.vertex[mesh.face[0][0]].z() += 5;
  EXPECT_GT(crossing_pairs(mesh), 0u);
}

}  // namespace
}  // namespace adit
