// SPDX-License-Identifier: BSD-3-Clause
#include "eval/lamp.h"

#include "eval/outline.h"

#include <array>
#include <cmath>

namespace adit {

namespace {
constexpr double lit_m = 80;  // beyond it the lamp shows nothing
constexpr double face_m = 2;  // no face is larger, by far
}  // namespace

Camera camera_of(const Lookout& from) {
  Camera camera;
  camera.eye = from.eye;
  camera.target = from.eye + from.ahead - Vec3(0, 0, 0.06);
  camera.fov_rad = 1.15;
  camera.near_m = 0.08;
  camera.far_m = 150;
  return camera;
}

std::function<bool(const Vec3&)> lit_from(const Camera& camera, double aspect) {
  const Vec3 forward = (camera.target - camera.eye).normalized();
  const Vec3 right = forward.cross(camera.up).normalized(), above = right.cross(forward), eye = camera.eye;
  const double high = std::tan(camera.fov_rad / 2), wide = aspect * high;
  // A place is beside the picture by its distance from the plane through the eye and the picture's edge.
  const double beside = face_m * std::hypot(1.0, wide), over = face_m * std::hypot(1.0, high);
  return [=](const Vec3& p) {
    const Vec3 d = p - eye;
    const double depth = forward.dot(d);
    return depth > -face_m && std::abs(right.dot(d)) < wide * depth + beside &&
           std::abs(above.dot(d)) < high * depth + over && d.squaredNorm() < lit_m * lit_m;
  };
}

std::vector<Skin> mine_skins(const Mesh& mesh, const std::function<Colour(std::uint32_t, Label)>& colour_of,
                             const std::function<bool(size_t)>& keep) {
  enum Stuff { rock, things, water };
  const auto stuff_of = [](Label label) {
    return label == Label::water ? water : label == Label::sludge || is_object(label) ? things : rock;
  };
  std::vector<Skin> skins;
  std::array<bool, 3> there = {};
  for (size_t f = 0; f < mesh.face.size(); ++f) there[stuff_of(label_of(mesh, f))] = true;
  for (const Stuff stuff : {rock, things, water}) {
    if (!there[stuff]) continue;
    skins.push_back(
        skin_of(mesh, colour_of, [&](size_t f) { return stuff_of(label_of(mesh, f)) == stuff && keep(f); }));
    skins.back().rock = stuff == rock ? 1.0f : stuff == things ? 0.25f : 0.0f;
    skins.back().gloss = stuff == water ? 1.0f : 0.0f;
  }
  return skins;
}

Picture take_lamp_picture(Scene scene, const Camera& camera, int width, int height) {
  scene.light = Light::headlamp;
  scene.background = rgb(0x0d0d0e);
  return take_picture(scene, camera, width, height);
}

}  // namespace adit
