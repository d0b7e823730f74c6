// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trouble.h"

#include "base/error.h"
#include "eval/drawing.h"
#include "eval/outline.h"
#include "eval/plan.h"
#include "eval/scene.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace adit {
namespace {

constexpr int width_px = 1280, height_px = 800, foot_px = 110;
constexpr double reach_m = 9;

// Every quarter metre of what is near, a hand's breadth above the ground that the vehicle drove on.
std::vector<Vec3> way_driven(const Drive& drive, const Vec3& place) {
  std::vector<Vec3> line;
  for (const Pose& X_WB : drive.path.X_WB) {
    const Vec3 p = X_WB.translation() + Vec3(0, 0, 0.1);
    if ((p - place).head<2>().norm() > reach_m) {
      line.clear();  // what is left is the last way in
      continue;
    }
    if (line.empty() || (p - line.back()).norm() > 0.25) line.push_back(p);
  }
  return line;
}

// What of the route lies ahead of where the drive ended, and near.
std::vector<Vec3> way_on(const Drive& drive, const Vec3& place) {
  std::vector<Vec3> line;
  double along = 0;
  for (size_t i = 0; i < drive.route.line.size(); ++i) {
    const Vec2& p = drive.route.line[i];
    if (i > 0) along += (p - drive.route.line[i - 1]).norm();
    if (along < drive.driven_m) continue;
    if ((p - place.head<2>()).norm() > reach_m) break;
    line.push_back({p.x(), p.y(), place.z() + 0.1});
  }
  return line;
}

std::vector<std::string> wrapped(const std::string& text, double type_px, double most_px) {
  std::vector<std::string> lines(1);
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::string longer = lines.back().empty() ? word : lines.back() + " " + word;
    if (text_width(longer, type_px) > most_px && !lines.back().empty())
      lines.push_back(word);
    else
      lines.back() = longer;
  }
  return lines;
}

}  // namespace

Picture trouble_picture(const World& world, const Drive& drive, const Hull& hull) {
  if (drive.path.empty()) throw Error("a drive without a path has no place to show");
  const Pose& X_WB = drive.path.X_WB.back();
  const Vec3 place = X_WB.translation();
  Scene scene;
  if (!world.mesh.face.empty()) {
    scene.skins.push_back(skin_of(
        world.mesh, [](std::uint32_t, Label label) { return label == Label::floor ? rgb(0xa89c8c) : rgb(0x7d7a78); },
        [&](size_t f) {
          return !is_roof(label_of(world.mesh, f)) && (world.mesh.corner(f, 0) - place).head<2>().norm() < reach_m;
        }));
    scene.skins.back().sides = Skin::Sides::inner;
    scene.skins.back().rock = 0.6f;
  }
  Skin vehicle;
  for (const Box& box : hull)
    add_box(vehicle, box.min_B, box.max_B, X_WB, box.label == Label::pusher ? rgb(0xd55e00) : rgb(0xe6b800));
  scene.skins.push_back(vehicle);
  const std::vector<Vec3> driven = way_driven(drive, place), on = way_on(drive, place);
  if (driven.size() > 1) scene.skins.push_back(tube(driven, 0.04, ink::map));
  if (on.size() > 1) scene.skins.push_back(tube(on, 0.04, ink::white));
  // From behind and to the right of the vehicle, high up.
  const Vec3 back = X_WB.linear() * Vec3(-1, -0.7, 0);
  Camera camera;
  camera.target = place + Vec3(0, 0, 0.5);
  camera.eye = camera.target + 30 * Vec3(back.x(), back.y(), 1.3 * Vec2(back.x(), back.y()).norm()).normalized();
  camera.height_m = 9;
  camera.near_m = 1;
  camera.far_m = 80;
  Drawing drawing;
  drawing.width_px = width_px;
  drawing.height_px = height_px + foot_px;
  drawing.add(Layer{take_picture(scene, camera, width_px, height_px),
                    {0, 0},
                    {static_cast<double>(width_px), static_cast<double>(height_px)}});
  const double type_px = 20;
  double y = height_px + 28;
  for (const std::string& line : wrapped(drive.cause, type_px, width_px - 48)) {
    drawing.add(Words{{24, y}, line, {.size_px = type_px, .colour = ink::text, .bold = false}});
    y += 26;
  }
  const double x = 24 + add_key(drawing, {24, y + 4}, ink::map, "driven", 17) + 24;
  add_key(drawing, {x, y + 4}, rgb(0xa0a0a0), "route (white in the picture)", 17);
  add_scale_bar(drawing, {width_px - 260.0, y + 4}, height_px / camera.height_m, 200, 16);
  return to_picture(drawing);
}

}  // namespace adit
