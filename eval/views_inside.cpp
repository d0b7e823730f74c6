// SPDX-License-Identifier: BSD-3-Clause
// Pictures from within: what a lamp shows from the path, the mine beside the map.
#include "base/parallel.h"
#include "eval/animation.h"
#include "eval/mine_views.h"
#include "eval/views.h"

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

constexpr double eye_m = 1.35;  // above the path

struct PathLookout : Lookout {
  double along_m;
};

const Trajectory& path_to_look_from(const Exhibit& x) {
  return x.input.truth.drive.path.empty() ? x.path_W : x.input.truth.drive.path;
}

// A place on the path from which the way ahead is long: near a share of the way driven, within `reach` of it.
std::optional<PathLookout> lookout(const Exhibit& x, double share, double reach) {
  const Trajectory& path = path_to_look_from(x);
  if (path.size() < 2) return {};
  const std::vector<double> along = distance_along(path);
  const double total = along.back(), wanted = total * share;
  std::optional<PathLookout> best;
  double best_view = -1;
  for (double d = -reach * total; d <= reach * total; d += std::max(0.5, 0.004 * total)) {
    const double at = std::clamp(wanted + d, 0.0, total);
    const auto i = std::min<size_t>(
        path.size() - 1, static_cast<size_t>(std::lower_bound(along.begin(), along.end(), at) - along.begin()));
    const auto j = std::min<size_t>(
        path.size() - 1, static_cast<size_t>(std::lower_bound(along.begin(), along.end(), at + 4) - along.begin()));
    const Vec3 eye = path.X_WB[i].translation() + Vec3(0, 0, eye_m);
    Vec3 way = path.X_WB[i].rotation() * Vec3::UnitX();
    if (j > i && (path.X_WB[j].translation() - path.X_WB[i].translation()).norm() > 1)
      way = path.X_WB[j].translation() - path.X_WB[i].translation();
    way.normalize();
    const double view = x.caster ? std::min(25.0, x.caster->nearest(Ray{eye, way, 100}).range_m) : 1;
    if (view > best_view + 1e-9) best_view = view, best = PathLookout{{eye, way}, along[i]};
  }
  return best;
}

void add_plate(Drawing& drawing, double left, const std::string& words, double type_px) {
  const double w = text_width(words, type_px, true) + 1.2 * type_px, h = 1.8 * type_px;
  drawing.add(Area{{{{left, 0}, {left + w, 0}, {left + w, h}, {left, h}}}, {0, 0, 0, 170}});
  drawing.add(
      Words{{left + 0.6 * type_px, 1.25 * type_px}, words, {.size_px = type_px, .colour = ink::white, .bold = true}});
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

// The mine and the map from one place.
struct Pair {
  Picture mine, map;
};
Pair look(const Exhibit& x, const Lookout& from, const Camera& camera, int width, int height, double lamp_m = 8) {
  const auto near = lit_from(camera, static_cast<double>(width) / height);
  Scene truth, map;
  truth.lamp_m = map.lamp_m = lamp_m;
  Skin staff;
  add_staff(staff, x, from);
  if (x.has_world()) {
    const Mesh& mesh = x.input.world.mesh;
    truth.skins = mine_skins(
        mesh, [](std::uint32_t, Label label) { return rock_colour(label); },
        [&](size_t f) { return near(mesh.corner(f, 0)); });
    truth.skins.push_back(staff);
  }
  if (x.has_surface())
    map.skins.push_back(error_skin(x, 1, 0, near));
  else
    map.dots.push_back(error_dots(x, true, 1, 0, near));
  map.skins.push_back(staff);
  return {take_lamp_picture(std::move(truth), camera, width, height),
          take_lamp_picture(std::move(map), camera, width, height)};
}

Drawing beside(const Pair& pair, const std::string& map_words, double type_px = 20) {
  Drawing drawing;
  const double width = pair.mine.width, height = pair.mine.height, right = width + 8;
  drawing.width_px = 2 * width + 8;
  drawing.height_px = height;
  drawing.add(Layer{pair.mine, {0, 0}, {width, height}});
  drawing.add(Layer{pair.map, {right, 0}, {right + width, height}});
  add_plate(drawing, 0, "the mine", type_px);
  add_plate(drawing, right, map_words, type_px);
  return drawing;
}

std::string map_words(const Exhibit& x) {
  return std::string("the map") + (x.has_surface() ? "" : " (points)") + ", coloured by error";
}

// From the path towards a place: where it is seen from about 4 m away, else from the nearest pose.
std::optional<Lookout> lookout_to(const Exhibit& x, const Vec3& place) {
  const Trajectory& path = path_to_look_from(x);
  std::optional<Lookout> best;
  double least = 1e30;
  const size_t step = 1 + path.size() / 20000;
  for (size_t i = 0; i < path.size(); i += step) {
    const Vec3 eye = path.X_WB[i].translation() + Vec3(0, 0, eye_m), to = place - eye;
    const double far = to.norm();
    double cost = std::abs(far - 4);
    if (cost >= least || far < 0.5) continue;
    const bool seen = !x.caster || x.caster->nearest(Ray{eye, to / far, far + 1}).range_m > far - 0.4;
    if (!seen) cost += 100;
    if (cost < least) least = cost, best = Lookout{eye, to / far};
  }
  return best;
}

}  // namespace

