// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "eval/drawing.h"
#include "eval/picture.h"
#include "eval/ramp.h"
#include "eval/scene.h"
#include "eval/type.h"
#include "tests/support/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

namespace adit {
namespace {

Skin plain(const Mesh& mesh, Colour colour) {
  return skin_of(mesh, [=](std::uint32_t, Label) { return colour; });
}

size_t differing(const Picture& picture, Colour background) {
  return static_cast<size_t>(
      std::count_if(picture.pixel.begin(), picture.pixel.end(), [&](const Colour& c) { return c != background; }));
}

TEST(Scene, ATriangleSeenFromAboveCoversItsAreaInPixels) {
  Mesh mesh;
  mesh.vertex = {Vec3(-2, -1, 0), Vec3(2, -1, 0), Vec3(0, 2, 0)};
  mesh.face = {{0, 1, 2}};
  Scene scene;
  scene.skins = {plain(mesh, rgb(0x204080))};
  Camera camera;  // from z = 10 down
  camera.up = Vec3::UnitY();
  camera.height_m = 8;
  const Picture picture = take_picture(scene, camera, 320, 240);  // 30 px per metre
  // 6 m2 = 5400 pixels; an outline of 11.2 m = 337 pixels, each of which may be touched without being covered.
  EXPECT_NEAR(static_cast<double>(differing(picture, scene.background)), 5400, 337);
  EXPECT_NE(picture.at(160, 120), scene.background);
  EXPECT_EQ(picture.at(160, 120 + 31), scene.background);  // just below y = -1
  EXPECT_NE(picture.at(160, 120 + 28), scene.background);
  EXPECT_EQ(picture.at(160, 120 - 61), scene.background);  // just above y = 2
}

TEST(Scene, ProjectFindsThePixelInWhichADotIsDrawn) {
  for (const double fov : {0.0, 1.0}) {
    Camera camera;
    camera.eye = Vec3(3, -8, 4);
    camera.target = Vec3(0, 1, 1);
    camera.fov_rad = fov;
    Scene scene;
    Dots dots;
    dots.p = {Eigen::Vector3f(1.0f, 0.5f, 0.25f)};
    dots.colour = {rgb(0x000000)};
    scene.dots = {dots};
    const Picture picture = take_picture(scene, camera, 200, 160);
    const Vec3 at = *project(camera, 200, 160, Vec3(1, 0.5, 0.25));
    Vec2 sum = Vec2::Zero();
    double weight = 0;
    for (int y = 0; y < 160; ++y)
      for (int x = 0; x < 200; ++x) {
        const double dark = scene.background.r - picture.at(x, y).r;
        sum += dark * Vec2(x + 0.5, y + 0.5);
        weight += dark;
      }
    ASSERT_GT(weight, 0);
    EXPECT_NEAR(sum.x() / weight, at.x(), 0.5);  // a sample is half a pixel
    EXPECT_NEAR(sum.y() / weight, at.y(), 0.5);
  }
}

TEST(Scene, WhatLiesBehindTheEyeHasNoPixel) {
  Camera camera;
  camera.fov_rad = 1;
  camera.up = Vec3::UnitY();
  EXPECT_FALSE(project(camera, 100, 100, Vec3(0, 0, 11)));
  EXPECT_TRUE(project(camera, 100, 100, Vec3(0, 0, 9)));
}

TEST(Scene, ACutAwayShowsTheFloorThroughTheRoof) {
  const Mesh box = box_mesh(Vec3(-1, -1, 0), Vec3(1, 1, 2));
  Skin skin =
      skin_of(box, [](std::uint32_t, Label label) { return label == Label::floor ? rgb(0xff0000) : rgb(0x0000ff); });
  Camera camera;
  camera.up = Vec3::UnitY();
  Scene scene;
  scene.skins = {skin};
  const Colour closed = take_picture(scene, camera, 40, 40).at(20, 20);
  scene.skins[0].sides = Skin::Sides::inner;
  const Colour open = take_picture(scene, camera, 40, 40).at(20, 20);
  EXPECT_GT(closed.b, closed.r);
  EXPECT_GT(open.r, open.b);
}

TEST(Scene, APictureHasTheSameBytesOnAnyNumberOfThreads) {
  const Mesh ball = sphere_mesh(Vec3::Zero(), 2, 4);
  Scene scene;
  scene.skins = {plain(ball, rgb(0xb0a090))};
  scene.skins[0].rock = 1;
  Camera camera;
  camera.fov_rad = 0.8;
  camera.up = Vec3::UnitY();
  std::string first;
  for (const int n : {1, 2, 7}) {
    set_threads(n);
    const std::string bytes = encode_png(take_picture(scene, camera, 240, 180));
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes, first) << n << " threads";
  }
  set_threads(0);
}

TEST(Ramp, ColourAndValueAreEachOthersInverse) {
  for (const Ramp::Kind kind : {Ramp::Kind::diverging, Ramp::Kind::sequential}) {
    const Ramp ramp{kind, -0.2, 0.3, "error", "m"};
    for (double v = -0.2; v <= 0.3; v += 0.0137)
      EXPECT_NEAR(ramp.value(ramp.colour(v)), v, 0.5 * 4 / 256);  // 8-bit colours
    EXPECT_EQ(ramp.colour(-9), ramp.colour(-0.2));
    EXPECT_EQ(ramp.colour(9), ramp.colour(0.3));
  }
}

TEST(Ramp, DivergingEndsAndMiddleAreThoseOfItsSource) {
  const Ramp ramp{Ramp::Kind::diverging, -1, 1, "", ""};
  const auto near = [](Colour a, Colour b) {
    return std::abs(a.r - b.r) <= 3 && std::abs(a.g - b.g) <= 3 && std::abs(a.b - b.b) <= 3;
  };
  EXPECT_TRUE(near(ramp.colour(-1), Colour(59, 76, 192))) << hex_of(ramp.colour(-1));
  EXPECT_TRUE(near(ramp.colour(0), Colour(221, 221, 221))) << hex_of(ramp.colour(0));
  EXPECT_TRUE(near(ramp.colour(1), Colour(180, 4, 38))) << hex_of(ramp.colour(1));
}

TEST(Ramp, ARangeIsRoundAndHoldsTheQuantile) {
  std::vector<double> values;
  for (int k = 0; k <= 1000; ++k) values.push_back((k % 2 ? 1 : -1) * k / 1000.0 * 0.37);
  EXPECT_DOUBLE_EQ(round_range(values, 0.98, 0.01, 10), 0.5);
  EXPECT_DOUBLE_EQ(round_range(values, 0.5, 0.01, 10), 0.2);
  EXPECT_DOUBLE_EQ(round_range({}, 0.5, 0.05, 10), 0.05);
  EXPECT_DOUBLE_EQ(round_down_125(49), 20);
  EXPECT_DOUBLE_EQ(round_down_125(50), 50);
}

TEST(Png, APictureComesBackAsItWas) {
  for (const int alpha : {255, 100}) {
    Picture picture(7, 5, {});
    for (int k = 0; k < 35; ++k) picture.pixel[k] = Colour(k * 7, 255 - k, k * k, k == 3 ? alpha : 255);
    const Picture back = decode_png(encode_png(picture), "test");
    ASSERT_EQ(back.width, 7);
    ASSERT_EQ(back.height, 5);
    EXPECT_EQ(back.pixel, picture.pixel);
  }
}

TEST(Png, ACutOffFileIsAnErrorThatNamesIt) {
  const std::string bytes = encode_png(Picture(30, 30, rgb(0x123456)));
  for (const size_t length : {size_t{0}, size_t{20}, bytes.size() / 2}) {
    try {
      decode_png(bytes.substr(0, length), "half.png");
      FAIL() << length;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("half.png"), std::string::npos);
    }
  }
}

