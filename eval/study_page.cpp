// SPDX-License-Identifier: BSD-3-Clause
#include "eval/study_page.h"

#include "base/files.h"
#include "eval/drawing.h"
#include "eval/page_style.h"
#include "eval/ramp.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

const Colour dark = rgb(0x1b1d22), faint = rgb(0x5b606b), rule = rgb(0xd9dce2), blue = rgb(0x0072b2),
             orange = rgb(0xd55e00), grey = rgb(0x9aa0aa);

std::string number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", v);
  return std::isfinite(v) ? text : "–";
}

std::string spread(const Spread& s) {
  return number(s.median) + (std::isfinite(s.low) ? " [" + number(s.low) + ", " + number(s.high) + "]" : "");
}

std::string cell(const std::string& text, bool right = false) {
  return (right ? "<td class=\"n\">" : "<td>") + escaped(text) + "</td>";
}
std::string head(const std::vector<std::string>& names) {
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  for (const std::string& n : names) html += "<th scope=\"col\">" + escaped(n) + "</th>";
  return html + "</tr></thead><tbody>\n";
}
const char* const end_table = "</tbody></table></div>\n";

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
      drawing.add(Words{at(v, y.low) + Vec2(0, 22), number(v), type});
    }
    for (double v = dy * std::ceil(y.low / dy); v <= y.high; v += dy) {
      drawing.add(Line{{at(x.low, v), at(x.high, v)}, rule, 1});
      drawing.add(Words{at(x.low, v) + Vec2(-8, 5), number(v), right});
    }
    drawing.add(Words{{corner.x() + size.x(), corner.y() + size.y() + 46}, x_words, right});
    drawing.add(Words{{corner.x() - 70, 20}, y_words, left});
  }
  Vec2 at(double vx, double vy) const { return corner + Vec2(x.at(vx) * size.x(), (1 - y.at(vy)) * size.y()); }
};

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

std::string points_table(const StudyPage& p) {
  const StudyTable& t = p.table;
  std::vector<std::string> names{"no."};
  names.insert(names.end(), t.factor.begin(), t.factor.end());
  for (size_t o = 0; o < t.objective.size(); ++o) names.push_back(objective_words(t, o));
  names.insert(names.end(), {"failed", "on the front", "mean rank"});
  std::string html = head(names);
  std::vector<size_t> order(t.point.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return p.answer.point[a].rank < p.answer.point[b].rank; });
  for (const size_t i : order) {
    const StudyAnswer::Point& point = p.answer.point[i];
    html += "<tr>" + cell(std::to_string(i + 1));
    for (const std::string& level : t.point[i].level) html += cell(level);
    for (const Spread& s : point.value) html += cell(spread(s), true);
    html +=
        cell(point.failed ? std::to_string(point.failed) + " of " + std::to_string(point.runs) : "0", true) +
        cell(std::string(point.front ? "yes" : "no") + ", " + number(100 * point.front_share) + " % of samples", true) +
        cell(number(point.rank), true) + "</tr>\n";
  }
  return html + end_table;
}

std::string effects_table(const StudyPage& p) {
  if (p.answer.effect.empty()) return "<p>Nothing was varied, or nothing was run.</p>\n";
  std::string html = head({"factor", "objective", "share of the variance", "levels: median [95 %]"});
  for (const StudyAnswer::Effect& e : p.answer.effect) {
    std::string levels;
    for (const StudyAnswer::Level& l : e.level)
      levels += (levels.empty() ? "" : "; ") + l.name + ": " + spread(l.value);
    html += "<tr>" + cell(p.table.factor[e.factor]) + cell(p.table.objective[e.objective]) +
            cell(number(100 * e.share) + " %", true) + cell(levels) + "</tr>\n";
  }
  for (const StudyAnswer::Interaction& i : p.answer.interaction)
    html += "<tr>" + cell(p.table.factor[i.a] + " with " + p.table.factor[i.b]) + cell(p.table.objective[i.objective]) +
            cell(number(100 * i.share) + " %", true) + cell("interaction: beyond what each does alone") + "</tr>\n";
  return html + end_table;
}

std::string differences_table(const StudyPage& p) {
  const Comparison& c = p.answer.comparison;
  if (c.group.size() < 2) return "";
  std::string html = "<h3>Against the first point, seed by seed</h3>\n" +
                     head({"point", "metric", "median difference [95 %]", "seeds", "p (Holm)", "verdict"});
  for (size_t g = 1; g < std::min<size_t>(c.group.size(), 40); ++g)
    for (const ComparedMetric& m : c.metric) {
      const ComparedMetric::Group& group = m.group[g];
      html += "<tr>" + cell(c.group[g].label) + cell(m.name + ", " + m.unit) + cell(spread(group.difference), true) +
              cell(std::to_string(group.difference.n), true) + cell(number(group.p_holm.value_or(group.p)), true) +
              cell(group.verdict) + "</tr>\n";
    }
  return html + end_table;
}

std::string agreement_html(const StudyPage& p) {
  std::string html = head({"fast", "metric", "points", "Spearman's rho [95 %]"});
  std::vector<StudyAnswer::Agreement> all;
  for (const StudyAnswer::Agreement& a : p.answer.agreement)
    if (std::isfinite(a.rho)) all.push_back(a);
  if (all.empty()) return "<p>Not said: it takes four points or more that were both judged by geometry and run.</p>\n";
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) {
    return a.metric != b.metric ? a.metric < b.metric : a.rho > b.rho;
  });
  for (const StudyAnswer::Agreement& a : all)
    html += "<tr>" + cell(a.fast) + cell(a.metric) + cell(std::to_string(a.n), true) +
            cell(spread({static_cast<std::int64_t>(a.n), a.rho, a.low, a.high}), true) + "</tr>\n";
  return html + end_table;
}

