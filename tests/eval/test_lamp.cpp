// SPDX-License-Identifier: BSD-3-Clause
#include "base/rng.h"
#include "eval/lamp.h"
#include "eval/mine_views.h"
#include "rays/caster.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace adit {
namespace {

double uniform_in(std::uint64_t draw, int k, double low, double high) {
  return low + (high - low) * uniform(7, Draw::test, draw, static_cast<std::uint64_t>(k));
}

TEST(Lamp, WhateverThePictureHoldsIsLit) {
  constexpr int width = 320, height = 200;
  int within = 0, beside = 0;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const double yaw = uniform_in(i, 0, -3, 3), pitch = uniform_in(i, 1, -1, 1);
    const Camera camera = camera_of(
        {Vec3(1, 2, 3), Vec3(std::cos(pitch) * std::cos(yaw), std::cos(pitch) * std::sin(yaw), std::sin(pitch))});
    const Vec3 p(uniform_in(i, 2, -40, 40), uniform_in(i, 3, -40, 40), uniform_in(i, 4, -10, 10));
    const auto at = project(camera, width, height, p);
    const bool seen = at && at->x() >= 0 && at->x() <= width && at->y() >= 0 && at->y() <= height;
    const bool lit = lit_from(camera, static_cast<double>(width) / height)(p);
    EXPECT_TRUE(lit || !seen) << "draw " << i;
    within += seen;
    beside += !lit;
  }
  EXPECT_GT(within, 100);
  EXPECT_GT(beside, 1000);  // most of what lies all about is not drawn
}

// A tunnel along x with a box of half a metre on its floor.
World tunnel_with_a_post() {
  World world = tunnel_world(30, 4, 2, 0.5);
  Mesh& mesh = world.mesh;
  mesh.part.resize(mesh.face.size(), 0);
  const Mesh box = box_mesh({14.75, 1.0, 0.2}, {15.25, 1.5, 1.5});
  const auto first = static_cast<std::uint32_t>(mesh.vertex.size());
  mesh.vertex.insert(mesh.vertex.end(), box.vertex.begin(), box.vertex.end());
  for (const auto& f : box.face) {
    mesh.face.push_back({first + f[0], first + f[2], first + f[1]});  // faces look into a body
    mesh.label.push_back(Label::post);
    mesh.part.push_back(0);
  }
  mesh.reflectivity.clear();
  std::vector<Vec3>& line = world.passages[0].centre_line;
  line.clear();
  for (double x = 0; x <= 30; x += 0.5) line.emplace_back(x, 0, 0);
  return world;
}

TEST(Lamp, AThingIsLookedAtFromWhereItIsSeen) {
  const World world = tunnel_with_a_post();
  const auto from = lookout_to(world, Label::post);
  ASSERT_TRUE(from);
  EXPECT_NEAR((Vec3(15, 1.25, 0.85) - from->eye).norm(), 4, 1);
  const Caster caster(world.mesh);
  const Hit hit = caster.nearest(Ray{from->eye, from->ahead, 20});
  ASSERT_GE(hit.face, 0);
  EXPECT_EQ(world.mesh.label[static_cast<size_t>(hit.face)], Label::post);
  EXPECT_FALSE(lookout_to(world, Label::crib));
}

TEST(Lamp, APictureOfAThingHoldsItsColour) {
  const World world = tunnel_with_a_post();
  const Picture with = look_into(world, camera_of(*lookout_to(world, Label::post)), 160, 100),
                without = look_into(tunnel_world(30, 4, 2, 0.5), camera_of(*lookout_to(world, Label::post)), 160, 100);
  size_t timber = 0, grey = 0;
  for (size_t k = 0; k < with.pixel.size(); ++k) {
    timber += with.pixel[k].r > with.pixel[k].b + 40;
    grey += without.pixel[k].r > without.pixel[k].b + 40;
  }
  // 0.5 m x 1.3 m some 3.8 m away, 77 pixels to the radian: 270 of them; a few of the floor are as warm.
  EXPECT_GT(timber, 200u);
  EXPECT_LT(grey, 20u);
}

}  // namespace
}  // namespace adit