Figure interior_view(const Exhibit& x, int k) {
  const std::string number = std::to_string(k + 1);
  Figure figure{.name = "interior-" + number, .title = "From the path, " + number};
  auto from = lookout(x, (k + 0.5) / std::max(1, x.settings.interiors), 0.06);
  if (x.viewpoint) from = PathLookout{{x.viewpoint->eye, (x.viewpoint->target - x.viewpoint->eye).normalized()}, 0};
  if (!from || (!x.has_surface() && !x.has_points())) {
    figure.missing = !from ? "there is no path to look from" : "the map has neither a surface nor points";
    return figure;
  }
  const int width = x.settings.width_px / 2 - 4, height = width * 5 / 8;
  const Camera camera = x.viewpoint ? camera_at(*x.viewpoint) : camera_of(*from);
  Drawing drawing = beside(look(x, *from, camera, width, height), map_words(x));
  const double bar = 240, corner = drawing.width_px - bar - 54, top = drawing.height_px - 64;
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

namespace {

Figure lamp_figure(const Exhibit& x, Figure figure, const std::optional<Lookout>& from, const std::string& lack) {
  if (!from && !x.viewpoint) {
    figure.missing = lack;
    return figure;
  }
  const Camera camera = x.viewpoint ? camera_at(*x.viewpoint) : camera_of(*from);
  const int width = x.settings.width_px, height = 2 * (width * 9 / 32);
  figure.drawing.width_px = width;
  figure.drawing.height_px = height;
  figure.drawing.add(Layer{look_into(x.input.world, camera, width, height),
                           {0, 0},
                           {static_cast<double>(width), static_cast<double>(height)}});
  add_plate(figure.drawing, 0, figure.title, 20);
  figure.alt = "What a lamp shows of the true mine: " + figure.title;
  return figure;
}

}  // namespace

Figure mine_view(const Exhibit& x) {
  return lamp_figure(x, {.name = "mine", .title = "the mine"}, longest_sight(x.input.world),
                     "there is no mine with passages to look along; give a viewpoint");
}

Figure thing_view(const Exhibit& x, Label label) {
  const std::string name = label_name(label);
  return lamp_figure(x, {.name = "thing-" + name, .title = name}, lookout_to(x.input.world, label),
                     "the mine has no " + name + " that can be seen from a passage");
}

std::vector<AlongFrame> along_frames(const Exhibit& x, const Progress& progress) {
  constexpr int width = 336, height = 210;
  std::vector<AlongFrame> frames;
  if (!x.has_surface() && !x.has_points()) return frames;
  std::vector<PathLookout> lookouts;
  for (int k = 0; k < x.settings.frames; ++k) {
    const auto from = lookout(x, (k + 0.5) / x.settings.frames, 0);
    if (!from) break;
    lookouts.push_back(*from);
  }
  frames.resize(lookouts.size());
  progress("report: along the path", 0, x.settings.frames);
  parallel_for(frames.size(), [&](size_t k) {
    const PathLookout& from = lookouts[k];
    Drawing drawing = beside(look(x, from, camera_of(from), width, height), "the map", 12);
    drawing.add(Words{{drawing.width_px - 10, height - 10.0},
                      plain_number(from.along_m, 4) + " m",
                      {.size_px = 13, .colour = ink::white, .anchor = Anchor::end, .bold = true}});
    frames[k] = {from.along_m, encode_png(to_picture(drawing))};
  });
  progress("report: along the path", x.settings.frames, x.settings.frames);
  return frames;
}

std::string animation_of(const std::vector<AlongFrame>& frames) {
  std::vector<std::string> pngs;
  for (const AlongFrame& frame : frames) pngs.push_back(frame.png);
  return encode_animation(pngs, frame_ms);
}

Picture spot_interior(const Exhibit& x, const Vec3& place_W, int width) {
  const auto from = lookout_to(x, place_W);
  if (!from || (!x.has_surface() && !x.has_points())) return {};
  Camera camera = camera_of(*from);
  camera.target = from->eye + from->ahead;
  const int half = width / 2 - 4, height = 2 * (half / 4);
  const double far_m = (place_W - from->eye).norm();  // a place at the end of the light would be dark
  Drawing drawing = beside(look(x, *from, camera, half, height, std::max(8.0, 1.3 * far_m)), map_words(x));
  const auto at = project(camera, half, height, place_W);
  for (const double left : {0.0, half + 8.0})
    if (at)
      drawing.add(Disc{.centre = at->head<2>() + Vec2(left, 0),
                       .radius_px = 26,
                       .fill = {0, 0, 0, 0},
                       .rim = ink::white,
                       .rim_px = 2.5});
  return to_picture(drawing);
}

}  // namespace adit
