// SPDX-License-Identifier: BSD-3-Clause
// Pictures in space.
#include "base/parallel.h"
#include "eval/exhibit.h"
#include "eval/outline.h"
#include "eval/views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace adit {

Skin error_skin(const Exhibit& x, double stretch, double z0_m, const Near& near) {
  Skin skin = skin_of(
      x.surface_W, [&](std::uint32_t v, Label) { return x.ramp.colour(x.surface_error_m[v]); },
      [&](size_t f) { return !near || near(x.surface_W.corner(f, 0)); });
  for (auto& p : skin.p) p.z() = static_cast<float>(z0_m + stretch * (p.z() - z0_m));
  for (auto& n : skin.normal) n = Eigen::Vector3f(n.x(), n.y(), n.z() / static_cast<float>(stretch)).normalized();
  return skin;
}

Dots error_dots(const Exhibit& x, bool with_roof, double stretch, double z0_m, const Near& near) {
  Dots dots;
  for (size_t k = 0; k < x.point_W.size(); ++k) {
    if (!with_roof && is_roof(x.point_label[k])) continue;
    const Vec3& p = x.point_W[k];
    if (!p.allFinite() || (near && !near(p))) continue;
    dots.p.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()),
                        static_cast<float>(z0_m + stretch * (p.z() - z0_m)));
    dots.colour.push_back(x.ramp.colour(x.point_error_m[k]));
  }
  return dots;
}

Colour rock_colour(Label label) {
  switch (label) {
    case Label::floor:
      return rgb(0x8d8173);
    case Label::roof:
      return rgb(0x9a9a99);
    case Label::rib:
      return rgb(0x6f6c6b);
    default:
      return label >= Label::rubble ? thing_colour(label) : rgb(0x8a8a88);
  }
}

Camera camera_at(const Viewpoint& viewpoint) {
  Camera camera;
  camera.eye = viewpoint.eye;
  camera.target = viewpoint.target;
  camera.fov_rad = viewpoint.fov_rad;
  const double reach = (viewpoint.target - viewpoint.eye).norm();
  camera.near_m = std::max(0.05, 0.005 * reach);
  camera.far_m = 500 + 10 * reach;
  // Straight down or up: north is above.
  if (std::abs((viewpoint.target - viewpoint.eye).normalized().z()) > 0.999) camera.up = Vec3::UnitY();
  return camera;
}

