// SPDX-License-Identifier: BSD-3-Clause
#include "eval/mine_views.h"

#include "eval/outline.h"
#include "eval/plan.h"
#include "eval/scene.h"
#include "rays/caster.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace adit {
namespace {

constexpr double best_sight_m = 30;  // beyond it more sight makes no better picture
constexpr double lit_m = 80;

struct Place {
  Vec3 eye, ahead;
  double sight_m;
};

// Rock under its dust and water, a little of each label's own tint: grey where dusted, near black where bare and wet.
Colour colour_of(const Mesh& mesh, const std::vector<float>& bright, std::uint32_t v, Label label) {
  const Colour warm = label == Label::floor ? rgb(0xb7a894) : label == Label::roof ? rgb(0xc2c2c4) : rgb(0xbab5b0);
  if (label == Label::cap) return rgb(0x9a6a4a);
  if (label >= Label::rubble) return thing_colour(label);
  if (mesh.reflectivity.empty()) return mix(rgb(0x000000), warm, 0.65);
  return mix(rgb(0x101012), warm, std::clamp(0.25 + 1.1 * bright[v], 0.0, 1.0));
}

// Reflectivity of each vertex: the mean of its faces.
std::vector<float> brightness(const Mesh& mesh) {
  std::vector<float> sum(mesh.vertex.size(), 0.0f), count(mesh.vertex.size(), 0.0f);
  for (size_t f = 0; f < mesh.reflectivity.size(); ++f) {
    for (std::uint32_t v : mesh.face[f]) {
      sum[v] += mesh.reflectivity[f];
      count[v] += 1;
    }
  }
  for (size_t v = 0; v < sum.size(); ++v) sum[v] /= std::max(1.0f, count[v]);
  return sum;
}

std::vector<Place> places_of(const World& world) {
  const Caster caster(world.mesh);
  std::vector<Place> places;
  for (const Passage& p : world.passages) {
    const auto& line = p.centre_line;
    for (size_t i = 0; i + 4 < line.size(); i += 6) {
      for (int way : {1, -1}) {
        const size_t from = way > 0 ? i : line.size() - 1 - i, to = way > 0 ? i + 4 : line.size() - 5 - i;
        const Vec3 eye = line[from] + Vec3(0, 0, 0.68 * p.height_m);
        const Vec3 ahead = (line[to] - line[from]).normalized();
        const double sight = caster.nearest(Ray{eye, ahead, 200}).range_m;
        // Of a mesh that is a part of the mine: not from beyond it, nor out of it.
        if (!std::isfinite(sight) || !std::isfinite(caster.nearest(Ray{eye, {0, 0, -1}, 10}).range_m)) continue;
        places.push_back({eye, ahead, std::min(best_sight_m, sight)});
      }
    }
  }
  return places;
}

Picture look(const World& world, const std::vector<float>& bright, const Place& place, int width, int height) {
  Camera camera;
  camera.eye = place.eye;
  camera.target = place.eye + place.ahead - Vec3(0, 0, 0.05);
  camera.fov_rad = 1.15;
  camera.near_m = 0.08;
  camera.far_m = 150;
  Scene scene;
  scene.light = Light::headlamp;
  scene.background = rgb(0x0d0d0e);
  const Mesh& mesh = world.mesh;
  scene.skins.push_back(skin_of(
      mesh, [&](std::uint32_t v, Label label) { return colour_of(mesh, bright, v, label); },
      [&](size_t f) { return (mesh.corner(f, 0) - place.eye).norm() < lit_m; }));
  scene.skins.back().rock = 1;
  return take_picture(scene, camera, width, height);
}

// As the truth tells it, else from the mesh.
std::vector<std::vector<Vec2>> outline_of(const World& world) {
  if (world.outline.empty()) return plan_outline(world.mesh);
  std::vector<std::vector<Vec2>> outline{world.outline};
  for (const Pillar& p : world.pillars) outline.emplace_back(p.outline.rbegin(), p.outline.rend());
  return outline;
}

Picture plan_picture(const World& world, int width_px) {
  const std::vector<std::vector<Vec2>> outline = outline_of(world);
  Vec2 low(1e300, 1e300), high(-1e300, -1e300);
  for (const auto& ring : outline) {
    for (const Vec2& p : ring) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  }
  const double margin = 0.02 * (high - low).maxCoeff() + 2;
  auto [drawing, frame] =
      plan_sheet(low - Vec2(margin, margin), high + Vec2(margin, margin), width_px, {70, 20, 20, 60});
  add_ground(drawing, frame, outline);
  add_rim(drawing, frame, outline, ink::edge, 1.2);
  for (const Passage& p : world.passages) {
    std::vector<Vec2> line;
    for (const Vec3& v : p.centre_line) line.push_back(v.head<2>());
    add_path(drawing, frame, line, mix(ink::map, ink::open, 0.45), 1.2, 5);
  }
  for (const Junction& j : world.junctions)
    drawing.add(Disc{.centre = frame(j.p_W.head<2>()),
                     .radius_px = 3,
                     .fill = j.degree() == 1 ? ink::white : ink::map,
                     .rim = ink::map,
                     .rim_px = 1});
  add_axes(drawing, frame, 15);
  drawing.height_px = 2 * std::ceil(drawing.height_px / 2);
  return to_picture(drawing);
}

}  // namespace

std::vector<MineView> mine_views(const World& world, int width_px) {
  if (world.passages.empty() || world.mesh.face.empty()) return {};
  std::vector<MineView> views;
  views.push_back({"plan", plan_picture(world, width_px)});
  const std::vector<Place> places = places_of(world);
  if (places.empty()) return views;
  const std::vector<float> bright = brightness(world.mesh);
  // The first has the longest sight; the second is the one that trades sight for distance from the first best.
  const auto first = std::max_element(places.begin(), places.end(),
                                      [](const Place& a, const Place& b) { return a.sight_m < b.sight_m; });
  const auto worth = [&](const Place& p) {
    return std::min(40.0, (p.eye - first->eye).norm()) - 2 * std::abs(p.sight_m - 12);
  };
  const auto second = std::max_element(places.begin(), places.end(),
                                       [&](const Place& a, const Place& b) { return worth(a) < worth(b); });
  const int height = 2 * (width_px * 5 / 16);
  views.push_back({"interior-1", look(world, bright, *first, width_px, height)});
  views.push_back({"interior-2", look(world, bright, *second, width_px, height)});
  return views;
}

}  // namespace adit
