// SPDX-License-Identifier: BSD-3-Clause
// Charts.
#include "eval/chart_axes.h"
#include "eval/exhibit.h"
#include "eval/outline.h"

#include <algorithm>
#include <cmath>

namespace adit {

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
