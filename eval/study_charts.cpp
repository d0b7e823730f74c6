// SPDX-License-Identifier: BSD-3-Clause
#include "eval/study_charts.h"

#include "eval/drawing.h"
#include "eval/ramp.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

const Colour dark = rgb(0x1b1d22), faint = rgb(0x5b606b), rule = rgb(0xd9dce2), blue = rgb(0x0072b2),
             orange = rgb(0xd55e00), grey = rgb(0x9aa0aa);

std::string figure(const Drawing& drawing, const std::string& title, const std::string& caption) {
  return "<figure><h3>" + escaped(title) + "</h3>\n" + to_svg(drawing, title) + "\n<figcaption>" + escaped(caption) +
         "</figcaption></figure>\n";
}

// A range that holds the values with a margin.
struct Range {
  double low = 0, high = 1;
  explicit Range(const std::vector<double>& values) {
    bool any = false;
    for (const double v : values) {
      if (!std::isfinite(v)) continue;
      low = any ? std::min(low, v) : v, high = any ? std::max(high, v) : v, any = true;
    }
    const double margin = high > low ? 0.08 * (high - low) : std::max(1e-6, 0.1 * std::abs(high));
    low -= margin, high += margin;
  }
  double at(double v) const { return (v - low) / (high - low); }
};

// A chart of two quantities: where its frame lies and what its axes hold.
struct Chart {
  Drawing drawing;
  Range x, y;
  Vec2 corner{90, 30}, size{560, 330};

  Chart(const std::vector<double>& xs, const std::vector<double>& ys, const std::string& x_words,
        const std::string& y_words)
      : x(xs), y(ys) {
    drawing.width_px = 700, drawing.height_px = 430, drawing.background = rgb(0xffffff);
    const Type type{.size_px = 15, .colour = faint, .anchor = Anchor::middle};
    Type right = type, left = type;
    right.anchor = Anchor::end, left.anchor = Anchor::start;
    const double dx = round_down_125((x.high - x.low) / 4), dy = round_down_125((y.high - y.low) / 4);
    for (double v = dx * std::ceil(x.low / dx); v <= x.high; v += dx) {
      drawing.add(Line{{at(v, y.low), at(v, y.high)}, rule, 1});
      drawing.add(Words{at(v, y.low) + Vec2(0, 22), study_number(v), type});
    }
    for (double v = dy * std::ceil(y.low / dy); v <= y.high; v += dy) {
      drawing.add(Line{{at(x.low, v), at(x.high, v)}, rule, 1});
      drawing.add(Words{at(x.low, v) + Vec2(-8, 5), study_number(v), right});
    }
    drawing.add(Words{{corner.x() + size.x(), corner.y() + size.y() + 46}, x_words, right});
    drawing.add(Words{{corner.x() - 70, 20}, y_words, left});
  }
  Vec2 at(double vx, double vy) const { return corner + Vec2(x.at(vx) * size.x(), (1 - y.at(vy)) * size.y()); }
};

}  // namespace

std::string study_number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, std::abs(v) >= 1000 && std::abs(v) < 1e7 ? "%.0f" : "%.3g", v);
  return std::isfinite(v) ? text : "–";
}

std::string objective_words(const StudyTable& t, size_t o) {
  for (const StudyColumn& c : t.metric)
    if (c.name == t.objective[o]) return c.name + (c.unit.empty() ? "" : ", " + c.unit);
  return t.objective[o];
}