namespace {

// An orthographic camera that looks down at an angle from the south and holds a box, and the picture's height for a
// width.
struct Framing {
  Camera camera;
  int height_px;
  double px_per_m;
};
Framing frame_box(const Vec3& low, const Vec3& high, double azimuth_rad, double elevation_rad, int width_px,
                  const std::array<double, 2>& room_px) {
  const Vec3 back(std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
                  std::sin(elevation_rad));
  const Vec3 right = Vec3(-back).cross(Vec3::UnitZ()).normalized(), above = right.cross(-back);
  Vec3 least = Vec3::Constant(1e30), most = Vec3::Constant(-1e30);
  for (int k = 0; k < 8; ++k) {
    const Vec3 p(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(), k & 4 ? high.z() : low.z());
    const Vec3 q(right.dot(p), above.dot(p), back.dot(p));
    least = least.cwiseMin(q);
    most = most.cwiseMax(q);
  }
  Framing framing;
  const double side_px = 24;
  framing.px_per_m = (width_px - 2 * side_px) / (most.x() - least.x());
  const double inner_px = framing.px_per_m * (most.y() - least.y());
  framing.height_px = 2 * static_cast<int>(std::ceil((inner_px + room_px[0] + room_px[1]) / 2));
  const double shift_m = (room_px[0] - room_px[1]) / 2 / framing.px_per_m;  // the room above is greater: look higher
  const Vec3 middle =
      right * (least.x() + most.x()) / 2 + above * ((least.y() + most.y()) / 2 + shift_m) + back * most.z();
  framing.camera.target = middle;
  framing.camera.eye = middle + 20 * back;
  framing.camera.height_m = framing.height_px / framing.px_per_m;
  framing.camera.near_m = 1;
  framing.camera.far_m = 60 + most.z() - least.z();
  return framing;
}

// The viewpoint that was asked for instead of the view's own.
void use_viewpoint(Framing& framing, const Exhibit& x) {
  if (!x.viewpoint) return;
  framing.camera = camera_at(*x.viewpoint);
  framing.height_px = 2 * (x.settings.width_px * 9 / 32);
  framing.px_per_m = 0;
}

Drawing sheet_of(const Picture& picture) {
  Drawing drawing;
  drawing.width_px = picture.width;
  drawing.height_px = picture.height;
  drawing.add(Layer{picture, {0, 0}, {static_cast<double>(picture.width), static_cast<double>(picture.height)}});
  return drawing;
}

void add_compass(Drawing& drawing, const Camera& camera, const Vec2& at_px, double length_px) {
  const int w = static_cast<int>(drawing.width_px), h = static_cast<int>(drawing.height_px);
  const auto a = project(camera, w, h, camera.target), b = project(camera, w, h, camera.target + Vec3::UnitY());
  if (!a || !b) return;
  const Vec2 way = (b->head<2>() - a->head<2>()).normalized(), tip = at_px + length_px * way, side(-way.y(), way.x());
  drawing.add(Line{{at_px, tip}, ink::text, 3});
  drawing.add(Area{{{tip + 8 * way, tip - 4 * way + 7 * side, tip - 4 * way - 7 * side}}, ink::text});
  drawing.add(Words{tip + 24 * way + Vec2(0, 7),
                    "N",
                    {.size_px = 20, .colour = ink::text, .anchor = Anchor::middle, .bold = true, .halo_px = 2}});
}

void add_spot_flags(Drawing& drawing, std::span<const Spot> spots, const Camera& camera, double stretch, double z0_m) {
  for (size_t k = spots.size(); k-- > 0;) {
    Vec3 p = spots[k].p_W;
    p.z() = z0_m + stretch * (p.z() - z0_m);
    const auto at = project(camera, static_cast<int>(drawing.width_px), static_cast<int>(drawing.height_px), p);
    if (!at) continue;
    const Vec2 foot = at->head<2>(), head = foot - Vec2(0, 46);
    drawing.add(Line{{foot, head}, ink::white, 5});
    drawing.add(Line{{foot, head}, ink::mark, 2});
    drawing.add(Disc{.centre = foot, .radius_px = 4, .fill = ink::mark, .rim = ink::white, .rim_px = 1.5});
    drawing.add(Disc{.centre = head,
                     .radius_px = 14,
                     .fill = ink::mark,
                     .rim = ink::white,
                     .rim_px = 2,
                     .link = "#spot-" + std::to_string(k + 1),
                     .title = "worst place " + std::to_string(k + 1) + ": " + spots[k].words});
    drawing.add(Words{head + Vec2(0, 6),
                      std::to_string(k + 1),
                      {.size_px = 17, .colour = ink::white, .anchor = Anchor::middle, .bold = true}});
  }
}

std::pair<double, double> heights(const Exhibit& x) {
  double low = 1e30, high = -1e30;
  const auto take = [&](const Vec3& p) {
    if (std::isfinite(p.z())) low = std::min(low, p.z()), high = std::max(high, p.z());
  };
  if (x.has_world())
    for (const Vec3& p : x.input.world.mesh.vertex) take(p);
  else
    for (const Vec3& p : x.point_W) take(p);
  return {low, high};
}

std::string height_note(double stretch) {
  return stretch == 1 ? "" : "  (heights × " + plain_number(stretch) + ")";
}

}  // namespace

