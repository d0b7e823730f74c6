// SPDX-License-Identifier: BSD-3-Clause
#include "eval/rig_picture.h"

#include "eval/drawing.h"
#include "eval/scene.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace adit {
namespace {

constexpr int width_px = 1600, height_px = 1000;
constexpr double legend_px = 800;

// Apart for the colour-blind too: Okabe and Ito's palette.
Colour laser_colour(size_t i) {
  constexpr std::array<std::uint32_t, 6> palette{0xd55e00, 0x0072b2, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9};
  return rgb(palette[i % palette.size()]);
}

Scene scene_of(const RigExhibit& x) {
  Scene scene;
  Skin rock = skin_of(x.passage,
                      [](std::uint32_t, Label label) { return label == Label::floor ? rgb(0xb9b0a4) : rgb(0xc9c9c7); });
  rock.sides = Skin::Sides::inner;
  scene.skins.push_back(rock);
  Skin vehicle;
  for (const Box& box : x.hull)
    add_box(vehicle, box.min_B, box.max_B, x.X_WB, box.label == Label::pusher ? rgb(0x8a6f9e) : rgb(0x4f5b66));
  scene.skins.push_back(vehicle);
  Skin beams;
  for (size_t i = 0; i < x.rig.mounts.size(); ++i) {
    const Vec3 mirror = x.X_WB * x.rig.mounts[i].X_BS.translation();
    add_ball(beams, mirror, 0.06, laser_colour(i));
    Dots seen{.p = {}, .colour = {}, .size_m = 0.03F, .least_px = 3};
    for (size_t k = 0; k < x.ends_W[i].size(); ++k) {
      const Vec3& end = x.ends_W[i][k];
      if (!end.allFinite()) continue;
      seen.p.push_back(end.cast<float>());
      seen.colour.push_back(laser_colour(i));
      if (k % 12 == 0) append(beams, tube({mirror, end}, 0.004, laser_colour(i)));
    }
    scene.dots.push_back(seen);
  }
  scene.skins.push_back(beams);
  return scene;
}

Camera camera_of(const RigExhibit& x, RigView view) {
  Camera camera;
  const Vec3 middle = x.X_WB * Vec3(0.4, 0, 0.95);
  const auto from = [&](const Vec3& back_B, double height_m) {
    camera.target = middle;
    camera.eye = middle + 30 * (x.X_WB.linear() * back_B.normalized());
    camera.height_m = height_m;
    camera.near_m = 1;
    camera.far_m = 80;
  };
  if (view == RigView::corner) from({1.0, -1.3, 0.9}, 6.2);
  if (view == RigView::side) from({0, -1, 0}, 4.6);
  if (view == RigView::front) from({1, 0, 0}, 3.2);
  if (view == RigView::above) {
    from({0, 0, 1}, 6.2);
    camera.up = x.X_WB.linear() * Vec3::UnitY();
  }
  return camera;
}

std::string words_of(const Mount& mount) {
  const Vec3& p = mount.X_BS.translation();
  char text[200];
  std::snprintf(text, sizeof text, "%s: %s, %d beams over %.0f\u00b0, at (%.2f, %.2f, %.2f) m", mount.name.c_str(),
                mount.laser.name.c_str(), mount.laser.beams, mount.laser.fov_rad * 180 / std::numbers::pi, p.x(), p.y(),
                p.z());
  return text;
}

}  // namespace

Picture rig_picture(const RigExhibit& x, RigView view) {
  const double low = 70 + 34 * static_cast<double>(x.rig.mounts.size());  // of the words' ground
  Camera camera = camera_of(x, view);
  const Vec3 lift = low / 2 / height_px * camera.height_m * camera.up;  // the passage stands below the words
  camera.target += lift, camera.eye += lift;
  const Picture scene = take_picture(scene_of(x), camera, width_px, height_px);
  Drawing drawing;
  drawing.width_px = width_px;
  drawing.height_px = height_px;
  drawing.add(Layer{scene, {0, 0}, {width_px, height_px}});
  double y = 56;
  const Colour ink = rgb(0x222222);
  // A ground of its own: the words would lie on the passage's walls.
  const double right = 20 + legend_px;
  drawing.add(Area{{{{20, 16}, {right, 16}, {right, low}, {20, low}}}, {255, 255, 255, 225}});
  drawing.add(Words{{40, y}, "rig " + x.rig.name, {.size_px = 30, .colour = ink, .bold = true, .halo_px = 2}});
  for (size_t i = 0; i < x.rig.mounts.size(); ++i) {
    y += 34;
    drawing.add(Disc{.centre = {50, y - 7}, .radius_px = 9, .fill = laser_colour(i)});
    drawing.add(Words{{70, y}, words_of(x.rig.mounts[i]), {.size_px = 21, .colour = ink, .halo_px = 2}});
  }
  return to_picture(drawing);
}

}  // namespace adit