TEST(Type, WordsCoverThePlaceThatTheirWidthSays) {
  Picture picture(300, 60, rgb(0xffffff));
  draw_text(picture, 150, 40, "12.5 m", {.size_px = 24, .colour = rgb(0), .anchor = Anchor::middle});
  int left = 300, right = -1;
  for (int x = 0; x < 300; ++x)
    for (int y = 0; y < 60; ++y)
      if (picture.at(x, y).r < 128) left = std::min(left, x), right = std::max(right, x);
  const double width = text_width("12.5 m", 24);
  EXPECT_NEAR(right - left, width, 6);  // side bearings of the first and last letter
  EXPECT_NEAR((left + right) / 2.0, 150, 3);
}

TEST(Drawing, ARingCoversItsAreaAndAHoleIsLeftOpen) {
  Drawing drawing;
  drawing.width_px = drawing.height_px = 100;
  drawing.background = rgb(0xffffff);
  const auto square = [](double low, double high) {
    return std::vector<Vec2>{{low, low}, {high, low}, {high, high}, {low, high}};
  };
  drawing.add(Area{{square(10.25, 89.75), square(40, 60)}, rgb(0x000000)});
  const Picture picture = to_picture(drawing);
  double dark = 0;
  for (const Colour& c : picture.pixel) dark += (255 - c.r) / 255.0;
  EXPECT_NEAR(dark, 79.5 * 79.5 - 400, 2);  // 8-bit rounding at the rim
  EXPECT_EQ(picture.at(50, 50), rgb(0xffffff));
}

TEST(Drawing, ALineCoversLengthTimesWidth) {
  Drawing drawing;
  drawing.width_px = drawing.height_px = 200;
  drawing.background = rgb(0xffffff);
  drawing.add(Line{{{20, 30}, {170, 140}}, rgb(0x000000), 3});
  double dark = 0;
  for (const Colour& c : to_picture(drawing).pixel) dark += (255 - c.r) / 255.0;
  const double length = std::hypot(150, 110);
  EXPECT_NEAR(dark, 3 * length + std::numbers::pi * 1.5 * 1.5, 0.02 * 3 * length);
}

TEST(Drawing, TextInSvgIsEscaped) {
  Drawing drawing;
  drawing.add(Words{{10, 10}, "<script>alert('x')</script>", {}});
  drawing.add(Disc{.centre = {5, 5}, .link = "#a\"b", .title = "<b>"});
  const std::string svg = to_svg(drawing, "a \"plan\" & <more>");
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_EQ(svg.find("<b>"), std::string::npos);
  EXPECT_NE(svg.find("a &quot;plan&quot; &amp; &lt;more&gt;"), std::string::npos);
}

TEST(Drawing, Base64IsThatOfRfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foob"), "Zm9vYg==");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
}

}  // namespace
}  // namespace adit
