// SPDX-License-Identifier: BSD-3-Clause
// Pictures in space.
#include "base/parallel.h"
#include "eval/exhibit.h"
#include "eval/outline.h"
#include "eval/scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace adit {

namespace {

// The faces of the mapped surface near a place (all without one), coloured by error; heights stretched about z0_m.
Skin error_skin(const Exhibit& x, double stretch = 1, double z0_m = 0,
                const std::function<bool(const Vec3&)>& near = {}) {
  Skin skin = skin_of(
      x.surface_W, [&](std::uint32_t v, Label) { return x.ramp.colour(x.surface_error_m[v]); },
      [&](size_t f) { return !near || near(x.surface_W.corner(f, 0)); });
  for (auto& p : skin.p) p.z() = static_cast<float>(z0_m + stretch * (p.z() - z0_m));
  for (auto& n : skin.normal) n = Eigen::Vector3f(n.x(), n.y(), n.z() / static_cast<float>(stretch)).normalized();
  return skin;
}

// Map points coloured by error; those on the roof are left out where the roof is to be lifted off.
Dots error_dots(const Exhibit& x, bool with_roof, double stretch = 1, double z0_m = 0,
                const std::function<bool(const Vec3&)>& near = {}) {
  Dots dots;
  for (size_t k = 0; k < x.point_W.size(); ++k) {
    if (!with_roof && x.point_label[k] == Label::roof) continue;
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
  const Framing framing = frame_box(low, high, -1.75, 0.95, x.settings.width_px, {70, 60});
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
  add_scale_bar(figure.drawing, {24, figure.drawing.height_px - 22}, framing.px_per_m, 260, 18, height_note(stretch));
  figure.caption = std::string("The mapped ") + (x.has_surface() ? "surface" : "points") +
                   " seen from the south, without the roof and without the walls that would hide the inside. Grey lies "
                   "where the rock is; "
                   "red stands out into the true void, blue lies inside the true rock. Numbers mark the worst places.";
  figure.alt = "Oblique view of the mapped mine without its roof, coloured by signed error, worst places numbered";
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
  add_scale_bar(figure.drawing, {24, figure.drawing.height_px - 22}, framing.px_per_m, 260, 18);
  figure.caption = "The map within " + plain_number(radius) +
                   " m of the worst place, at true proportions. The blue line is the mapped path.";
  figure.alt = "Oblique close view of the mapped surface around the worst place, coloured by signed error";
  return figure;
}

namespace {

// A place on the path from which the way ahead is long: near the share (k + 1/2) / n of the way driven.
struct Lookout {
  Vec3 eye, ahead;
  double along_m;
};
std::optional<Lookout> lookout(const Exhibit& x, int k) {
  const Trajectory& path = x.input.truth.drive.path.empty() ? x.path_W : x.input.truth.drive.path;
  if (path.size() < 2) return {};
  const std::vector<double> along = distance_along(path);
  const double total = along.back(), wanted = total * (k + 0.5) / std::max(1, x.settings.interiors);
  std::optional<Lookout> best;
  double best_view = -1;
  for (double d = -0.06 * total; d <= 0.06 * total; d += std::max(0.5, 0.004 * total)) {
    const double at = std::clamp(wanted + d, 0.0, total);
    const auto i = std::min<size_t>(
        path.size() - 1, static_cast<size_t>(std::lower_bound(along.begin(), along.end(), at) - along.begin()));
    const auto j = std::min<size_t>(
        path.size() - 1, static_cast<size_t>(std::lower_bound(along.begin(), along.end(), at + 4) - along.begin()));
    const Vec3 eye = path.X_WB[i].translation() + Vec3(0, 0, 1.35);
    Vec3 way = path.X_WB[i].rotation() * Vec3::UnitX();
    if (j > i && (path.X_WB[j].translation() - path.X_WB[i].translation()).norm() > 1)
      way = path.X_WB[j].translation() - path.X_WB[i].translation();
    way.normalize();
    const double view = x.caster ? std::min(25.0, x.caster->nearest(Ray{eye, way, 100}).range_m) : 1;
    if (view > best_view + 1e-9) best_view = view, best = Lookout{eye, way, along[i]};
  }
  return best;
}

Picture see(Scene scene, const Camera& camera, int width, int height) {
  scene.light = Light::headlamp;
  scene.background = rgb(0x0d0d0e);
  return take_picture(scene, camera, width, height);
}

void add_plate(Drawing& drawing, double left, const std::string& words) {
  const double w = text_width(words, 20, true) + 24;
  drawing.add(Area{{{{left, 0}, {left + w, 0}, {left + w, 36}, {left, 36}}}, {0, 0, 0, 170}});
  drawing.add(Words{{left + 12, 25}, words, {.size_px = 20, .colour = ink::white, .bold = true}});
}

// A staff of one metre that stands on the floor ahead, so that sizes can be read in perspective.
void add_staff(Skin& skin, const Exhibit& x, const Lookout& from) {
  if (!x.caster) return;
  const Vec3 level = Vec3(from.ahead.x(), from.ahead.y(), 0).normalized(), side(level.y(), -level.x(), 0);
  const Vec3 top = from.eye + 4.5 * level + 0.9 * side;
  const Hit hit = x.caster->nearest(Ray{top, -Vec3::UnitZ(), 5});
  if (hit.face < 0) return;
  const Vec3 foot = top - Vec3(0, 0, hit.range_m);
  for (int k = 0; k < 5; ++k) {
    const Skin piece = tube({foot + Vec3(0, 0, 0.2 * k), foot + Vec3(0, 0, 0.2 * (k + 1))}, 0.025,
                            k % 2 ? rgb(0xf0f0f0) : rgb(0xe69f00));
    append(skin, piece);
  }
}

}  // namespace

Figure interior_view(const Exhibit& x, int k) {
  const std::string number = std::to_string(k + 1);
  Figure figure{.name = "interior-" + number, .title = "From the path, " + number};
  const auto from = lookout(x, k);
  if (!from || (!x.has_surface() && !x.has_points())) {
    figure.missing = !from ? "there is no path to look from" : "the map has neither a surface nor points";
    return figure;
  }
  const int width = x.settings.width_px / 2 - 4, height = width * 5 / 8;
  Camera camera;
  camera.eye = from->eye;
  camera.target = from->eye + from->ahead - Vec3(0, 0, 0.06);
  camera.fov_rad = 1.15;
  camera.near_m = 0.08;
  camera.far_m = 150;
  // Beyond it the lamp shows nothing.
  const auto near = [&](const Vec3& p) { return (p - from->eye).norm() < 80; };
  Scene truth, map;
  Skin staff;
  add_staff(staff, x, *from);
  if (x.has_world()) {
    const Mesh& mesh = x.input.world.mesh;
    truth.skins.push_back(skin_of(
        mesh, [](std::uint32_t, Label label) { return rock_colour(label); },
        [&](size_t f) { return near(mesh.corner(f, 0)); }));
    truth.skins.back().rock = 1;
    truth.skins.push_back(staff);
  }
  if (x.has_surface())
    map.skins.push_back(error_skin(x, 1, 0, near));
  else
    map.dots.push_back(error_dots(x, true, 1, 0, near));
  map.skins.push_back(staff);
  Drawing drawing;
  drawing.width_px = 2 * width + 8;
  drawing.height_px = height;
  const double right = width + 8.0;
  drawing.add(
      Layer{see(truth, camera, width, height), {0, 0}, {static_cast<double>(width), static_cast<double>(height)}});
  drawing.add(Layer{see(map, camera, width, height), {right, 0}, {right + width, static_cast<double>(height)}});
  add_plate(drawing, 0, "the mine");
  add_plate(drawing, right, std::string("the map") + (x.has_surface() ? "" : " (points)") + ", coloured by error");
  const double bar = 250, corner = drawing.width_px - bar - 40, top = drawing.height_px - 64;
  drawing.add(Area{
      {{{corner, top}, {drawing.width_px, top}, {drawing.width_px, drawing.height_px}, {corner, drawing.height_px}}},
      {243, 243, 240, 225}});
  add_colour_bar(drawing, x.ramp, {corner + 22, top}, bar, 14);
  figure.drawing = drawing;
  figure.caption = plain_number(from->along_m, 4) +
                   " m along the path: the true mine on the left, the map from the same place on the right. "
                   "The striped staff is 1 m high.";
  figure.alt = "View along a passage from the path, the true mine beside the map coloured by signed error";
  return figure;
}

}  // namespace adit
