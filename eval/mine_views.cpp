// SPDX-License-Identifier: BSD-3-Clause
#include "eval/mine_views.h"

#include "eval/lamp.h"
#include "eval/outline.h"
#include "eval/plan.h"
#include "rays/caster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace adit {
namespace {

constexpr double best_sight_m = 30;  // beyond it more sight makes no better picture

struct Place : Lookout {
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
        places.push_back({{eye, ahead}, std::min(best_sight_m, sight)});
      }
    }
  }
  return places;
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

// Up to so many places on what bears a label, evenly taken from its faces.
std::vector<Vec3> pieces_of(const World& world, Label label) {
  constexpr size_t most = 400;
  const Mesh& mesh = world.mesh;
  std::vector<size_t> faces;
  for (size_t f = 0; f < mesh.face.size(); ++f)
    if (label_of(mesh, f) == label) faces.push_back(f);
  std::vector<Vec3> pieces;
  for (size_t k = 0; k < faces.size(); k += 1 + faces.size() / most) {
    const size_t f = faces[k];
    pieces.push_back((mesh.corner(f, 0) + mesh.corner(f, 1) + mesh.corner(f, 2)) / 3);
  }
  return pieces;
}

// The way to look from a place to see the most of some pieces, those some 4 m away above all.
struct Outlook {
  double worth = 0;
  Vec3 to = Vec3::Zero();
};
Outlook outlook_of(const Caster& caster, const std::vector<Vec3>& pieces, const Vec3& eye) {
  constexpr int ways = 12;  // a picture is some three of them wide
  std::array<Outlook, ways> of_way;
  for (const Vec3& piece : pieces) {
    const Vec3 to = piece - eye;
    const double far = to.norm();
    if (far < 1.5 || far > 9 || caster.nearest(Ray{eye, to / far, far + 1}).range_m < far - 0.02) continue;
    const double worth = std::exp(-0.15 * (far - 4) * (far - 4));
    const int way = static_cast<int>(std::floor((std::atan2(to.y(), to.x()) / std::numbers::pi + 1) / 2 * ways)) % ways;
    for (const int beside : {-1, 0, 1}) {
      Outlook& own = of_way[(way + beside + ways) % ways];
      own.worth += worth * (beside == 0 ? 1.0 : 0.5);
      own.to += worth * to / far;
    }
  }
  return *std::max_element(of_way.begin(), of_way.end(),
                           [](const Outlook& a, const Outlook& b) { return a.worth < b.worth; });
}

}  // namespace

Picture look_into(const World& world, const Camera& camera, int width, int height, double lamp_m) {
  const Mesh& mesh = world.mesh;
  const std::vector<float> bright = brightness(mesh);
  const auto lit = lit_from(camera, static_cast<double>(width) / height);
  Scene scene;
  scene.lamp_m = lamp_m;
  scene.skins = mine_skins(
      mesh, [&](std::uint32_t v, Label label) { return colour_of(mesh, bright, v, label); },
      [&](size_t f) { return lit(mesh.corner(f, 0)); });
  return take_lamp_picture(std::move(scene), camera, width, height);
}

std::optional<Lookout> longest_sight(const World& world) {
  const std::vector<Place> places = places_of(world);
  if (places.empty()) return {};
  return *std::max_element(places.begin(), places.end(),
                           [](const Place& a, const Place& b) { return a.sight_m < b.sight_m; });
}

std::optional<Lookout> lookout_to(const World& world, Label label) {
  const Caster caster(world.mesh);
  const std::vector<Vec3> pieces = pieces_of(world, label);
  std::optional<Lookout> best;
  double most = 0;
  for (const Passage& p : world.passages)
    for (const Vec3& foot : p.centre_line) {
      const Vec3 eye = foot + Vec3(0, 0, 0.68 * p.height_m);
      const Outlook outlook = outlook_of(caster, pieces, eye);
      if (outlook.worth <= most) continue;
      most = outlook.worth;
      best = Lookout{eye, outlook.to.normalized()};
    }
  return best;
}

std::vector<MineView> mine_views(const World& world, int width_px) {
  if (world.passages.empty() || world.mesh.face.empty()) return {};
  std::vector<MineView> views;
  views.push_back({"plan", plan_picture(world, width_px)});
  const std::vector<Place> places = places_of(world);
  if (places.empty()) return views;
  // The first has the longest sight; the second is the one that trades sight for distance from the first best.
  const auto first = std::max_element(places.begin(), places.end(),
                                      [](const Place& a, const Place& b) { return a.sight_m < b.sight_m; });
  const auto worth = [&](const Place& p) {
    return std::min(40.0, (p.eye - first->eye).norm()) - 2 * std::abs(p.sight_m - 12);
  };
  const auto second = std::max_element(places.begin(), places.end(),
                                       [&](const Place& a, const Place& b) { return worth(a) < worth(b); });
  const int height = 2 * (width_px * 5 / 16);
  views.push_back({"interior-1", look_into(world, camera_of(*first), width_px, height)});
  views.push_back({"interior-2", look_into(world, camera_of(*second), width_px, height)});
  return views;
}

}  // namespace adit
