// SPDX-License-Identifier: BSD-3-Clause
// Upright sections and the close-ups of the worst places.
#include "eval/exhibit.h"
#include "eval/outline.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace adit {

namespace {

// A rectangle of a section plane (way along, height) laid on a drawing; PlanFrame with y as height.
struct SectionSheet {
  PlanFrame frame;
  double stretch;  // of heights
  Vec2 operator()(const Vec2& q) const { return frame({q.x(), stretch * q.y()}); }
};

SectionSheet section_sheet(const Vec2& corner_px, double width_px, double s_low, double s_high, double z_low,
                           double z_high, double stretch) {
  SectionSheet sheet;
  sheet.stretch = stretch;
  sheet.frame.low_W = Vec2(s_low, stretch * z_low);
  sheet.frame.high_W = Vec2(s_high, stretch * z_high);
  sheet.frame.origin_px = corner_px;
  sheet.frame.px_per_m = width_px / (s_high - s_low);
  return sheet;
}

void add_frame(Drawing& drawing, const SectionSheet& sheet, const std::string& words, double type_px) {
  const Vec2 a = sheet.frame.origin_px, b = a + Vec2(sheet.frame.width_px(), sheet.frame.height_px());
  drawing.add(Area{{{a, {b.x(), a.y()}, b, {a.x(), b.y()}}}, ink::open});
  drawing.add(Line{{a, {b.x(), a.y()}, b, {a.x(), b.y()}, a}, ink::faint, 1});
  drawing.add(Words{a + Vec2(0, -8), words, {.size_px = type_px, .colour = ink::text}});
  const double step =
      std::max(0.5, round_down_125((sheet.frame.high_W.y() - sheet.frame.low_W.y()) / sheet.stretch / 3));
  for (double z = step * std::ceil(sheet.frame.low_W.y() / sheet.stretch / step);
       z * sheet.stretch <= sheet.frame.high_W.y(); z += step) {
    const double y = sheet({sheet.frame.low_W.x(), z}).y();
    drawing.add(Line{{{a.x() - 5, y}, {a.x(), y}}, ink::faint, 1.5});
    drawing.add(Words{{a.x() - 8, y + 0.35 * type_px},
                      plain_number(z),
                      {.size_px = 0.85 * type_px, .colour = ink::faint, .anchor = Anchor::end}});
  }
}

bool inside(const SectionSheet& sheet, const Vec2& q) {
  const PlanFrame& f = sheet.frame;
  return q.x() >= f.low_W.x() && q.x() <= f.high_W.x() && sheet.stretch * q.y() >= f.low_W.y() &&
         sheet.stretch * q.y() <= f.high_W.y();
}

void add_true_section(Drawing& drawing, const SectionSheet& sheet, const Mesh& mesh, const Vec2& origin,
                      const Vec2& along) {
  const double reach = std::max(std::abs(sheet.frame.low_W.x()), std::abs(sheet.frame.high_W.x()));
  for (const auto& [a, b] : upright_section(mesh, origin, along, reach))
    if (inside(sheet, a) && inside(sheet, b)) drawing.add(Line{{sheet(a), sheet(b)}, ink::truth, 2});
}

void add_dot(std::vector<Disc>& dots, const SectionSheet& sheet, const Vec2& q, Colour colour, double radius_px) {
  if (inside(sheet, q)) dots.push_back(Disc{.centre = sheet(q), .radius_px = radius_px, .fill = colour});
}

Layer layer_of(const std::vector<Disc>& dots, const SectionSheet& sheet) {
  const Vec2 corner = sheet.frame.origin_px;
  return flattened(dots, corner, corner + Vec2(sheet.frame.width_px(), sheet.frame.height_px()));
}

// The stretch of path, about length_m long and straight, over which the body pitches the most.
struct Stretch {
  size_t first, last;  // poses
};
std::optional<Stretch> most_pitching(const Trajectory& path, double length_m) {
  const std::vector<double> along = distance_along(path);
  std::optional<Stretch> best;
  double most = -1;
  size_t last = 0;
  for (size_t first = 0; first < path.size(); first += std::max<size_t>(1, path.size() / 3000)) {
    while (last < path.size() && along[last] < along[first] + length_m) ++last;
    if (last >= path.size()) break;
    const double chord = (path.X_WB[last].translation() - path.X_WB[first].translation()).head<2>().norm();
    if (chord < 0.97 * length_m) continue;
    double low = 1e9, high = -1e9;
    for (size_t k = first; k <= last; k += std::max<size_t>(1, (last - first) / 60)) {
      const double pitch = yaw_pitch_roll(path.X_WB[k].rotation()).pitch_rad;
      low = std::min(low, pitch), high = std::max(high, pitch);
    }
    if (high - low > most) most = high - low, best = Stretch{first, last};
  }
  return best;
}

// Of a cell's points the greatest error, either way.
Colour greatest(const Exhibit& x, std::span<const std::uint32_t> members) {
  float worst = 0;
  for (const auto i : members)
    if (std::abs(x.point_error_m[i]) > std::abs(worst)) worst = x.point_error_m[i];
  return x.ramp.colour(worst);
}

Pose level(const Pose& X) {
  return pose_of(X.translation(), yaw_pitch_roll(X.rotation()).yaw_rad);
}

}  // namespace

