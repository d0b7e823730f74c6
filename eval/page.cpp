// SPDX-License-Identifier: BSD-3-Clause
#include "eval/page.h"

#include "eval/page_script.h"
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

// Sections that the page's script fills; hidden where none runs.
struct LiveSection {
  const char *id, *title;
};
constexpr LiveSection live_sections[] = {
    {"along", "Along the path"}, {"view", "View in space"}, {"errors-live", "Errors of the map"}};

std::string live_html(const LiveSection& s) {
  const std::string id = s.id;
  return "<section id=\"" + id.substr(0, id.find('-')) + "-section\" aria-labelledby=\"" + id +
         "\" hidden>\n<h2 id=\"" + id + "\">" + s.title + "</h2>\n</section>\n";
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
  html += "</dl>\n";
  if (!in.missing.empty()) {
    html += "<div class=\"missing\" role=\"note\"><strong>Not all of the run is there.</strong><ul>";
    for (const std::string& m : in.missing) html += "<li>" + escaped(m) + "</li>";
    html += "</ul></div>\n";
  }
  html += "<nav aria-label=\"Contents\">";
  for (const LiveSection& s : live_sections)
    html += std::string("<a href=\"#") + s.id + "\" hidden>" + s.title + "</a> ";
  for (const Chapter& c : chapters) html += "<a href=\"#" + c.id + "\">" + escaped(c.title) + "</a> ";
  html +=
      "<a href=\"#passages\">Passages</a> <a href=\"#scores\">Scores</a> <a href=\"#settings\">Settings</a> <a "
      "href=\"#notes\">Notes</a></nav>\n</div>\n";
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

// A dotted name, which narrow screens may break after its dots and strokes.
std::string breakable(const std::string& name) {
  std::string html;
  for (const char c : name) {
    html += escaped(std::string(1, c));
    if (c == '.' || c == '_') html += "<wbr>";
  }
  return html;
}

std::string metric_row(const Metric& m, const std::string& group) {
  std::string value = plain_number(m.value, 4);
  if (!std::isfinite(m.value) && !m.why.empty()) value += " (" + m.why + ")";
  return "<tr><td><code>" + breakable(m.name.substr(std::min(m.name.size(), group.size() + 1))) +
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

std::string number_cell(double value, int digits = 3) {
  return "<td class=\"n\" data-v=\"" + (std::isfinite(value) ? std::to_string(value) : "") + "\">" +
         plain_number(value, digits) + "</td>";
}

std::string passage_row(const PassageScore& p, const World& world) {
  const auto k = static_cast<size_t>(p.passage);
  const double length = k < world.passages.size() ? world.passages[k].length_m : NAN;
  const double seen = p.observable_m3 > 0 ? p.observable_m3 : NAN, mapped = std::isfinite(seen) ? p.mapped_m3 : NAN;
  const std::string id = std::to_string(p.passage);
  return "<tr tabindex=\"0\" data-passage=\"" + id + "\"><td data-v=\"" + id + "\">" + id + "</td>" +
         number_cell(length) + number_cell(seen, 4) + number_cell(mapped, 4) +
         number_cell(100 * (mapped - seen) / seen) + number_cell(p.bias_m) + number_cell(p.mae_m) +
         number_cell(p.p95_m) + number_cell(static_cast<double>(p.n), 9) + "</tr>\n";
}

std::string passages_html(const ReportInput& in) {
  std::string html = "<section aria-labelledby=\"passages\"><h2 id=\"passages\">Passages</h2>\n";
  if (in.score.passages.empty())
    return html + "<p class=\"missing\">Not shown: there are no passages that the map was scored by.</p></section>\n";
  std::vector<PassageScore> rows = in.score.passages;
  std::stable_sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) {
    return (std::isfinite(a.mae_m) ? a.mae_m : -1) > (std::isfinite(b.mae_m) ? b.mae_m : -1);
  });
  html +=
      "<p class=\"about\">Worst first; a column's head sorts. A row shows its passage on the plan above. Volumes are "
      "those of the void that could be seen.</p>\n<div class=\"scroll tall\" tabindex=\"0\" role=\"group\" "
      "aria-label=\"Passages\"><table id=\"passages-table\" class=\"sortable\"><thead><tr>";
  for (const char* words : {"passage", "length, m", "true volume, m³", "mapped, m³", "error, %", "mean error, m",
                            "mean distance, m", "95 % below, m", "points"})
    html += std::string("<th scope=\"col\"") + (html.ends_with("<tr>") ? ">" : " class=\"n\">") + words + "</th>";
  html += "</tr></thead><tbody>\n";
  for (const PassageScore& p : rows) html += passage_row(p, in.world);
  return html + "</tbody></table></div></section>\n";
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

std::string page_head(const std::string& title) {
  return "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" "
         "content=\"width=device-width, initial-scale=1\">\n<meta http-equiv=\"Content-Security-Policy\" "
         "content=\"default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src '" +
         std::string(page_script_hash) + "'\">\n<title>" + escaped(title) + "</title>\n<style>" + page_style +
         "</style>\n</head>\n<body>\n";
}

std::string page_foot(const std::string& data) {
  const std::string given = data.empty() ? "" : "<script type=\"application/json\" id=\"data\">" + data + "</script>\n";
  return given + "<script>" + page_script + "</script>\n</body>\n</html>\n";
}

std::string page_html(const ReportInput& in, const Plate& hero, const std::vector<Chapter>& chapters,
                      const std::string& data) {
  std::string html =
      page_head(in.name + " – adit report") + "<a class=\"skip\" href=\"#main\">Skip to the details</a>\n";
  html += first_screen(in, hero, chapters) + "<main id=\"main\">\n";
  for (const LiveSection& s : live_sections) html += live_html(s);
  for (const Chapter& c : chapters) html += chapter_html(c);
  html += passages_html(in);
  html += "<section aria-labelledby=\"scores\"><h2 id=\"scores\">Scores</h2>\n" + score_tables(in.score) +
          meta_table(in.score) + "</section>\n";
  html +=
      "<section aria-labelledby=\"settings\"><h2 id=\"settings\">Settings</h2>\n<details><summary>the scenario, every "
      "setting written out</summary><pre tabindex=\"0\">" +
      escaped(in.scenario_toml) + "</pre></details></section>\n";
  html += "<section aria-labelledby=\"notes\">" + notes_html(in, hero, chapters) + "</section>\n</main>\n";
  html +=
      "<footer>Made by adit. This page is one file and needs no network; each picture lies beside it as "
      "PNG.</footer>\n";
  return html + page_foot(data);
}

}  // namespace adit
