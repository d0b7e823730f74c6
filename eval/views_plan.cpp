// SPDX-License-Identifier: BSD-3-Clause
// Pictures in plan.
#include "eval/exhibit.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>

namespace adit {

namespace {

std::vector<Vec2> plan_of(const Trajectory& path, double step_m = 0.2) {
  std::vector<Vec2> line;
  for (size_t k = 0; k < path.size(); ++k) {
    const Vec2 p = path.X_WB[k].translation().head<2>();
    if (line.empty() || k + 1 == path.size() || (p - line.back()).norm() >= step_m) line.push_back(p);
  }
  return line;
}

// Mean distance of a cell's points to the true surface.
Colour mean_distance(const Exhibit& x, std::span<const std::uint32_t> members) {
  double sum = 0;
  int n = 0;
  for (const std::uint32_t k : members)
    if (std::isfinite(x.point_error_m[k])) sum += std::abs(x.point_error_m[k]), ++n;
  return n ? x.size_ramp.colour(sum / n) : Colour{0, 0, 0, 0};
}

// Empty cells between at least four that are not take their mean: gaps between scans, not places unseen.
void fill_gaps(Picture& picture) {
  const Picture old = picture;
  for (int y = 1; y + 1 < picture.height; ++y)
    for (int x = 1; x + 1 < picture.width; ++x) {
      if (old.at(x, y).a > 0) continue;
      int r = 0, g = 0, b = 0, n = 0;
      for (int k = 0; k < 9; ++k) {
        const Colour& c = old.at(x - 1 + k % 3, y - 1 + k / 3);
        if (c.a > 0) r += c.r, g += c.g, b += c.b, ++n;
      }
      if (n >= 4)
        picture.at(x, y) = {static_cast<std::uint8_t>(r / n), static_cast<std::uint8_t>(g / n),
                            static_cast<std::uint8_t>(b / n), 255};
    }
}

// Ink by the number of points in a cell.
Colour density(std::span<const std::uint32_t> members) {
  Colour c = ink::text;
  c.a = static_cast<std::uint8_t>(std::lround(255 * (1 - std::exp(-0.7 * static_cast<double>(members.size())))));
  return c;
}

// Where the mapping laser's beams ended, laid by the poses of its scans.
std::vector<Vec2> scan_points(const Log& log, const std::vector<Pose2>& X_MB) {
  constexpr double far_m = 15;  // farther ones meet floor and roof
  std::vector<Vec2> points;
  const int h = find_view(log.rig, View::horizontal);
  if (h < 0 || static_cast<size_t>(h) >= log.scans.size()) return points;
  const Mount& mount = log.rig.mounts[h];
  const Scans& scans = log.scans[h];
  const size_t n = std::min(scans.size(), X_MB.size()), step = std::max<size_t>(1, n / 6000);
  for (size_t i = 0; i < n; i += step) {
    const auto ranges = scans[i];
    for (int k = 0; k < scans.beams; k += 2) {
      if (!(ranges[k] > 0.1 && ranges[k] < far_m)) continue;
      const double a = mount.laser.beam_angle_rad(k);
      const Vec3 p_B = mount.X_BS * Vec3(ranges[k] * std::cos(a), ranges[k] * std::sin(a), 0);
      points.push_back(X_MB[i] * Vec2(p_B.x(), p_B.y()));
    }
  }
  return points;
}

Pose2 in_plane(const Pose& X) {
  return flatten(X);
}

// The rectangle that holds the mine and what else is drawn, so that panels side by side have one scale.
std::pair<Vec2, Vec2> bounds_with(const Exhibit& x, const std::vector<Pose2>& poses, const Pose2& X_WM) {
  Vec2 low = x.low_W, high = x.high_W;
  const Vec2 size = high - low;
  for (const Pose2& X : poses) {
    const Vec2 p = X_WM * X.position();
    low = low.cwiseMin(p - Vec2::Constant(4));
    high = high.cwiseMax(p + Vec2::Constant(4));
  }
  // A path that has run away must not make the mine a dot.
  return {low.cwiseMax(x.low_W - 0.6 * size), high.cwiseMin(x.high_W + 0.6 * size)};
}

Figure panel(const Exhibit& x, const std::string& name, const std::string& title, const Vec2& low, const Vec2& high,
             std::pair<Drawing, PlanFrame>& sheet, bool ground) {
  Figure figure{.name = name, .title = title};
  sheet = plan_sheet(low, high, 640, {12, 12, 12, 48});
  if (ground) {
    add_ground(sheet.first, sheet.second, x.outline);
  } else {
    const Vec2 a = sheet.second.origin_px, b = a + Vec2(sheet.second.width_px(), sheet.second.height_px());
    sheet.first.add(Area{{{a, {b.x(), a.y()}, b, {a.x(), b.y()}}}, ink::open});
  }
  return figure;
}

void finish_panel(Figure& figure, std::pair<Drawing, PlanFrame>& sheet) {
  add_scale_bar(sheet.first, {16, sheet.first.height_px - 14}, sheet.second.px_per_m, 160, 20);
  figure.drawing = std::move(sheet.first);
}

}  // namespace

namespace {

// The plan of errors, for a page width of width_px; `small` sets legend and marks for a telephone.
void draw_errors(Figure& figure, const Exhibit& x, double width_px, bool small) {
  const double type = small ? 15 : 17;
  auto [drawing, frame] = plan_sheet(x.low_W, x.high_W, width_px,
                                     small ? std::array{46.0, 132.0, 20.0, 34.0} : std::array{64.0, 84.0, 22.0, 40.0});
  add_ground(drawing, frame, x.outline);
  if (x.has_points()) {
    // Cells of at least 0.2 m: finer ones would stand empty between scans.
    const double fine = std::min(1.0, 1 / (0.2 * frame.px_per_m));
    Layer heat = cell_layer(
        frame, fine, x.point_W.size(), [&](size_t k) { return Vec2(x.point_W[k].head<2>()); },
        [&](std::span<const std::uint32_t> members) { return mean_distance(x, members); });
    fill_gaps(heat.picture);
    drawing.add(std::move(heat));
  }
  add_rim(drawing, frame, x.outline, ink::edge, small ? 0.9 : 1.4);
  add_path(drawing, frame, plan_of(x.path_W), ink::text, small ? 0.8 : 1.2);
  std::vector<Vec2> places;
  std::vector<std::string> titles;
  for (const Spot& s : x.spots) {
    places.push_back(s.p_W.head<2>());
    titles.push_back("worst place " + std::to_string(places.size()) + ": " + s.words);
  }
  add_marks(drawing, frame, places, small ? 10 : 13, titles, "#spot-");
  add_axes(drawing, frame, type - 1);
  add_colour_bar(drawing, x.size_ramp, {frame.origin_px.x(), 6}, small ? 300 : 380, type);
  const Vec2 keys = small ? Vec2(frame.origin_px.x(), 92) : Vec2(frame.origin_px.x() + 440, 30);
  const double next = add_key(drawing, keys, ink::edge, "true walls", type);
  add_key(drawing, keys + Vec2(next, 0), ink::text, "mapped path", type);
  add_scale_bar(drawing, small ? Vec2(keys.x(), 124) : keys + Vec2(0, 42), frame.px_per_m, small ? 130 : 220, type);
  add_north(drawing, {drawing.width_px - 34, 26}, 34);
  figure.drawing = std::move(drawing);
  figure.frame = frame;
}

}  // namespace

Figure error_plan(const Exhibit& x) {
  Figure figure{.name = "plan", .title = "Where the map is off"};
  draw_errors(figure, x, x.settings.width_px, false);
  figure.caption =
      x.has_points()
          ? "True walls, and over them the map's points (laid by the best rigid fit) coloured by their mean distance "
            "to the true rock; pale is right, "
            "white was not mapped. Rings number the worst places and lead to their close-ups. Axes in metres."
          : "The map has no points: the plan shows the true walls and the mapped path alone. Axes in metres.";
  figure.alt =
      "Plan of the mine with the mapped points coloured by their distance to the true rock; the worst places are "
      "ringed and numbered";
  if (!x.has_world() && !x.has_points() && x.path_W.empty()) figure.missing = "there is neither a mine nor a map";
  return figure;
}

Figure narrow_error_plan(const Exhibit& x) {
  Figure figure{.name = "plan", .title = "Where the map is off"};
  draw_errors(figure, x, 540, true);
  return figure;
}

Figure truth_plan(const Exhibit& x) {
  const auto [low, high] = bounds_with(x, x.input.estimate.open_loop, in_plane(x.X_WM_first));
  std::pair<Drawing, PlanFrame> sheet;
  Figure figure = panel(x, "truth", "The mine and the path driven", low, high, sheet, true);
  add_rim(sheet.first, sheet.second, x.outline, ink::edge, 1.2);
  add_path(sheet.first, sheet.second, plan_of(x.input.truth.drive.path), ink::good, 2.2);
  finish_panel(figure, sheet);
  figure.caption = "(a) The true mine and the true path.";
  figure.alt = "Plan of the true mine with the true path";
  if (!x.has_world()) figure.missing = "there is no true mine";
  return figure;
}

Figure raw_plan(const Exhibit& x) {
  const auto& open_loop = x.input.estimate.open_loop;
  const Pose2 X_WM = in_plane(x.X_WM_first);
  const auto [low, high] = bounds_with(x, open_loop, X_WM);
  std::pair<Drawing, PlanFrame> sheet;
  Figure figure = panel(x, "raw", "Scan matching alone", low, high, sheet, false);
  auto& [drawing, frame] = sheet;
  std::vector<Pose2> X_WB;
  std::vector<Vec2> line;
  for (const Pose2& X : open_loop) {
    X_WB.push_back(X_WM * X);
    line.push_back(X_WB.back().position());
  }
  const std::vector<Vec2> points = scan_points(x.input.log, X_WB);
  drawing.add(cell_layer(
      frame, 1, points.size(), [&](size_t k) { return points[k]; }, density));
  add_path(drawing, frame, line, ink::raw, 2.2);
  finish_panel(figure, sheet);
  figure.caption = "(b) Scans laid by scan matching alone: right nearby, adrift over the whole.";
  figure.alt = "Plan of the scans laid by scan matching alone";
  if (open_loop.empty()) figure.missing = "the map keeps no path of scan matching alone";
  return figure;
}

Figure aligned_plan(const Exhibit& x) {
  const auto [low, high] = bounds_with(x, x.input.estimate.open_loop, in_plane(x.X_WM_first));
  std::pair<Drawing, PlanFrame> sheet;
  Figure figure = panel(x, "aligned", "After the global alignment", low, high, sheet, false);
  auto& [drawing, frame] = sheet;
  const auto& planar = x.input.estimate.planar;
  std::vector<Pose2> X_WB;
  if (!planar.empty())
    for (const Pose2& X : planar) X_WB.push_back(in_plane(x.X_WM * lift(X)));
  else
    for (const Pose& X : x.path_W.X_WB) X_WB.push_back(flatten(X));
  std::vector<Vec2> line;
  for (const Pose2& X : X_WB) line.push_back(X.position());
  const std::vector<Vec2> points = scan_points(x.input.log, X_WB);
  drawing.add(cell_layer(
      frame, 1, points.size(), [&](size_t k) { return points[k]; }, density));
  add_path(drawing, frame, line, ink::map, 2.2);
  finish_panel(figure, sheet);
  figure.caption = "(c) The same scans after the global alignment.";
  figure.alt = "Plan of the scans after the global alignment";
  if (X_WB.empty()) figure.missing = "the map has no path";
  return figure;
}

Figure rounds_plan(const Exhibit& x) {
  Figure figure{.name = "rounds", .title = "Rounds of the global alignment"};
  const auto& rounds = x.input.estimate.rounds;
  if (rounds.empty()) {
    figure.missing = "the map keeps no rounds of its alignment";
    return figure;
  }
  // All of them, or the first five and the last.
  std::vector<size_t> shown;
  for (size_t k = 0; k < rounds.size() && shown.size() < (rounds.size() > 6 ? 5u : 6u); ++k) shown.push_back(k);
  if (rounds.size() > 6) shown.push_back(rounds.size() - 1);
  const Pose2 X_WM = in_plane(x.X_WM_first);
  std::vector<Pose2> all;
  for (const auto& round : rounds)
    for (const Vec2& p : round.nodes) all.push_back({p.x(), p.y(), 0});
  const auto [low, high] = bounds_with(x, all, X_WM);
  const int columns = std::min<int>(3, static_cast<int>(shown.size()));
  const double width = x.settings.width_px / static_cast<double>(columns);
  const auto [one, frame0] = plan_sheet(low, high, width, {10, 44, 10, 14});
  Drawing sheet;
  sheet.width_px = x.settings.width_px;
  sheet.height_px = one.height_px * std::ceil(shown.size() / static_cast<double>(columns)) + 34;
  for (size_t s = 0; s < shown.size(); ++s) {
    PlanFrame frame = frame0;
    const Vec2 corner(width * static_cast<double>(s % columns), one.height_px * static_cast<double>(s / columns));
    frame.origin_px += corner;
    const AlignmentRound& round = rounds[shown[s]];
    const auto at = [&](int node) { return frame(X_WM * round.nodes[node]); };
    for (const auto& [i, j] : round.correspondences) sheet.add(Line{{at(i), at(j)}, ink::raw, 1.4});
    std::vector<Vec2> line;
    for (const Vec2& p : round.nodes) line.push_back(X_WM * p);
    add_path(sheet, frame, line, ink::map, 1.2);
    for (int k = 0; k < static_cast<int>(round.nodes.size()); ++k)
      sheet.add(Disc{.centre = at(k), .radius_px = 1.8, .fill = ink::map});
    for (const auto& [i, j] : round.correspondences)
      for (const int k : {i, j}) sheet.add(Disc{.centre = at(k), .radius_px = 2.6, .fill = ink::raw});
    const std::string words = "round " + std::to_string(shown[s] + 1) + ": " +
                              std::to_string(round.correspondences.size()) + " correspondences";
    sheet.add(Words{corner + Vec2(14, 28), words, {.size_px = 18, .colour = ink::text, .halo_px = 2}});
  }
  add_scale_bar(sheet, {16, sheet.height_px - 12}, frame0.px_per_m, 160, 18);
  figure.drawing = std::move(sheet);
  figure.caption =
      "The path (blue, a node every few metres) before each round, and the pairs of places that the round takes for "
      "the same (orange, joined where they lie apart). " +
      std::string(x.input.estimate.converged ? "The pairs repeated: the alignment has converged."
                                             : "The pairs did not repeat: the alignment has not converged.");
  figure.alt = "Small plans of the path and its correspondences before each round of the alignment";
  return figure;
}

Figure grid_plan(const Exhibit& x) {
  Figure figure{.name = "grid", .title = "Occupancy grid beside the true plan"};
  const Grid& grid = x.input.estimate.grid;
  if (grid.log_odds.empty()) {
    figure.missing = "the map has no grid";
    return figure;
  }
  const double width = x.settings.width_px / 2.0;
  auto [one, frame] = plan_sheet(x.low_W, x.high_W, width, {10, 40, 10, 46});
  Drawing sheet = one;
  sheet.width_px = x.settings.width_px;
  const Pose2 X_MW = in_plane(x.X_WM).inverse();
  Layer layer{Picture(static_cast<int>(2 * frame.width_px()), static_cast<int>(2 * frame.height_px()), rgb(0xc9c9c9)),
              frame.origin_px, frame.origin_px + Vec2(frame.width_px(), frame.height_px())};
  for (int v = 0; v < layer.picture.height; ++v)
    for (int u = 0; u < layer.picture.width; ++u) {
      const Vec2 p_M = X_MW * frame.metres(frame.origin_px + Vec2((u + 0.5) / 2, (v + 0.5) / 2));
      const int i = static_cast<int>(std::floor((p_M.x() - grid.origin.x()) / grid.cell_m)),
                j = static_cast<int>(std::floor((p_M.y() - grid.origin.y()) / grid.cell_m));
      if (i < 0 || j < 0 || i >= grid.width || j >= grid.height) continue;
      const double odds = grid.log_odds[grid.index(i, j)];
      const double p = 1 / (1 + std::exp(-odds));
      if (odds != 0) layer.picture.at(u, v) = mix(ink::white, rgb(0x101010), p);
    }
  sheet.add(layer);
  PlanFrame right = frame;
  right.origin_px.x() += width;
  add_ground(sheet, right, x.outline);
  add_rim(sheet, right, x.outline, ink::edge, 1.2);
  sheet.add(Words{
      {14, 28}, "the map's grid, " + plain_number(grid.cell_m) + " m cells", {.size_px = 18, .colour = ink::text}});
  sheet.add(Words{{width + 14, 28}, "the true mine", {.size_px = 18, .colour = ink::text}});
  add_scale_bar(sheet, {16, sheet.height_px - 14}, frame.px_per_m, 160, 18);
  figure.drawing = std::move(sheet);
  figure.caption =
      "Left: what the map knows of the plane of the mapping laser; white is free, black occupied, grey never seen. "
      "Right: the true mine.";
  figure.alt = "Occupancy grid of the map beside the plan of the true mine";
  return figure;
}

Figure closures_plan(const Exhibit& x) {
  Figure figure{.name = "closures", .title = "Loop closures"};
  const auto& closures = x.input.estimate.closures;
  if (closures.empty() || x.path_W.empty()) {
    figure.missing = "the map claims no loop closures";
    return figure;
  }
  auto [drawing, frame] = plan_sheet(x.low_W, x.high_W, x.settings.width_px, {64, 50, 14, 44});
  add_ground(drawing, frame, x.outline);
  add_rim(drawing, frame, x.outline, ink::edge, 1.2);
  add_path(drawing, frame, plan_of(x.path_W), ink::faint, 1.2);
  const auto true_place = [&](int i) -> std::optional<Vec2> {
    const Trajectory& truth = x.input.truth.drive.path;
    const double t = x.path_W.stamp_s[i];
    if (!truth.covers(t)) return {};
    return Vec2(truth.at(t).translation().head<2>());
  };
  const Colour unsure = rgb(0xcc79a7), left_out = rgb(0x9a9a9a);
  int n_right = 0, n_wrong = 0, n_unsure = 0, n_left_out = 0;
  const int poses = static_cast<int>(x.path_W.size());
  for (const Closure& c : closures) {
    if (c.i < 0 || c.j < 0 || c.i >= poses || c.j >= poses) continue;
    const auto a = true_place(c.i), b = true_place(c.j);
    const bool right = !a || !b || (*a - *b).norm() < 3;
    const Vec2 p = frame(x.path_W.X_WB[c.i].translation().head<2>()),
               q = frame(x.path_W.X_WB[c.j].translation().head<2>());
    const Colour colour = c.ambiguous ? unsure : !c.accepted ? left_out : right ? ink::good : ink::raw;
    ++(c.ambiguous ? n_unsure : !c.accepted ? n_left_out : right ? n_right : n_wrong);
    drawing.add(Line{{p, q}, colour, c.accepted && !right ? 3.0 : 2.0});
    drawing.add(Disc{.centre = (p + q) / 2, .radius_px = c.accepted && !right ? 6.0 : 3.0, .fill = colour});
  }
  double at = 64;
  at += add_key(drawing, {at, 32}, ink::good, "accepted, right place: " + std::to_string(n_right), 17);
  at += add_key(drawing, {at, 32}, ink::raw, "accepted, wrong place: " + std::to_string(n_wrong), 17);
  at += add_key(drawing, {at, 32}, unsure, "ambiguous: " + std::to_string(n_unsure), 17);
  add_key(drawing, {at, 32}, left_out, "not accepted: " + std::to_string(n_left_out), 17);
  add_axes(drawing, frame, 16);
  figure.drawing = std::move(drawing);
  figure.caption =
      "Pairs of scans that the map takes for the same place. A place is right when the true poses lie within 3 m; "
      "ambiguous are those that the map itself says could as well be elsewhere.";
  figure.alt = "Plan with the loop closures: right, wrong, ambiguous and not accepted ones told apart";
  return figure;
}

}  // namespace adit