// The scatter of the fast value against the first objective that is a metric.
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

// What is left of the prior's deviation in each direction, as bars: full = blind.
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
      d.add(Words{
          {108 + length, y + 5}, number(sigma) + " " + unit[static_cast<size_t>(k)], {.size_px = 14, .colour = dark}});
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

std::string why_html(const StudyPage& p) {
  std::string html;
  for (const RigWhy& w : p.why) {
    html += "<h3>" + escaped(w.title) + "</h3>\n";
    if (w.score)
      html += "<p>It is least sure of <b>" + escaped(blind_words(*w.score)) +
              "</b>: " + number(100 * w.score->blind_left) + " % of the prior's deviation is left there" +
              (w.score->blind_left > 0.5 ? " – it is blind there" : "") + ". It meets " +
              number(100 * w.score->surface) + " % of the rock about the path and sees " +
              number(100 * w.score->volume) + " % of the void.</p>\n";
    html += "<div class=\"pair\">\n";
    for (const auto& [name, picture] : w.pictures)
      html += "<figure><img style=\"width:100%;border-radius:8px\" alt=\"" + escaped(w.title) +
              "\" src=\"data:image/png;base64," + base64(encode_png(picture)) + "\"></figure>\n";
    html += "</div>\n";
  }
  return html + blind_chart(p);
}

std::string verdict_of(const StudyPage& p) {
  const StudyAnswer& a = p.answer;
  size_t failed = 0;
  for (const StudyCell& c : p.table.cell) failed += !c.failure.empty();
  std::string text = std::to_string(p.table.point.size()) + " points, " + std::to_string(p.table.cell.size()) +
                     " runs" + (failed ? ", " + std::to_string(failed) + " failed" : "") + ". ";
  if (!a.best) return text + "Nothing could be judged.";
  text += "Best: " + words_of(p.table, *a.best);
  for (size_t o = 0; o < p.table.objective.size(); ++o)
    text += (o ? ", " : " – ") + objective_words(p.table, o) + " " + spread(a.point[*a.best].value[o]);
  return text + ". Worst: " + words_of(p.table, *a.worst) + ".";
}

std::string notes_html(const StudyPage& p) {
  std::string html = "<ul>\n";
  for (const std::string& n : p.table.notes) html += "<li>" + escaped(n) + "</li>\n";
  for (const StudyCell& c : p.table.cell)
    if (!c.failure.empty())
      html += "<li>Failed: " + escaped(words_of(p.table, c.point)) + ", seed " + std::to_string(c.seed) + ": " +
              escaped(c.failure) + "</li>\n";
  return html +
         "<li>The best point is the one of the front with the lowest mean rank over the objectives and the share of "
         "failures. Shares of variance are of the runs' values with each seed's mean taken off. Intervals are "
         "bootstrap "
         "percentiles; all points share their seeds, so they share their mines.</li>\n</ul>\n";
}

}  // namespace

std::string words_of(const StudyTable& table, size_t point) {
  std::string words;
  for (size_t f = 0; f < table.factor.size(); ++f)
    words += (f ? ", " : "") + table.factor[f] + " " + table.point[point].level[f];
  return words.empty() ? "the scenario as it is" : words;
}

void write_study_page(const std::string& dir, const StudyPage& p) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>" +
      escaped(p.table.name) + " – adit study</title>\n<style>" + page_style +
      "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">Skip to the details</a>\n<header>\n<h1>adit "
      "study: " +
      escaped(p.table.name) + "</h1>\n<p class=\"verdict\">" + escaped(verdict_of(p)) + "</p>\n<p>" +
      escaped(p.table.about) + "</p>\n</header>\n<main id=\"main\">\n";
  if (p.table.objective.size() > 1)
    html += "<div class=\"pair\">" + front_chart(p, 0, 1) + agreement_chart(p) + "</div>\n";
  html += "<section><h2>Points</h2>\n" + points_table(p) + "</section>\n";
  html += "<section><h2>What each factor does</h2>\n" + effects_table(p) + differences_table(p) + "</section>\n";
  html += "<section><h2>Why</h2>\n" + why_html(p) + "</section>\n";
  html += "<section><h2>How well geometry alone foretells it</h2>\n" + agreement_html(p) + "</section>\n";
  if (!p.recommended_toml.empty())
    html += "<section><h2>The recommended rig</h2>\n<pre tabindex=\"0\">" + escaped(p.recommended_toml) +
            "</pre></section>\n";
  html += "<section><h2>Notes</h2>\n" + notes_html(p) +
          "</section>\n<section><h2>The study</h2>\n<details><summary>every "
          "setting written out</summary><pre tabindex=\"0\">" +
          escaped(p.study_toml) +
          "</pre></details></section>\n</main>\n<footer>Made by adit. All runs: cells.csv and "
          "study.sqlite beside this page.</footer>\n</body>\n</html>\n";
  for (const RigWhy& w : p.why)
    for (const auto& [name, picture] : w.pictures) write_png(dir + "/" + name + ".png", picture);
  write_text(dir + "/index.html", html);
}

}  // namespace adit
