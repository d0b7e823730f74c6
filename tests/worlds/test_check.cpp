// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/shapes.h"
#include "worlds/worlds.h"

#include <gtest/gtest.h>

namespace adit {
namespace {

World world_of(const Mesh& mesh) {
  World world;
  world.mesh = mesh;
  return world;
}

Mesh both(const Mesh& a, const Mesh& b) {
  Mesh m = a;
  const auto shift = static_cast<std::uint32_t>(a.vertex.size());
  m.vertex.insert(m.vertex.end(), b.vertex.begin(), b.vertex.end());
  for (const auto& f : b.face) m.face.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  m.label.insert(m.label.end(), b.label.begin(), b.label.end());
  m.part.insert(m.part.end(), b.part.begin(), b.part.end());
  m.reflectivity.insert(m.reflectivity.end(), b.reflectivity.begin(), b.reflectivity.end());
  return m;
}

TEST(CheckWorld, ASoundBoxIsSoundAndHasItsVolume) {
  const WorldCheck check = check_world(world_of(fine_box_mesh({0, 0, 0}, {5, 4, 2}, 0.5)));
  EXPECT_TRUE(check.ok()) << check.what();
  EXPECT_NEAR(check.volume_m3, 40, 1e-12);
}

TEST(CheckWorld, ALostFaceIsAnOpenMesh) {
  Mesh box = fine_box_mesh({0, 0, 0}, {5, 4, 2}, 1);
  box.face.pop_back();
  box.label.pop_back();
  const WorldCheck check = check_world(world_of(box));
  EXPECT_FALSE(check.closed);
  EXPECT_FALSE(check.ok());
  EXPECT_NE(check.what().find("not closed"), std::string::npos);
}

TEST(CheckWorld, AMeshInsideOutIsNotOriented) {
  Mesh box = box_mesh({0, 0, 0}, {5, 4, 2});
  for (auto& f : box.face) std::swap(f[0], f[1]);
  const WorldCheck check = check_world(world_of(box));
  EXPECT_TRUE(check.closed);
  EXPECT_FALSE(check.oriented);
}

TEST(CheckWorld, AFaceTurnedAgainstItsNeighboursIsFound) {
  Mesh box = box_mesh({0, 0, 0}, {5, 4, 2});
  std::swap(box.face[3][0], box.face[3][1]);
  EXPECT_FALSE(check_world(world_of(box)).ok());
}

TEST(CheckWorld, TwoBoxesThatRunIntoEachOtherCutEachOther) {
  const Mesh a = box_mesh({0, 0, 0}, {5, 4, 2}), b = box_mesh({4, 1, 0.5}, {9, 3, 1.5});
  EXPECT_GT(check_world(world_of(both(a, b))).self_intersections, 0u);
}

TEST(CheckWorld, CutsAreFoundAlsoInALargeMeshThatIsSearchedInSlabs) {
  const Mesh a = fine_box_mesh({0, 0, 0}, {80, 20, 2}, 0.25), b = box_mesh({79, 1.03, 0.51}, {82, 3.07, 1.53});
  ASSERT_GT(a.face.size(), 100000u);
  EXPECT_EQ(check_world(world_of(a)).self_intersections, 0u);
  EXPECT_GT(check_world(world_of(both(a, b))).self_intersections, 0u);
}

TEST(CheckWorld, FacesWithoutAreaOrLabelAreCounted) {
  Mesh box = box_mesh({0, 0, 0}, {5, 4, 2});
  box.label[2] = Label::none;
  box.vertex.push_back({0, 0, 0});
  box.vertex.push_back({1, 0, 0});
  box.vertex.push_back({2, 0, 0});
  const auto n = static_cast<std::uint32_t>(box.vertex.size());
  box.face.push_back({n - 3, n - 2, n - 1});
  box.label.push_back(Label::rib);
  const WorldCheck check = check_world(world_of(box));
  EXPECT_EQ(check.unlabelled, 1u);
  EXPECT_EQ(check.degenerate_faces, 1u);
}

TEST(CheckWorld, AnEmptyMeshIsNotSound) {
  EXPECT_FALSE(check_world(World{}).ok());
}

}  // namespace
}  // namespace adit