std::string front_chart(const StudyPage& p, size_t a, size_t b) {
  std::vector<double> xs, ys;
  for (const StudyAnswer::Point& point : p.answer.point) {
    xs.insert(xs.end(), {point.value[a].median, point.value[a].low, point.value[a].high});
    ys.insert(ys.end(), {point.value[b].median, point.value[b].low, point.value[b].high});
  }
  Chart chart(xs, ys, objective_words(p.table, a), objective_words(p.table, b));
  for (const bool front : {false, true})
    for (size_t i = 0; i < p.answer.point.size(); ++i) {
      const StudyAnswer::Point& point = p.answer.point[i];
      const Spread &x = point.value[a], &y = point.value[b];
      if (point.front != front || !std::isfinite(x.median) || !std::isfinite(y.median)) continue;
      const Colour colour = front ? orange : grey;
      if (std::isfinite(x.low))
        chart.drawing.add(Line{{chart.at(x.low, y.median), chart.at(x.high, y.median)}, colour, 1.5});
      if (std::isfinite(y.low))
        chart.drawing.add(Line{{chart.at(x.median, y.low), chart.at(x.median, y.high)}, colour, 1.5});
      chart.drawing.add(Disc{.centre = chart.at(x.median, y.median),
                             .radius_px = front ? 7.0 : 5.0,
                             .fill = colour,
                             .title = words_of(p.table, i)});
      if (p.answer.point.size() <= 40)
        chart.drawing.add(
            Words{chart.at(x.median, y.median) + Vec2(9, -7), std::to_string(i + 1), {.size_px = 14, .colour = dark}});
    }
  return figure(chart.drawing, "What can be had together",
                "Medians over the seeds with 95 % intervals (from five seeds on); orange: no other point is as good in "
                "everything. Numbers are those of the table.");
}

std::string agreement_chart(const StudyPage& p) {
  const StudyTable& t = p.table;
  const auto objective = std::find_if(t.objective.begin(), t.objective.end(), [&](const std::string& o) {
    return std::any_of(t.metric.begin(), t.metric.end(), [&](const StudyColumn& c) { return c.name == o; });
  });
  if (objective == t.objective.end()) return "";
  const auto o = static_cast<size_t>(objective - t.objective.begin());
  std::vector<double> xs, ys;
  for (size_t i = 0; i < t.point.size(); ++i) {
    if (!std::isfinite(t.point[i].fast[0]) || !std::isfinite(p.answer.point[i].value[o].median)) continue;
    xs.push_back(t.point[i].fast[0]), ys.push_back(p.answer.point[i].value[o].median);
  }
  if (xs.size() < 2) return "";
  Chart chart(xs, ys, "fast value", objective_words(t, o));
  for (size_t i = 0; i < xs.size(); ++i)
    chart.drawing.add(Disc{.centre = chart.at(xs[i], ys[i]), .radius_px = 5, .fill = blue});
  return figure(chart.drawing, "Geometry against the whole pipeline",
                "Each dot is a point of the study, median over the seeds.");
}

std::string blind_chart(const StudyPage& p) {
  Drawing d;
  d.width_px = 700, d.background = rgb(0xffffff);
  double y = 34;
  const std::vector<std::string> unit{"m", "m", "m", "deg", "deg", "deg"},
      names{"along", "across", "up", "roll", "pitch", "yaw"};
  for (const RigWhy& w : p.why) {
    if (!w.score) continue;
    d.add(Words{{20, y}, w.title, {.size_px = 16, .colour = dark, .bold = true}});
    for (Eigen::Index k = 0; k < 6; ++k) {
      y += 24;
      const double sigma = w.score->sigma[k], left = w.score->left[k];
      const double length = 380 * std::clamp(1 + std::log10(std::max(1e-4, left)) / 4, 0.0, 1.0);
      d.add(Words{{90, y + 5}, names[static_cast<size_t>(k)], {.size_px = 14, .colour = faint, .anchor = Anchor::end}});
      d.add(Area{{{{100, y - 7}, {100 + length, y - 7}, {100 + length, y + 7}, {100, y + 7}}},
                 left > 0.5 ? orange : blue});
      d.add(Words{{108 + length, y + 5},
                  study_number(sigma) + " " + unit[static_cast<size_t>(k)],
                  {.size_px = 14, .colour = dark}});
    }
    y += 44;
  }
  d.height_px = y;
  return y < 40 ? ""
                : figure(d, "How well one round of scans fixes the pose",
                         "Deviation that is left in each direction, median along the path, on a logarithmic scale from "
                         "1e-4 of "
                         "what is known beforehand to all of it (fast.prior_m, fast.prior_deg); orange: hardly seen.");
}

}  // namespace adit