Figure tilt_section(const Exhibit& x) {
  Figure figure{.name = "tilt", .title = "Section along the path, without and with correction of tilt"};
  const Estimate& e = x.input.estimate;
  const Trajectory& truth = x.input.truth.drive.path;
  if (e.points.stamp_s.size() != e.points.size() || e.planar.size() != e.path.size() || e.path.empty() ||
      truth.empty()) {
    figure.missing = "the map keeps no points with times, or no plane path to compare with";
    return figure;
  }
  const auto stretch = most_pitching(e.path, 25);
  if (!stretch) {
    figure.missing = "the path has no straight stretch of 25 m";
    return figure;
  }
  const double t0 = e.path.stamp_s[stretch->first], t1 = e.path.stamp_s[stretch->last], tm = (t0 + t1) / 2;
  const Pose X_WB = level(truth.at(tm));
  const Vec2 origin = X_WB.translation().head<2>(),
             along = (truth.at(t1).translation() - truth.at(t0).translation()).head<2>().normalized();
  const Vec2 across(-along.y(), along.x());
  Trajectory flat;
  flat.stamp_s = e.path.stamp_s;
  for (const Pose2& X : e.planar) flat.X_WB.push_back(lift(X));
  const Pose X_WM_flat = X_WB * level(flat.at(tm)).inverse(),
             X_WM_full = Eigen::Translation3d(X_WB.translation() - x.X_WM * e.path.at(tm).translation()) * x.X_WM;
  const double z = X_WB.translation().z(), heights = 2;
  Drawing drawing;
  drawing.width_px = x.settings.width_px;
  const SectionSheet top = section_sheet({56, 44}, drawing.width_px - 72, -13, 13, z - 1.2, z + 3.4, heights);
  SectionSheet bottom = top;
  bottom.frame.origin_px.y() += top.frame.height_px() + 44;
  drawing.height_px = 2 * std::ceil((bottom.frame.origin_px.y() + bottom.frame.height_px() + 52) / 2);
  add_frame(drawing, top, "level poses: every scan laid as if the cart stood level", 18);
  add_frame(drawing, bottom, "corrected poses: height, pitch and roll as the map has them", 18);
  std::vector<Disc> top_dots, bottom_dots;
  for (size_t k = 0; k < e.points.size(); ++k) {
    const double t = e.points.stamp_s[k];
    if (t < t0 || t > t1) continue;
    const Vec3 p_B = e.path.at(t).inverse() * e.points.p[k];
    const Vec3 p_flat = X_WM_flat * (flat.at(t) * p_B), p_full = X_WM_full * e.points.p[k];
    const auto plot = [&](std::vector<Disc>& dots, const SectionSheet& sheet, const Vec3& p, Colour colour) {
      const Vec2 d = p.head<2>() - origin;
      if (std::abs(across.dot(d)) < 0.15) add_dot(dots, sheet, {along.dot(d), p.z()}, colour, 1.5);
    };
    plot(top_dots, top, p_flat, ink::raw);
    plot(bottom_dots, bottom, p_full, ink::map);
  }
  drawing.add(layer_of(top_dots, top));
  drawing.add(layer_of(bottom_dots, bottom));
  add_true_section(drawing, top, x.input.world.mesh, origin, along);
  add_true_section(drawing, bottom, x.input.world.mesh, origin, along);
  add_scale_bar(drawing, {56, drawing.height_px - 12}, top.frame.px_per_m, 200, 17,
                "  (heights × 2, in metres on the left)");
  add_key(drawing, {drawing.width_px - 330, drawing.height_px - 14}, ink::truth, "true floor and roof", 17);
  figure.drawing = std::move(drawing);
  figure.caption = "An upright cut along the stretch of path that pitches the most, " +
                   plain_number(distance_along(e.path)[stretch->first], 4) +
                   " m after the start; both are shifted to the truth in its middle.";
  figure.alt =
      "Two upright sections along the path with floor and roof points, without and with correction of tilt, over the "
      "true section";
  return figure;
}