Figure cutaway_view(const Exhibit& x) {
  Figure figure{.name = "cutaway", .title = "The map in space, roof lifted off"};
  if (!x.has_surface() && !x.has_points()) {
    figure.missing = "the map has neither a surface nor points";
    return figure;
  }
  const double stretch = x.settings.exaggeration;
  const auto [z_low, z_high] = heights(x);
  const Vec3 low(x.low_W.x(), x.low_W.y(), z_low), high(x.high_W.x(), x.high_W.y(), z_low + stretch * (z_high - z_low));
  Framing framing = frame_box(low, high, -1.75, 0.95, x.settings.width_px, {70, 60});
  use_viewpoint(framing, x);
  Scene scene;
  if (x.has_surface()) {
    scene.skins.push_back(error_skin(x, stretch, z_low));
    scene.skins.back().sides = Skin::Sides::inner;
  } else {
    scene.dots.push_back(error_dots(x, false, stretch, z_low));
    scene.dots.back().least_px = 1;
  }
  figure.drawing = sheet_of(take_picture(scene, framing.camera, x.settings.width_px, framing.height_px));
  add_spot_flags(figure.drawing, x.spots, framing.camera, stretch, z_low);
  add_colour_bar(figure.drawing, x.ramp, {36, 10}, 320, 18);
  add_compass(figure.drawing, framing.camera, {figure.drawing.width_px - 60, 90}, 34);
  if (!x.viewpoint)
    add_scale_bar(figure.drawing, {24, figure.drawing.height_px - 22}, framing.px_per_m, 260, 18, height_note(stretch));
  figure.caption = std::string("The mapped ") + (x.has_surface() ? "surface" : "points") +
                   " seen from the south, without the roof and without the walls that would hide the inside. Grey lies "
                   "where the rock is; "
                   "red stands out into the true void, blue lies inside the true rock. Numbers mark the worst places.";
  figure.alt = "Oblique view of the mapped mine without its roof, coloured by signed error, worst places numbered";
  return figure;
}

Figure coverage_view(const Exhibit& x) {
  Figure figure{.name = "coverage", .title = "What the rig could see"};
  const Mesh& mesh = x.input.world.mesh;
  const auto& hits = x.input.score.face_hits;
  if (!x.has_world() || hits.size() != mesh.face.size()) {
    figure.missing = "it is not known which of the true rock the beams met";
    return figure;
  }
  const Ramp ramp{Ramp::Kind::sequential, 0, 8, "beams that met the rock", "powers of 2"};
  const Colour unseen = rgb(0x3b6fb6);
  // Each face of one colour: corners are not shared.
  const auto skin_of_faces = [&](bool roof) {
    Skin skin;
    for (size_t f = 0; f < mesh.face.size(); ++f) {
      if (is_roof(label_of(mesh, f)) != roof) continue;
      const Colour c = hits[f] == 0 ? unseen : ramp.colour(std::log2(1.0 + hits[f]));
      const Eigen::Vector3f n = mesh.normal(f).cast<float>();
      const auto first = static_cast<std::uint32_t>(skin.p.size());
      for (int k = 0; k < 3; ++k) {
        skin.p.push_back(mesh.corner(f, k).cast<float>());
        skin.normal.push_back(n);
        skin.colour.push_back(c);
      }
      skin.face.push_back({first, first + 1, first + 2});
    }
    return skin;
  };
  double seen = 0, all = 0;
  for (size_t f = 0; f < mesh.face.size(); ++f) {
    const double area = mesh.area(f);
    all += area;
    if (hits[f]) seen += area;
  }
  const auto [z_low, z_high] = heights(x);
  const Vec3 low(x.low_W.x(), x.low_W.y(), z_low), high(x.high_W.x(), x.high_W.y(), z_high);
  const Framing framing = frame_box(low, high, -1.75, 1.2, x.settings.width_px, {70, 20});
  Drawing drawing;
  drawing.width_px = x.settings.width_px;
  drawing.height_px = 2 * framing.height_px;
  for (const bool roof : {false, true}) {
    Scene scene;
    scene.skins.push_back(skin_of_faces(roof));
    if (!roof) scene.skins.back().sides = Skin::Sides::inner;
    const double top = roof ? framing.height_px : 0;
    drawing.add(Layer{take_picture(scene, framing.camera, x.settings.width_px, framing.height_px),
                      {0, top},
                      {drawing.width_px, top + framing.height_px}});
    drawing.add(Words{{drawing.width_px - 30, top + 34},
                      roof ? "roof, seen through the rock above it" : "floor and ribs, roof lifted off",
                      {.size_px = 18, .colour = ink::text, .anchor = Anchor::end, .halo_px = 2}});
  }
  add_colour_bar(drawing, ramp, {36, 10}, 320, 18);
  add_key(drawing, {400, 34}, unseen, "met by no beam", 18);
  add_compass(drawing, framing.camera, {drawing.width_px - 60, framing.height_px - 16.0}, 34);
  add_scale_bar(drawing, {24, framing.height_px - 12}, framing.px_per_m, 260, 18);
  figure.drawing = std::move(drawing);
  figure.caption =
      "The true rock by how many beams, free of noise, met it at a usable angle (each step of the bar doubles them): " +
      plain_number(100 * seen / all) + " % of " + plain_number(all, 4) +
      " m² were met. What no beam met, no mapper can know.";
  figure.alt =
      "Two oblique views of the true mine, floor with ribs and roof, coloured by the number of beams that met them";
  return figure;
}

