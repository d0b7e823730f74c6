// SPDX-License-Identifier: BSD-3-Clause
#include "eval/page.h"

#include "eval/page_style.h"

#include <algorithm>
#include <cmath>

namespace adit {

namespace {

std::string unit_words(const std::string& unit) {
  if (unit == "percent") return "%";
  if (unit == "m3") return "m³";
  if (unit == "m2") return "m²";
  if (unit == "deg") return "°";
  return unit;
}

std::string plate_html(const Plate& plate, bool big) {
  const Figure& f = plate.figure;
  std::string html = "<figure id=\"" + escaped(f.name) + "\">\n<h3>" + escaped(f.title) + "</h3>\n";
  if (!f.missing.empty()) return html + "<p class=\"missing\">Not shown: " + escaped(f.missing) + ".</p>\n</figure>\n";
  html += "<div class=\"plate" + std::string(big ? " big" : "") + (plate.narrow_svg.empty() ? "" : " has-narrow") +
          "\"" + (big ? " tabindex=\"0\" role=\"group\" aria-label=\"" + escaped(f.title) + "\"" : "") +
          "><div class=\"wide\">" + plate.svg + "</div>";
  if (!plate.narrow_svg.empty()) html += "<div class=\"narrow\">" + plate.narrow_svg + "</div>";
  return html + "</div>\n<figcaption>" + escaped(f.caption) + "</figcaption>\n</figure>\n";
}

std::string first_screen(const ReportInput& in, const Plate& hero, const std::vector<Chapter>& chapters) {
  std::string html = "<header class=\"first\"><div>\n<h1>adit report: " + escaped(in.name) +
                     "</h1>\n<p class=\"verdict\">" + escaped(verdict(in)) + "</p>\n<dl class=\"numbers\">\n";
  for (const KeyNumber& k : key_numbers(in))
    html += "<div><dt>" + escaped(k.label) + "</dt><dd><span class=\"value\">" + escaped(k.value) +
            " <span class=\"unit\">" + escaped(k.unit) + "</span></span> <span class=\"note\">" + escaped(k.note) +
            "</span></dd></div>\n";
  html += "</dl>\n<nav aria-label=\"Contents\">";
  for (const Chapter& c : chapters) html += "<a href=\"#" + c.id + "\">" + escaped(c.title) + "</a> ";
  html +=
      "<a href=\"#scores\">Scores</a> <a href=\"#settings\">Settings</a> <a href=\"#notes\">Notes</a></nav>\n</div>\n";
  return html + plate_html(hero, false) + "</header>\n";
}

std::string chapter_html(const Chapter& chapter) {
  using Columns = Chapter::Columns;
  std::string html = "<section aria-labelledby=\"" + chapter.id + "\"><h2 id=\"" + chapter.id + "\">" +
                     escaped(chapter.title) + "</h2>\n";
  const size_t n = chapter.plates.size();
  const size_t beside = chapter.columns == Columns::two           ? n
                        : chapter.columns == Columns::first_three ? std::min<size_t>(3, n)
                                                                  : 0;
  if (beside) html += chapter.columns == Columns::two ? "<div class=\"pair\">\n" : "<div class=\"trio\">\n";
  for (size_t k = 0; k < n; ++k) {
    html += plate_html(chapter.plates[k], k >= beside || chapter.columns == Columns::two);
    if (beside && k + 1 == beside) html += "</div>\n";
  }
  return html + "</section>\n";
}

std::string metric_row(const Metric& m, const std::string& group) {
  std::string value = plain_number(m.value, 4);
  if (!std::isfinite(m.value) && !m.why.empty()) value += " (" + m.why + ")";
  return "<tr><td><code>" + escaped(m.name.substr(std::min(m.name.size(), group.size() + 1))) +
         "</code></td><td class=\"n\">" + escaped(value) + "</td><td>" + escaped(unit_words(m.unit)) + "</td><td>" +
         (m.better == Better::lower ? "lower" : "higher") + "</td><td class=\"n\">" + std::to_string(m.n) +
         "</td></tr>\n";
}

// One table for each first word of the dotted names, in their order.
std::string score_tables(const Score& score) {
  if (score.metrics.empty()) return "<p class=\"missing\">The run was not scored.</p>\n";
  std::vector<std::string> groups;
  const auto group_of = [](const Metric& m) { return m.name.substr(0, m.name.find('.')); };
  for (const Metric& m : score.metrics)
    if (std::find(groups.begin(), groups.end(), group_of(m)) == groups.end()) groups.push_back(group_of(m));
  std::string html;
  for (const std::string& group : groups) {
    html += "<details open><summary>" + escaped(group) +
            "</summary><div class=\"scroll\"><table><thead><tr><th scope=\"col\">metric</th><th scope=\"col\" "
            "class=\"n\">value</th>"
            "<th scope=\"col\">unit</th><th scope=\"col\">better</th><th scope=\"col\" "
            "class=\"n\">n</th></tr></thead><tbody>\n";
    for (const Metric& m : score.metrics)
      if (group_of(m) == group) html += metric_row(m, group);
    html += "</tbody></table></div></details>\n";
  }
  return html;
}

std::string passage_table(const Score& score) {
  if (score.passages.empty()) return "";
  std::vector<PassageScore> rows = score.passages;
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
    return (std::isfinite(a.mae_m) ? a.mae_m : -1) > (std::isfinite(b.mae_m) ? b.mae_m : -1);
  });
  std::string html = "<details><summary>by passage, worst first (" + std::to_string(rows.size()) +
                     ")</summary><div class=\"scroll\"><table><thead><tr><th scope=\"col\">passage</th>"
                     "<th scope=\"col\" class=\"n\">mean error, m</th><th scope=\"col\" class=\"n\">mean distance, "
                     "m</th><th scope=\"col\" class=\"n\">95 % below, m</th>"
                     "<th scope=\"col\" class=\"n\">points</th></tr></thead><tbody>\n";
  for (const PassageScore& p : rows)
    html += "<tr><td>" + std::to_string(p.passage) + "</td><td class=\"n\">" + plain_number(p.bias_m) +
            "</td><td class=\"n\">" + plain_number(p.mae_m) + "</td><td class=\"n\">" + plain_number(p.p95_m) +
            "</td><td class=\"n\">" + std::to_string(p.n) + "</td></tr>\n";
  return html + "</tbody></table></div></details>\n";
}