Figure spot_view(const Exhibit& x, int k) {
  const std::string number = std::to_string(k + 1);
  Figure figure{.name = "spot-" + number, .title = "Worst place " + number};
  if (k < 0 || k >= static_cast<int>(x.spots.size())) {
    figure.missing = "there are only " + std::to_string(x.spots.size()) + " worst places";
    return figure;
  }
  const Spot& spot = x.spots[k];
  const double half_m = 8, side_px = x.settings.width_px * 0.42;
  // The section runs from the nearest place on the path through the spot; across the passage where the spot lies on the
  // path.
  Vec2 middle = spot.p_W.head<2>(), across = Vec2::UnitY();
  double nearest = 1e30;
  for (const Pose& X : x.input.truth.drive.path.X_WB) {
    const Vec2 way = (spot.p_W - X.translation()).head<2>();
    if (way.norm() >= nearest) continue;
    nearest = way.norm();
    middle = X.translation().head<2>();
    across = nearest > 0.7 ? Vec2(way.normalized()) : Vec2((X.rotation() * -Vec3::UnitY()).head<2>().normalized());
  }
  if (nearest > 3) middle = spot.p_W.head<2>() - 3 * across;
  const Vec2 ahead(-across.y(), across.x());
  auto [drawing, frame] = plan_sheet(spot.p_W.head<2>() - Vec2::Constant(half_m),
                                     spot.p_W.head<2>() + Vec2::Constant(half_m), side_px, {0, 0, 0, 0});
  drawing.width_px = x.settings.width_px;
  frame.origin_px = Vec2(24, 40);
  drawing.height_px = 2 * std::ceil((40 + frame.height_px() + 52) / 2);
  add_ground(drawing, frame, x.outline);
  drawing.add(cell_layer(
      frame, 0.5, x.point_W.size(), [&](size_t i) { return Vec2(x.point_W[i].head<2>()); },
      [&](std::span<const std::uint32_t> members) { return greatest(x, members); }));
  add_rim(drawing, frame, x.outline, ink::truth, 2);
  if (const auto cut = clipped_stretch(middle - 5 * across, middle + 5 * across, frame.low_W, frame.high_W))
    drawing.add(Line{{frame(cut->first), frame(cut->second)}, ink::text, 1.5, 7});
  drawing.add(Disc{
      .centre = frame(spot.p_W.head<2>()), .radius_px = 16, .fill = {0, 0, 0, 0}, .rim = ink::mark, .rim_px = 2.5});
  drawing.add(Words{{24, 28}, "plan, 16 m wide", {.size_px = 18, .colour = ink::text}});
  const double left = frame.origin_px.x() + side_px + 70;
  const SectionSheet section =
      section_sheet({left, 40}, drawing.width_px - left - 24, -5, 5, spot.p_W.z() - 2.6, spot.p_W.z() + 2.6, 1);
  add_frame(drawing, section, "upright section along the dashed line, heights in metres", 18);
  std::vector<Disc> dots;
  for (size_t i = 0; i < x.point_W.size(); ++i) {
    const Vec2 d = x.point_W[i].head<2>() - middle;
    if (std::abs(ahead.dot(d)) < 0.2)
      add_dot(dots, section, {across.dot(d), x.point_W[i].z()}, x.ramp.colour(x.point_error_m[i]), 2.4);
  }
  drawing.add(layer_of(dots, section));
  add_true_section(drawing, section, x.input.world.mesh, middle, across);
  add_scale_bar(drawing, {24, drawing.height_px - 12}, frame.px_per_m, 160, 17);
  add_scale_bar(drawing, {left, 40 + section.frame.height_px() + 40}, section.frame.px_per_m, 160, 17);
  add_colour_bar(drawing, x.ramp, {left + 24, 40 + section.frame.height_px() + 70}, 340, 17);
  const int inside_px = 2 * ((x.settings.width_px - 48) / 2);
  if (const Picture inside = spot_interior(x, spot.p_W, inside_px); !inside.empty()) {
    const double top = drawing.height_px;
    drawing.add(Layer{inside, {24, top}, {24.0 + inside.width, top + inside.height}});
    drawing.height_px = 2 * std::ceil((top + inside.height + 24) / 2);
  }
  figure.drawing = std::move(drawing);
  figure.caption = "At (" + plain_number(spot.p_W.x(), 4) + ", " + plain_number(spot.p_W.y(), 4) +
                   ") m: " + spot.words + ". Black: the true walls. Below: from the path, the place ringed.";
  figure.alt = "Close plan, cross-section and view from the path of worst place " + number +
               " with the map's points coloured by signed error over the true walls";
  return figure;
}

}  // namespace adit
