// SPDX-License-Identifier: BSD-3-Clause
#include "eval/compare_page.h"

#include "eval/chart_axes.h"
#include "eval/outline.h"
#include "eval/ramp.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace adit {

namespace {

std::string letter(size_t group) {
  return group < 26 ? std::string(1, static_cast<char>('A' + group)) : "#" + std::to_string(group + 1);
}

// Group of each run: groups are told apart by their settings, in the order in which they appear.
std::vector<size_t> groups_of(const std::vector<ScoredRun>& runs) {
  std::vector<std::string> known;
  std::vector<size_t> group;
  for (const ScoredRun& run : runs) {
    const auto at = std::find(known.begin(), known.end(), run.settings);
    group.push_back(at - known.begin());
    if (at == known.end()) known.push_back(run.settings);
  }
  return group;
}

std::string span_words(const Spread& s, const std::string& of_none) {
  if (s.n == 0) return of_none;
  std::string words = plain_number(s.median);
  if (std::isfinite(s.low))
    words += " <span class=\"note\">" + plain_number(s.low) + " … " + plain_number(s.high) + "</span>";
  return words;
}

std::string cell(const std::string& html, double value, const std::string& kind = "n") {
  return "<td class=\"" + kind + "\" data-v=\"" + (std::isfinite(value) ? std::to_string(value) : "") + "\">" + html +
         "</td>";
}

std::string verdict_of(const Comparison& c, size_t g, const std::vector<std::string>& headline) {
  int better = 0, worse = 0, all = 0;
  for (const ComparedMetric& m : c.metric) {
    if (std::find(headline.begin(), headline.end(), m.name) == headline.end()) continue;
    ++all;
    better += m.group[g].verdict == "better";
    worse += m.group[g].verdict == "worse";
  }
  return letter(g) + " is better than A in " + std::to_string(better) + " of " + std::to_string(all) +
         " headline numbers and worse in " + std::to_string(worse) + ". ";
}

std::string groups_table(const SideBySide& all, const std::vector<std::string>& link_of) {
  std::string html =
      "<div class=\"scroll\"><table><thead><tr><th scope=\"col\">group</th><th scope=\"col\">what tells it from A"
      "</th><th scope=\"col\">runs</th><th scope=\"col\" class=\"n\">failed</th></tr></thead><tbody>\n";
  const std::vector<size_t> group = groups_of(all.runs);
  for (size_t g = 0; g < all.comparison.group.size(); ++g) {
    const auto& own = all.comparison.group[g];
    html += "<tr><th scope=\"row\">" + letter(g) + "</th><td><code>" +
            escaped(own.label.empty() ? "what the others are held against" : own.label) + "</code></td><td>";
    for (size_t r = 0; r < all.runs.size(); ++r) {
      if (group[r] != g) continue;
      const std::string words = escaped(all.runs[r].folder) + " (seed " + std::to_string(all.runs[r].seed) + ")";
      html += (link_of[r].empty() ? words : "<a href=\"" + escaped(link_of[r]) + "\">" + words + "</a>") + "<br>";
    }
    html += "</td><td class=\"n\">" + std::to_string(own.failed.size()) + "</td></tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

std::string metric_row(const ComparedMetric& m) {
  std::string html = "<tr><th scope=\"row\"><code>" + escaped(m.name) + "</code> <span class=\"note\">" +
                     escaped(m.unit) + ", " + (m.better == Better::lower ? "lower" : "higher") +
                     " is better</span></th>";
  for (size_t g = 0; g < m.group.size(); ++g) {
    const auto& own = m.group[g];
    html += cell(span_words(own.value, "–"), own.value.median);
    if (g == 0) continue;
    const double p = own.p_holm.value_or(own.p);
    html += cell(own.difference.n ? span_words(own.difference, "–") : "not paired", own.difference.median) +
            cell(own.difference.n ? plain_number(p, 2) : "–", own.difference.n ? p : NAN) + "<td class=\"verdict-" +
            escaped(own.verdict) + "\">" + escaped(own.verdict) + "</td>";
  }
  return html + "</tr>\n";
}

std::string metric_table(const Comparison& c, const std::vector<const ComparedMetric*>& metrics,
                         const std::string& name) {
  std::string html = "<div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"" + escaped(name) +
                     "\"><table class=\"sortable\"><thead><tr><th scope=\"col\">metric</th>";
  for (size_t g = 0; g < c.group.size(); ++g) {
    html += "<th scope=\"col\" class=\"n\">" + letter(g) + ", median</th>";
    if (g > 0)
      html += "<th scope=\"col\" class=\"n\">" + letter(g) +
              " − A</th><th scope=\"col\" class=\"n\">p</th><th "
              "scope=\"col\">verdict</th>";
  }
  html += "</tr></thead><tbody>\n";
  for (const ComparedMetric* m : metrics) html += metric_row(*m);
  return html + "</tbody></table></div>\n";
}

// A row of dots for each group, those of one seed joined.
Drawing dot_plot(const SideBySide& all, const ComparedMetric& metric, double width_px) {
  const std::vector<size_t> group = groups_of(all.runs);
  struct Dot {
    size_t group;
    int seed;
    double value;
  };
  std::vector<Dot> dots;
  double low = 1e300, high = -1e300;
  for (size_t r = 0; r < all.runs.size(); ++r) {
    const Metric* m = all.runs[r].score ? all.runs[r].score->find(metric.name) : nullptr;
    if (!m || !std::isfinite(m->value)) continue;
    dots.push_back({group[r], all.runs[r].seed, m->value});
    low = std::min(low, m->value);
    high = std::max(high, m->value);
  }
  Drawing drawing;
  const size_t groups = all.comparison.group.size();
  drawing.width_px = width_px;
  drawing.height_px = 2 * std::ceil((70.0 + 34.0 * static_cast<double>(groups)) / 2);
  const double left = 46, right = width_px - 30, top = 26, bottom = drawing.height_px - 48;
  const double margin = high > low ? 0.06 * (high - low) : high == 0 ? 1 : 0.1 * std::abs(high);
  low -= margin, high += margin;
  const auto x = [&](double v) { return left + (v - low) / (high - low) * (right - left); };
  const auto y = [&](size_t g) { return top + 34.0 * (static_cast<double>(g) + 0.5); };
  drawing.add(Area{{{{left, top}, {right, top}, {right, bottom}, {left, bottom}}}, ink::open});
  const double step = round_down_125((high - low) / 4);
  for (double v = step * std::ceil(low / step); v <= high; v += step) {
    drawing.add(Line{{{x(v), top}, {x(v), bottom}}, ink::rock, 1});
    drawing.add(
        Words{{x(v), bottom + 20}, plain_number(v), {.size_px = 14, .colour = ink::faint, .anchor = Anchor::middle}});
  }
  drawing.add(Words{{right, bottom + 40}, metric.unit, {.size_px = 14, .colour = ink::faint, .anchor = Anchor::end}});
  for (size_t g = 0; g < groups; ++g)
    drawing.add(Words{
        {left - 14, y(g) + 6}, letter(g), {.size_px = 17, .colour = ink::text, .anchor = Anchor::end, .bold = true}});
  for (const Dot& a : dots)
    for (const Dot& b : dots)
      if (b.seed == a.seed && b.group == a.group + 1)
        drawing.add(Line{{{x(a.value), y(a.group)}, {x(b.value), y(b.group)}}, ink::edge, 0.8});
  for (const Dot& d : dots)
    drawing.add(Disc{.centre = {x(d.value), y(d.group)},
                     .radius_px = 5,
                     .fill = d.group == 0 ? ink::map : ink::raw,
                     .rim = ink::white,
                     .rim_px = 1,
                     .title = letter(d.group) + ", seed " + std::to_string(d.seed) + ": " + plain_number(d.value, 4)});
  for (size_t g = 0; g < groups; ++g)
    if (const double m = metric.group[g].value.median; std::isfinite(m))
      drawing.add(Line{{{x(m), y(g) - 12}, {x(m), y(g) + 12}}, ink::text, 2.5});
  return drawing;
}

std::string dot_plots(const SideBySide& all, const std::vector<const ComparedMetric*>& metrics) {
  std::string html = "<div class=\"trio\">\n";
  for (const ComparedMetric* m : metrics) {
    if (std::all_of(m->group.begin(), m->group.end(), [](const auto& g) { return g.value.n == 0; })) continue;
    html += "<figure><h3><code>" + escaped(m->name) + "</code></h3>" +
            to_svg(dot_plot(all, *m, 560), "Values of " + m->name + " by group, a dot for each seed") + "</figure>\n";
  }
  return html + "</div>\n";
}

// Groups are told apart by colour and, along the line, by their letter.
Colour ink_of(size_t group) {
  constexpr std::array<std::uint32_t, 6> inks = {0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0x56b4e9, 0x6d6a65};
  return rgb(inks[group % inks.size()]);
}

struct Curve {
  const std::vector<double>*along_m, *value_m;
  size_t group;
};

// The errors of several paths in one chart, each with its letter at its greatest.
Drawing path_chart(const std::vector<Curve>& curves, const std::string& words) {
  Drawing drawing;
  drawing.width_px = 1200;
  drawing.height_px = 340;
  double end = 1e-3, bottom = 0, top = 1e-3;
  for (const Curve& c : curves) {
    end = std::max(end, c.along_m->back());
    for (const double v : *c.value_m) bottom = std::min(bottom, v), top = std::max(top, v);
  }
  const double margin = 0.08 * (top - bottom);
  const Axes axes{{0, bottom < 0 ? bottom - margin : 0}, {end, top + margin}, {76, 34}, {drawing.width_px - 106, 240}};
  add_axes(drawing, axes, "way driven, m", words);
  drawing.add(Line{{axes(0, 0), axes(end, 0)}, ink::faint, 1.5});
  for (const Curve& c : curves) {
    Line line{{}, ink_of(c.group), 2};
    for (size_t k = 0; k < c.along_m->size(); ++k) line.p.push_back(axes((*c.along_m)[k], (*c.value_m)[k]));
    line.p = simplified(line.p, 0.35);
    drawing.add(std::move(line));
  }
  for (const Curve& c : curves) {
    const auto far = std::max_element(c.value_m->begin(), c.value_m->end(),
                                      [](double a, double b) { return std::abs(a) < std::abs(b); });
    const Vec2 at = axes((*c.along_m)[far - c.value_m->begin()], *far);
    drawing.add(
        Words{at + Vec2(0, *far < 0 ? 18 : -5),
              letter(c.group),
              {.size_px = 18, .colour = ink_of(c.group), .anchor = Anchor::middle, .bold = true, .halo_px = 3}});
  }
  return drawing;
}

std::string paths_html(const SideBySide& all) {
  std::vector<Curve> plan, height;
  std::string legend;
  for (size_t g = 0; g < all.paths.size(); ++g) {
    const PathErrors& p = all.paths[g];
    if (p.along_m.size() < 2) continue;
    plan.push_back({&p.along_m, &p.plan_m, g});
    height.push_back({&p.along_m, &p.height_m, g});
    legend += (legend.empty() ? "" : ", ") + letter(g) + " (seed " + std::to_string(p.seed) + ")";
  }
  std::string html = "<section aria-labelledby=\"paths\"><h2 id=\"paths\">Errors of the paths</h2>\n";
  if (plan.empty())
    return html + "<p class=\"missing\">Not shown: no run's path could be scored again.</p></section>\n";
  html += "<p class=\"about\">Of one run of each group, laid over each other: " + legend +
          ". Each path is laid on its own truth by the best rigid fit.</p>\n";
  for (const auto& [curves, title] :
       {std::pair(&plan, "in plan, distance, m"), std::pair(&height, "in height, map − truth, m")})
    html += std::string("<figure><h3>Error ") + title + "</h3>" +
            to_svg(path_chart(*curves, title),
                   std::string("Chart of the paths' errors ") + title + ", along the way driven") +
            "</figure>\n";
  return html + "</section>\n";
}

}  // namespace

PathErrors path_errors(const Score& score, int seed) {
  PathErrors errors{seed, {}, {}, {}};
  for (const PoseError& p : score.poses) {
    errors.along_m.push_back(p.along_m);
    errors.plan_m.push_back(p.p_error_W.head<2>().norm());
    errors.height_m.push_back(p.p_error_W.z());
  }
  return errors;
}

std::vector<size_t> shown_runs(const std::vector<ScoredRun>& runs, const Comparison& comparison) {
  const std::vector<size_t> group = groups_of(runs);
  std::vector<std::vector<std::pair<int, size_t>>> of_group(comparison.group.size());  // seed, run
  for (size_t r = 0; r < runs.size(); ++r)
    if (runs[r].score) of_group[group[r]].emplace_back(runs[r].seed, r);
  for (auto& own : of_group) std::sort(own.begin(), own.end());
  std::optional<int> common;
  for (const auto& [seed, run] : of_group.empty() ? std::vector<std::pair<int, size_t>>{} : of_group[0]) {
    const int wanted = seed;
    const bool in_all = std::all_of(of_group.begin(), of_group.end(), [&](const auto& own) {
      return std::any_of(own.begin(), own.end(), [&](const auto& p) { return p.first == wanted; });
    });
    if (in_all && !common) common = wanted;
  }
  std::vector<size_t> shown;
  for (const auto& own : of_group) {
    size_t run = own.empty() ? runs.size() : own[0].second;  // runs.size(): the group has no run to show
    for (const auto& [seed, r] : own)
      if (common && seed == *common) run = r;
    shown.push_back(run);
  }
  return shown;
}

double common_range_m(const std::vector<ScoredRun>& runs) {
  std::vector<double> errors;
  for (const ScoredRun& run : runs)
    if (const Metric* m = run.score ? run.score->find("map.se3.p95_m") : nullptr) errors.push_back(1.3 * m->value);
  return round_range(errors, 1, 0.05, 2);
}

Plate plan_plate(const ReportInput& input, const ReportSettings& settings) {
  const Exhibit x = make_exhibit(input, settings);
  Plate plate{error_plan(x), {}, {}};
  for (auto& item : plate.figure.drawing.items)
    if (auto* mark = std::get_if<Disc>(&item)) mark->link.clear();  // the close-ups are not on this page
  if (plate.figure.missing.empty()) plate.svg = to_svg(plate.figure.drawing, plate.figure.alt);
  return plate;
}

std::string comparison_html(const SideBySide& all, const std::vector<std::string>& link_of) {
  const Comparison& c = all.comparison;
  std::vector<const ComparedMetric*> first, rest;
  for (const ComparedMetric& m : c.metric)
    (std::find(all.headline.begin(), all.headline.end(), m.name) != all.headline.end() ? first : rest).push_back(&m);
  std::string html = page_head("Runs side by side – adit report") +
                     "<a class=\"skip\" href=\"#main\">Skip to the details</a>\n<header><h1>adit report: " +
                     std::to_string(all.runs.size()) + " runs side by side</h1>\n<p class=\"verdict\">";
  for (size_t g = 1; g < c.group.size(); ++g) html += verdict_of(c, g, all.headline);
  if (c.group.size() == 1) html += "All runs have the same settings; they differ by their seeds alone.";
  html += "</p>\n" + groups_table(all, link_of) +
          "<nav aria-label=\"Contents\"><a href=\"#headline\">Headline numbers</a> <a href=\"#paths\">Errors of the "
          "paths</a> <a href=\"#plans\">Plans</a> <a "
          "href=\"#all\">All numbers</a></nav>\n</header>\n<main id=\"main\">\n";
  html +=
      "<section aria-labelledby=\"headline\"><h2 id=\"headline\">Headline numbers</h2>\n<p class=\"about\">Medians, "
      "with the interval that holds them with 95 % where there are runs enough. Differences are of pairs of runs of "
      "one seed; p is of no difference (headline numbers: corrected for each other by Holm). A group is better or "
      "worse where the difference matters and p is at most 0.05.</p>\n" +
      metric_table(c, first, "Headline numbers") + dot_plots(all, first) + "</section>\n";
  html += paths_html(all);
  html += "<section aria-labelledby=\"plans\"><h2 id=\"plans\">Plans</h2>\n<div class=\"pair\">\n";
  for (size_t g = 0; g < all.plans.size(); ++g) {
    const Plate& plate = all.plans[g];
    html +=
        "<figure><h3>" + letter(g) + "</h3>" +
        (plate.figure.missing.empty() ? plate.svg
                                      : "<p class=\"missing\">Not shown: " + escaped(plate.figure.missing) + ".</p>") +
        "<figcaption>" + escaped(plate.figure.caption) + "</figcaption></figure>\n";
  }
  html += "</div></section>\n<section aria-labelledby=\"all\"><h2 id=\"all\">All numbers</h2>\n<details><summary>the " +
          std::to_string(rest.size()) + " others</summary>" + metric_table(c, rest, "All numbers") +
          "</details></section>\n</main>\n<footer>Made by adit. This page is one file and needs no network.</footer>\n";
  return html + page_foot("");
}

}  // namespace adit