std::string meta_table(const Score& score) {
  if (score.meta.empty()) return "";
  std::string html = "<details><summary>how it was scored</summary><div class=\"scroll\"><table><tbody>\n";
  for (const auto& [key, value] : score.meta)
    html += "<tr><th scope=\"row\">" + escaped(key) + "</th><td>" + escaped(value) + "</td></tr>\n";
  return html + "</tbody></table></div></details>\n";
}

std::string notes_html(const ReportInput& in, const Plate& hero, const std::vector<Chapter>& chapters) {
  std::vector<std::string> notes;
  for (const std::string& n : in.score.notes) notes.push_back("Score: " + n);
  for (const std::string& n : in.estimate.notes) notes.push_back("Map: " + n);
  for (const DegenerateStretch& d : in.estimate.degenerate)
    notes.push_back("Map: from " + plain_number(d.from_s, 4) + " s to " + plain_number(d.to_s, 4) +
                    " s the scans leave the way along the passage open (" + plain_number(d.sigma_m) + " m).");
  if (!hero.figure.missing.empty())
    notes.push_back("No picture “" + hero.figure.title + "”: " + hero.figure.missing + ".");
  for (const Chapter& c : chapters)
    for (const Plate& p : c.plates)
      if (!p.figure.missing.empty()) notes.push_back("No picture “" + p.figure.title + "”: " + p.figure.missing + ".");
  std::string html = "<h2 id=\"notes\">Notes</h2>\n<ul>\n";
  for (const std::string& n : notes) html += "<li>" + escaped(n) + "</li>\n";
  html +=
      "<li>Signed errors: distance of the map to the true surface, + where the map stands out into the true void, − "
      "where it lies in the true rock. "
      "All pictures share one range of colours; what lies beyond takes the colour of the end; dark grey has no true "
      "surface within 3 m.</li>\n"
      "<li>Pictures show the map laid on the truth by the best rigid fit of the paths (6 degrees of freedom), "
      "but for scan matching alone and the rounds, which begin in the true first pose.</li>\n";
  return html + "</ul>\n";
}

}  // namespace

std::string page_html(const ReportInput& in, const Plate& hero, const std::vector<Chapter>& chapters) {
  std::string html =
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
      "content=\"width=device-width, initial-scale=1\">\n<title>" +
      escaped(in.name) + " – adit report</title>\n<style>" + page_style +
      "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">Skip to the details</a>\n";
  html += first_screen(in, hero, chapters) + "<main id=\"main\">\n";
  for (const Chapter& c : chapters) html += chapter_html(c);
  html += "<section aria-labelledby=\"scores\"><h2 id=\"scores\">Scores</h2>\n" + score_tables(in.score) +
          passage_table(in.score) + meta_table(in.score) + "</section>\n";
  html +=
      "<section aria-labelledby=\"settings\"><h2 id=\"settings\">Settings</h2>\n<details><summary>the scenario, every "
      "setting written out</summary><pre tabindex=\"0\">" +
      escaped(in.scenario_toml) + "</pre></details></section>\n";
  html += "<section aria-labelledby=\"notes\">" + notes_html(in, hero, chapters) + "</section>\n</main>\n";
  return html +
         "<footer>Made by adit. This page is one file and needs no network; each picture lies beside it as "
         "PNG.</footer>\n</body>\n</html>\n";
}

}  // namespace adit
