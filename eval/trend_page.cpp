// SPDX-License-Identifier: BSD-3-Clause
#include "eval/trend_page.h"

#include "base/files.h"
#include "eval/drawing.h"
#include "eval/metric_list.h"
#include "eval/page_style.h"
#include "eval/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace adit {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double width_px = 720, height_px = 190, left_px = 64, right_px = 12, top_px = 12, bottom_px = 26;

const char* const trend_style = R"css(
.chart { margin: 0 0 1.4em; } .chart svg { overflow: visible; background: var(--panel); }
.chart h4 { margin: 0 0 .2em; font-size: .95rem; font-weight: 600; }
.chart text { fill: var(--faint); font-size: 11px; } .chart .band { fill: var(--link); opacity: .18; }
.chart .line { fill: none; stroke: var(--link); stroke-width: 1.8; } .chart .grid { stroke: var(--rule); }
.chart .break { stroke: var(--faint); stroke-dasharray: 4 3; } .chart circle { fill: var(--link); }
.chart circle.bad { fill: #d3362d; } .chart circle.good { fill: #1f9d55; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 460px), 1fr)); gap: 4px 24px; }
.tag { display: inline-block; border-radius: 5px; padding: 0 .5em; font-weight: 600; color: #fff; background: #5b606b; white-space: nowrap; }
.tag.bad { background: #c02a22; } .tag.good { background: #17773f; }
.pair img { width: 100%; border-radius: 8px; }
)css";

bool is_bad(const std::string& kind) {
  return kind == "regressed" || kind == "crept" || kind == "beyond" || kind == "failing";
}
std::string tone(const std::string& kind) {
  return is_bad(kind) ? "bad" : kind == "improved" || kind == "recovered" ? "good" : "";
}

using Group = std::pair<std::string, std::string>;  // scenario, method

std::vector<Group> groups_of(const std::vector<Night>& nights) {
  std::vector<Group> groups;
  for (auto n = nights.rbegin(); n != nights.rend(); ++n)
    for (const NightCell& c : n->cells)
      if (const Group g{c.scenario, c.method}; std::find(groups.begin(), groups.end(), g) == groups.end())
        groups.push_back(g);
  return groups;
}

std::map<int, const NightCell*> runs_of(const Night& night, const Group& g) {
  std::map<int, const NightCell*> runs;
  for (const NightCell& c : night.cells)
    if (Group{c.scenario, c.method} == g) runs[c.seed] = &c;
  return runs;
}

// Whether a group has runs in both nights that were held against different truths.
bool other_truth(const Night& a, const Night& b, const Group& g) {
  const auto then = runs_of(a, g);
  for (const auto& [seed, run] : runs_of(b, g)) {
    const auto other = then.find(seed);
    if (other != then.end() && !run->truth.empty() && !other->second->truth.empty() &&
        run->truth != other->second->truth)
      return true;
  }
  return false;
}

std::string subject(const Claim& c) {
  return c.scenario + ", " + c.method + (c.metric.empty() ? "" : ", " + c.metric);
}

// A metric over the nights.
struct Line {
  struct Point {
    size_t night;
    double median, low, high;
    std::string kind, run;
    bool begins;  // not comparable with the point before
  };
  std::vector<Point> point;
  bool claimed = false;
};

Line line_of(const std::vector<Night>& nights, const Group& g, const std::string& metric) {
  Line line;
  size_t last = 0;
  for (size_t k = 0; k < nights.size(); ++k) {
    std::vector<double> values;
    std::string run;
    for (const auto& [seed, cell] : runs_of(nights[k], g)) {
      const auto v = cell->value.find(metric);
      if (v == cell->value.end()) continue;
      values.push_back(v->second);
      if (run.empty()) run = cell->run;
    }
    if (values.empty()) continue;
    Line::Point p{k, quantile(values, 0.5), quantile(values, 0.25), quantile(values, 0.75), "", run, true};
    if (!line.point.empty())
      p.begins = nights[k].evaluator != nights[last].evaluator || other_truth(nights[last], nights[k], g);
    for (const Claim& c : nights[k].claims)
      if (c.scenario == g.first && c.method == g.second && c.metric == metric) p.kind = c.kind, line.claimed = true;
    line.point.push_back(p);
    last = k;
  }
  return line;
}

std::string at(double px) {
  char text[24];
  std::snprintf(text, sizeof text, "%.1f", px);
  return text;
}

// Where numbers and nights stand in a chart.
struct Axes {
  double low = 0, high = 1;
  size_t nights = 1;
  double x(size_t night) const {
    const double share = nights > 1 ? static_cast<double>(night) / static_cast<double>(nights - 1) : 0.5;
    return left_px + share * (width_px - left_px - right_px);
  }
  double y(double value) const { return top_px + (high - value) / (high - low) * (height_px - top_px - bottom_px); }
};

Axes axes_of(const Line& line, size_t nights) {
  Axes axes{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), nights};
  for (const Line::Point& p : line.point) axes.low = std::min(axes.low, p.low), axes.high = std::max(axes.high, p.high);
  const double room = axes.high > axes.low ? 0.08 * (axes.high - axes.low) : std::max(1e-9, 0.1 * std::abs(axes.high));
  axes.low -= room, axes.high += room;
  return axes;
}

// Line and band of the nights that may be compared with each other: [from, to).
std::string stretch_svg(const Line& line, size_t from, size_t to, const Axes& axes) {
  std::string middle, above, below;
  for (size_t k = from; k < to; ++k) {
    const Line::Point& p = line.point[k];
    const std::string x = at(axes.x(p.night)) + ",";
    middle += x + at(axes.y(p.median)) + " ";
    above += x + at(axes.y(p.high)) + " ";
    below = x + at(axes.y(p.low)) + " " + below;
  }
  return "<polygon class=\"band\" points=\"" + above + below + "\"/><polyline class=\"line\" points=\"" + middle +
         "\"/>";
}

std::string point_svg(const Line::Point& p, const Night& n, const Axes& axes) {
  const std::string words = "night " + std::to_string(n.id) + (n.date.empty() ? "" : ", " + n.date) +
                            (n.commit.empty() ? "" : ", " + n.commit.substr(0, 12)) + ": " + plain_number(p.median, 4) +
                            " (" + plain_number(p.low, 4) + " to " + plain_number(p.high, 4) + ")" +
                            (p.kind.empty() ? "" : ", " + p.kind);
  const std::string mark = "<circle class=\"" + tone(p.kind) + "\" cx=\"" + at(axes.x(p.night)) + "\" cy=\"" +
                           at(axes.y(p.median)) + "\" r=\"" + (p.kind.empty() ? "2.2" : "5") + "\"><title>" +
                           escaped(words) + "</title></circle>";
  return p.run.empty() ? mark : "<a href=\"" + escaped(p.run) + "\">" + mark + "</a>";
}

std::string chart_html(const std::string& metric, const Line& line, const std::vector<Night>& nights) {
  const Axes axes = axes_of(line, nights.size());
  std::string svg = "<svg viewBox=\"0 0 " + at(width_px) + " " + at(height_px) + "\" role=\"img\" aria-label=\"" +
                    escaped(metric) + " over the nights\">";
  for (const double share : {0.0, 0.5, 1.0}) {
    const double value = axes.low + share * (axes.high - axes.low);
    svg += "<line class=\"grid\" x1=\"" + at(left_px) + "\" x2=\"" + at(width_px - right_px) + "\" y1=\"" +
           at(axes.y(value)) + "\" y2=\"" + at(axes.y(value)) + "\"/><text x=\"" + at(left_px - 6) + "\" y=\"" +
           at(axes.y(value) + 4) + "\" text-anchor=\"end\">" + escaped(plain_number(value, 3)) + "</text>";
  }
  for (size_t k = 1; k < nights.size(); ++k)
    if (nights[k].machine != nights[k - 1].machine || nights[k].evaluator != nights[k - 1].evaluator)
      svg += "<line class=\"break\" x1=\"" + at(axes.x(k)) + "\" x2=\"" + at(axes.x(k)) + "\" y1=\"" + at(top_px) +
             "\" y2=\"" + at(height_px - bottom_px) + "\"><title>another " +
             (nights[k].evaluator != nights[k - 1].evaluator ? "evaluator" : "machine") + "</title></line>";
  for (size_t from = 0; from < line.point.size();) {
    size_t to = from + 1;
    while (to < line.point.size() && !line.point[to].begins) ++to;
    svg += stretch_svg(line, from, to, axes);
    from = to;
  }
  for (const Line::Point& p : line.point) svg += point_svg(p, nights[p.night], axes);
  for (const size_t k : std::set<size_t>{0, nights.size() - 1})
    svg += "<text x=\"" + at(axes.x(k)) + "\" y=\"" + at(height_px - 8) + "\" text-anchor=\"" +
           (k == 0 ? "start" : "end") + "\">" +
           escaped(nights[k].date.empty() ? "night " + std::to_string(nights[k].id) : nights[k].date) + "</text>";
  return "<div class=\"chart\"><h4><code>" + escaped(metric) + "</code></h4>" + svg + "</svg></div>\n";
}

std::string events_html(const TrendInput& in) {
  const std::vector<Event> events = story(in.nights);
  if (events.empty()) return "<p>Nothing happened: no metric moved for the worse or the better.</p>\n";
  std::string html =
      "<div class=\"scroll\"><table><thead><tr><th scope=\"col\">night</th><th scope=\"col\">commit</th><th "
      "scope=\"col\">what</th><th scope=\"col\"></th></tr></thead><tbody>\n";
  for (auto e = events.rbegin(); e != events.rend(); ++e) {
    const Night& n = in.nights[e->night];
    html += "<tr><td>" + std::to_string(n.id) + (n.date.empty() ? "" : "<br>" + escaped(n.date)) + "</td><td><code>" +
            escaped(n.commit.substr(0, 12)) + "</code></td><td><span class=\"tag " + tone(e->kind) + "\">" +
            escaped(e->kind) + "</span></td><td>" + escaped(e->words) + "</td></tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string pictures_html(const TrendInput& in) {
  std::string html;
  for (const BeforeAfter& p : in.pictures) {
    html += "<h3>" + escaped(subject(p.claim)) + ", seed " + std::to_string(p.seed) + "</h3>\n<p>" +
            escaped(p.claim.words) + "</p>\n<div class=\"pair\">\n";
    for (const auto& [name, file] : {std::pair<std::string, std::string>{"before", p.before}, {"after", p.after}})
      html += "<figure><h4>" + name + "</h4>" +
              (file.empty()
                   ? "<p class=\"missing\">Not kept.</p>"
                   : "<a href=\"" + escaped(p.report.empty() || name == "before" ? file : p.report) + "\"><img src=\"" +
                         escaped(file) + "\" alt=\"" + escaped(p.title + ", " + name) + "\"></a>") +
              "<figcaption>" + escaped(p.title) + "</figcaption></figure>\n";
    html += "</div>\n";
  }
  return html.empty() ? "" : "<section><h2 id=\"pictures\">What it looks like</h2>\n" + html + "</section>\n";
}

std::string charts_html(const TrendInput& in) {
  std::string html;
  for (const Group& g : groups_of(in.nights)) {
    std::string claimed, others;
    for (const std::string& metric : in.metrics) {
      const Line line = line_of(in.nights, g, metric);
      if (!line.point.empty()) (line.claimed ? claimed : others) += chart_html(metric, line, in.nights);
    }
    html += "<section><h2>" + escaped(g.first + ", " + g.second) + "</h2>\n";
    if (!claimed.empty()) html += "<div class=\"charts\">\n" + claimed + "</div>\n";
    if (!others.empty())
      html += "<details" + std::string(claimed.empty() ? " open" : "") +
              "><summary>metrics that never moved</summary><div class=\"charts\">\n" + others + "</div></details>\n";
    html += "</section>\n";
  }
  return html;
}

// Times and memory, by machine: they are never judged with the accuracy.
std::string speed_html(const TrendInput& in) {
  struct Cost {
    std::vector<double> seconds, gib;
  };
  std::map<std::pair<std::string, std::string>, std::vector<Cost>> costs;  // by machine and group, night after night
  for (const Night& n : in.nights)
    for (const Group& g : groups_of({n})) {
      Cost cost;
      for (const auto& [seed, run] : runs_of(n, g)) {
        if (std::isfinite(run->seconds)) cost.seconds.push_back(run->seconds);
        if (std::isfinite(run->peak_gib)) cost.gib.push_back(run->peak_gib);
      }
      if (!cost.seconds.empty()) costs[{n.machine + ", " + n.compiler, g.first + ", " + g.second}].push_back(cost);
    }
  if (costs.empty()) return "";
  std::string html =
      "<section><h2 id=\"speed\">Time and memory of a run</h2>\n<div class=\"scroll\"><table><thead><tr><th>machine"
      "</th><th>runs</th><th class=\"n\">nights</th><th class=\"n\">first night, s</th><th class=\"n\">last night, "
      "s</th>"
      "<th class=\"n\">first night, GiB</th><th class=\"n\">last night, GiB</th></tr></thead><tbody>\n";
  const auto median = [](std::vector<double> values) {
    return "<td class=\"n\">" + (values.empty() ? "–" : plain_number(quantile(values, 0.5), 3)) + "</td>";
  };
  for (const auto& [key, nights] : costs)
    html += "<tr><td>" + escaped(key.first) + "</td><td>" + escaped(key.second) + "</td><td class=\"n\">" +
            std::to_string(nights.size()) + "</td>" + median(nights.front().seconds) + median(nights.back().seconds) +
            median(nights.front().gib) + median(nights.back().gib) + "</tr>\n";
  return html + "</tbody></table></div></section>\n";
}

std::string verdict_words(const TrendInput& in) {
  if (in.nights.empty()) return "No night yet.";
  const Night& n = in.nights.back();
  std::map<std::string, int> kinds;
  for (const Claim& c : n.claims) ++kinds[c.kind];
  std::string words;
  for (const auto& [kind, count] : kinds) words += (words.empty() ? " (" : ", ") + std::to_string(count) + " " + kind;
  return "Night " + std::to_string(n.id) + (n.date.empty() ? "" : ", " + n.date) + ": " + n.verdict +
         (words.empty() ? "" : words + ")") + ".";
}

}  // namespace

std::vector<Event> story(const std::vector<Night>& nights) {
  std::vector<Event> events;
  std::map<std::string, std::string> standing;  // what is wrong, and how, by subject
  for (size_t k = 0; k < nights.size(); ++k) {
    const Night& n = nights[k];
    if (k > 0 && n.evaluator != nights[k - 1].evaluator)
      events.push_back(
          {k, "evaluator",
           "from " + nights[k - 1].evaluator + " to " + n.evaluator + ": what is before is not comparable"});
    if (k > 0 && n.machine + n.compiler != nights[k - 1].machine + nights[k - 1].compiler)
      events.push_back({k, "machine",
                        nights[k - 1].machine + ", " + nights[k - 1].compiler + " to " + n.machine + ", " + n.compiler +
                            ": times are not comparable"});
    if (k > 0)
      for (const Group& g : groups_of({n}))
        if (other_truth(nights[k - 1], n, g))
          events.push_back({k, "truth", g.first + ", " + g.second + ": what is before is not comparable"});
    std::set<std::string> now;
    for (const Claim& c : n.claims) {
      if (c.kind == "not comparable") continue;  // told above
      const std::string what = subject(c);
      if (is_bad(c.kind)) now.insert(what);
      if (is_bad(c.kind) && standing.contains(what)) continue;
      if (is_bad(c.kind)) standing[what] = c.kind;
      events.push_back({k, c.kind, what + ": " + c.words});
    }
    for (auto s = standing.begin(); s != standing.end();) {
      if (now.contains(s->first)) {
        ++s;
        continue;
      }
      events.push_back({k, "recovered", s->first + ": no longer " + s->second});
      s = standing.erase(s);
    }
    if (!n.accepted.empty()) {
      events.push_back({k, "accepted", n.accepted});
      standing.clear();
    }
  }
  return events;
}

void write_trend_page(const std::string& dir, const TrendInput& in) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>" +
      escaped(in.suite) + " – adit nightly</title>\n<style>" + page_style + trend_style +
      "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">Skip to the details</a>\n<header><h1>adit "
      "nightly: " +
      escaped(in.suite) + "</h1>\n<p class=\"verdict\">" + escaped(verdict_words(in)) + "</p>\n<p>" +
      escaped(in.about) + "</p></header>\n<main id=\"main\">\n";
  html += "<section><h2 id=\"story\">What happened</h2>\n" + events_html(in) + "</section>\n" + pictures_html(in);
  html += charts_html(in) + speed_html(in);
  html +=
      "</main>\n<footer>Lines: median over seeds; band: the middle half of the seeds; dashed: another evaluator or "
      "machine. Large marks: what a night said. Made by adit; one file, no network.</footer>\n</body>\n</html>\n";
  write_text(dir + "/index.html", html);
}

}  // namespace adit