Figure chamber_view(const Exhibit& x) {
  Figure figure{.name = "chamber", .title = "Around the worst place, roof lifted off"};
  if ((!x.has_surface() && !x.has_points()) || x.spots.empty()) {
    figure.missing = "there is no mapped surface with a worst place to show";
    return figure;
  }
  const double radius = 22;
  const Vec3 middle = x.spots[0].p_W;
  const auto near = [&](const Vec3& p) { return (p - middle).head<2>().norm() < radius; };
  Vec3 low = middle - Vec3::Constant(2), high = middle + Vec3::Constant(2);
  for (const Vec3& p : x.has_surface() ? x.surface_W.vertex : x.point_W) {
    if (!p.allFinite() || !near(p)) continue;
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  Framing framing = frame_box(low, high, -1.9, 0.75, x.settings.width_px, {70, 50});
  framing.camera.eye += 2 * radius * (framing.camera.eye - framing.camera.target).normalized();
  framing.camera.far_m += 6 * radius;
  use_viewpoint(framing, x);
  Scene scene;
  if (x.has_surface()) {
    scene.skins.push_back(error_skin(x, 1, 0, near));
    scene.skins.back().sides = Skin::Sides::inner;
  } else {
    scene.dots.push_back(error_dots(x, false, 1, 0, near));
  }
  std::vector<Vec3> walked;
  Skin path;
  const auto flush = [&] {
    append(path, tube(walked, 0.05, ink::map));
    walked.clear();
  };
  for (const Pose& X : x.path_W.X_WB) {
    const Vec3 p = X.translation() + Vec3(0, 0, 0.15);
    if (!near(p))
      flush();
    else if (walked.empty() || (p - walked.back()).norm() > 0.2)
      walked.push_back(p);
  }
  flush();
  scene.skins.push_back(path);
  figure.drawing = sheet_of(take_picture(scene, framing.camera, x.settings.width_px, framing.height_px));
  add_spot_flags(figure.drawing, std::span(x.spots).first(1), framing.camera, 1, 0);
  add_colour_bar(figure.drawing, x.ramp, {36, 10}, 320, 18);
  add_compass(figure.drawing, framing.camera, {figure.drawing.width_px - 60, 90}, 34);
  if (!x.viewpoint) add_scale_bar(figure.drawing, {24, figure.drawing.height_px - 22}, framing.px_per_m, 260, 18);
  figure.caption = "The map within " + plain_number(radius) +
                   " m of the worst place, at true proportions. The blue line is the mapped path.";
  figure.alt = "Oblique close view of the mapped surface around the worst place, coloured by signed error";
  return figure;
}

}  // namespace adit
