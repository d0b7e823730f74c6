// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"
#include "eval/picture.h"

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace adit {

/// Coloured triangles, normals by vertex; counter-clockwise = the side that the normal looks to.
struct Skin {
  enum class Sides { both, inner };        // inner: only faces whose normal looks away from the eye (cut-away)
  std::vector<Eigen::Vector3f> p, normal;  // (n x 3) W
  std::vector<Colour> colour;              // (n)
  std::vector<std::array<std::uint32_t, 3>> face;
  Sides sides = Sides::both;
  float rock = 0;   // 0..1: strength of the painted-on texture of rock
  float gloss = 0;  // 0..1: of a surface of water
};

/// Round dots of a size in metres, at least `least_px` wide.
struct Dots {
  std::vector<Eigen::Vector3f> p;
  std::vector<Colour> colour;
  float size_m = 0.03f, least_px = 1.5f;
};

enum class Light { studio, headlamp };  // from sky and eye; from the eye alone and fading with distance

struct Scene {
  std::vector<Skin> skins;
  std::vector<Dots> dots;
  Light light = Light::studio;
  double lamp_m = 8;  // headlamp: distance at which it is half as bright
  Colour background = rgb(0xf3f3f0);
};

/// Where a picture is taken from, in W. fov_rad is the angle of the picture's height; 0 = orthographic, height_m high.
struct Camera {
  Vec3 eye = Vec3(0, 0, 10), target = Vec3::Zero(), up = Vec3::UnitZ();
  double fov_rad = 0;
  double height_m = 10;
  double near_m = 0.1, far_m = 1000;
};

/// Pixel (x right, y down, from the upper left corner) and depth along the view axis in metres; none behind the eye.
std::optional<Vec3> project(const Camera& camera, int width, int height, const Vec3& p_W);

/// The faces of a mesh that `keep` accepts (all by default), smooth within a label and creased between labels.
/// @param colour_of  colour of a vertex (index, label of the face)
Skin skin_of(const Mesh& mesh, const std::function<Colour(std::uint32_t, Label)>& colour_of,
             const std::function<bool(size_t)>& keep = {});
/// How a thing in a mine is painted, or what lies on its floor.
Colour thing_colour(Label label);
/// A tube of eight sides around a line.
Skin tube(const std::vector<Vec3>& line, double radius_m, Colour colour);
/// Adds the triangles of `more`.
void append(Skin& skin, const Skin& more);
/// Adds a ball.
void add_ball(Skin& skin, const Vec3& centre, double radius_m, Colour colour);
/// Adds the box [low, high] of a frame that stands at X_WB, with sharp edges.
void add_box(Skin& skin, const Vec3& low, const Vec3& high, const Pose& X_WB, Colour colour);

/// Takes the picture, anti-aliased (2 x 2 samples a pixel) and with crevices darkened. The same bytes on any number of
/// threads.
Picture take_picture(const Scene& scene, const Camera& camera, int width, int height);

}  // namespace adit
