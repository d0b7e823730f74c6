// SPDX-License-Identifier: BSD-3-Clause
// Charts.
#include "eval/exhibit.h"
#include "eval/outline.h"

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

// Axes of a chart: x and y values laid on a rectangle, y up, with ticks, grid lines and words.
struct Axes {
  Vec2 low, high;           // values of the corners
  Vec2 corner_px, size_px;  // upper left

  Vec2 operator()(double x, double y) const {
    return corner_px + Vec2((x - low.x()) / (high.x() - low.x()) * size_px.x(),
                            (high.y() - y) / (high.y() - low.y()) * size_px.y());
  }
};

void add_axes(Drawing& drawing, const Axes& axes, const std::string& x_words, const std::string& y_words) {
  const Type type{.size_px = 16, .colour = ink::faint, .anchor = Anchor::middle};
  const Vec2 a = axes.corner_px, b = a + axes.size_px;
  drawing.add(Area{{{a, {b.x(), a.y()}, b, {a.x(), b.y()}}}, ink::open});
  const double dx = round_down_125((axes.high.x() - axes.low.x()) / 5),
               dy = round_down_125((axes.high.y() - axes.low.y()) / 3);
  for (double x = dx * std::ceil(axes.low.x() / dx); x <= axes.high.x() + 1e-9; x += dx) {
    const Vec2 p = axes(x, axes.low.y());
    drawing.add(Line{{p, p + Vec2(0, 6)}, ink::faint, 1.5});
    drawing.add(Words{p + Vec2(0, 24), plain_number(x, 4), type});
  }
  Type right = type;
  right.anchor = Anchor::end;
  for (double y = dy * std::ceil(axes.low.y() / dy - 1e-9); y <= axes.high.y() + 1e-9; y += dy) {
    const Vec2 p = axes(axes.low.x(), y);
    drawing.add(Line{{p, p + Vec2(axes.size_px.x(), 0)}, ink::rock, 1});
    drawing.add(Words{p + Vec2(-9, 6), plain_number(y, 3), right});
  }
  drawing.add(Words{{b.x(), b.y() + 46}, x_words, right});
  drawing.add(Words{a + Vec2(0, -12), y_words, {.size_px = 16, .colour = ink::faint}});
}

}  // namespace

Figure error_chart(const Exhibit& x) {
  Figure figure{.name = "errors", .title = "Error of the path along the way"};
  const auto& poses = x.input.score.poses;
  if (poses.size() < 2) {
    figure.missing = "the path was not scored";
    return figure;
  }
  std::vector<Vec2> plan, height;
  double top = 1e-3, bottom = 0;
  for (const PoseError& p : poses) {
    plan.emplace_back(p.along_m, p.p_error_W.head<2>().norm());
    height.emplace_back(p.along_m, p.p_error_W.z());
    top = std::max({top, plan.back().y(), height.back().y()});
    bottom = std::min(bottom, height.back().y());
  }
  Drawing drawing;
  drawing.width_px = x.settings.width_px;
  drawing.height_px = 360;
  const double margin = 0.06 * (top - bottom);
  const Axes axes{{poses.front().along_m, bottom - margin},
                  {poses.back().along_m, top + margin},
                  {70, 64},
                  {drawing.width_px - 90, 230}};
  add_axes(drawing, axes, "way driven, m", "error, m");
  drawing.add(Line{{axes(axes.low.x(), 0), axes(axes.high.x(), 0)}, ink::faint, 1.5});
  const auto curve = [&](const std::vector<Vec2>& values, Colour colour) {
    Line line{{}, colour, 2};
    for (const Vec2& v : values) line.p.push_back(axes(v.x(), v.y()));
    line.p = simplified(line.p, 0.35);
    drawing.add(std::move(line));
  };
  curve(height, ink::raw);
  curve(plan, ink::map);
  const double next = add_key(drawing, {200, 28}, ink::map, "in plan (distance)", 17);
  add_key(drawing, {200 + next, 28}, ink::raw, "in height (map − truth)", 17);
  figure.drawing = std::move(drawing);
  figure.caption = "How far the mapped path lies from the true one, laid on it by the best rigid fit.";
  figure.alt = "Chart of the path's error in plan and in height against the way driven";
  return figure;
}

}  // namespace adit
