// SPDX-License-Identifier: BSD-3-Clause
#include "eval/study_page.h"

#include "base/files.h"
#include "eval/drawing.h"
#include "eval/page_style.h"
#include "eval/study_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

std::string spread(const Spread& s) {
  return study_number(s.median) +
         (std::isfinite(s.low) ? " [" + study_number(s.low) + ", " + study_number(s.high) + "]" : "");
}

std::string cell(const std::string& text, bool right = false) {
  if (right) return "<td class=\"n\">" + escaped(text) + "</td>";
  // Else a table of many columns breaks it after every word.
  return "<td style=\"min-width:" + std::to_string(std::min<size_t>(text.size(), 28)) + "ch\">" + escaped(text) +
         "</td>";
}
// A column's head; those of numbers stand over them, at the right.
struct Column {
  std::string name;
  bool number = false;
};
std::string head(const std::vector<Column>& columns) {
  std::string html = "<div class=\"scroll\"><table><thead><tr>";
  for (const Column& c : columns)
    html +=
        std::string(c.number ? "<th class=\"n\" style=\"white-space:normal\" scope=\"col\">" : "<th scope=\"col\">") +
        escaped(c.name) + "</th>";
  return html + "</tr></thead><tbody>\n";
}
const char* const end_table = "</tbody></table></div>\n";

std::string points_table(const StudyPage& p) {
  const StudyTable& t = p.table;
  std::vector<Column> columns{{"no."}};
  for (const std::string& factor : t.factor) columns.push_back({factor});
  for (size_t o = 0; o < t.objective.size(); ++o) columns.push_back({objective_words(t, o), true});
  columns.insert(columns.end(), {{"failed", true}, {"on the front", true}, {"mean rank", true}});
  std::string html = head(columns);
  std::vector<size_t> order(t.point.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return p.answer.point[a].rank < p.answer.point[b].rank; });
  for (const size_t i : order) {
    const StudyAnswer::Point& point = p.answer.point[i];
    html += "<tr>" + cell(std::to_string(i + 1));
    for (const std::string& level : t.point[i].level) html += cell(level);
    for (const Spread& s : point.value) html += cell(spread(s), true);
    html += cell(point.failed ? std::to_string(point.failed) + " of " + std::to_string(point.runs) : "0", true) +
            cell(std::string(point.front ? "yes" : "no") +
                     (t.cell.empty() ? "" : ", " + study_number(100 * point.front_share) + " % of samples"),
                 true) +
            cell(study_number(point.rank), true) + "</tr>\n";
  }
  return html + end_table;
}

constexpr size_t most_levels_told = 12;

std::string effects_table(const StudyPage& p) {
  if (p.answer.effect.empty()) return "<p>Nothing was varied, or nothing was run.</p>\n";
  std::string html = head({{"factor"}, {"objective"}, {"share of the variance", true}, {"levels: median [95 %]"}});
  for (const StudyAnswer::Effect& e : p.answer.effect) {
    std::string levels;
    if (e.level.size() > most_levels_told)
      levels = std::to_string(e.level.size()) + " levels: the table of points has them";
    for (const StudyAnswer::Level& l : e.level)
      if (e.level.size() <= most_levels_told) levels += (levels.empty() ? "" : "; ") + l.name + ": " + spread(l.value);
    html += "<tr>" + cell(p.table.factor[e.factor]) + cell(p.table.objective[e.objective]) +
            cell(study_number(100 * e.share) + " %", true) + cell(levels) + "</tr>\n";
  }
  for (const StudyAnswer::Interaction& i : p.answer.interaction)
    html += "<tr>" + cell(p.table.factor[i.a] + " with " + p.table.factor[i.b]) + cell(p.table.objective[i.objective]) +
            cell(study_number(100 * i.share) + " %", true) + cell("interaction: beyond what each does alone") +
            "</tr>\n";
  return html + end_table;
}

std::string differences_table(const StudyPage& p) {
  const Comparison& c = p.answer.comparison;
  if (c.group.size() < 2) return "";
  std::string html = "<h3>Against the first point, seed by seed</h3>\n" + head({{"point"},
                                                                                {"metric"},
                                                                                {"median difference [95 %]", true},
                                                                                {"seeds", true},
                                                                                {"p (Holm)", true},
                                                                                {"verdict"}});
  for (size_t g = 1; g < std::min<size_t>(c.group.size(), 40); ++g)
    for (const ComparedMetric& m : c.metric) {
      const ComparedMetric::Group& group = m.group[g];
      html += "<tr>" + cell(c.group[g].label) + cell(m.name + ", " + m.unit) + cell(spread(group.difference), true) +
              cell(std::to_string(group.difference.n), true) +
              cell(study_number(group.p_holm.value_or(group.p)), true) + cell(group.verdict) + "</tr>\n";
    }
  return html + end_table;
}

std::string agreement_html(const StudyPage& p) {
  std::string html = head({{"fast"}, {"metric"}, {"points", true}, {"Spearman's rho [95 %]", true}});
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

std::string image(const RigWhy& why, size_t k) {
  return "<img style=\"width:100%;border-radius:8px\" alt=\"" + escaped(why.title) + "\" src=\"data:image/png;base64," +
         base64(encode_png(why.pictures[k].second)) + "\">";
}

std::string why_html(const StudyPage& p) {
  std::string html;
  for (const RigWhy& w : p.why) {
    html += "<h3>" + escaped(w.title) + "</h3>\n";
    if (w.score)
      html += "<p>At a usual place it is least sure of <b>" + escaped(blind_words(*w.score)) + "</b>; over the path " +
              study_number(100 * w.score->blind_left) +
              " % of the prior's deviation is left in the direction that it sees least" +
              (w.score->blind_left > 0.5 ? " – it is blind there" : "") + ". It meets " +
              study_number(100 * w.score->surface) + " % of the rock about the path and sees " +
              study_number(100 * w.score->volume) + " % of the void.</p>\n";
    html += "<div class=\"pair\">\n";
    for (size_t k = 0; k < w.pictures.size(); ++k) html += "<figure>" + image(w, k) + "</figure>\n";
    html += "</div>\n";
  }
  return html + blind_chart(p);
}

std::string verdict_of(const StudyPage& p) {
  const StudyAnswer& a = p.answer;
  if (!a.best) return "Nothing could be judged.";
  return "Best: " + words_of(p.table, *a.best) + ".";
}

std::string counts_of(const StudyPage& p) {
  size_t failed = 0;
  for (const StudyCell& c : p.table.cell) failed += !c.failure.empty();
  std::string text = std::to_string(p.table.point.size()) + " points, " + std::to_string(p.table.cell.size()) +
                     " runs" + (failed ? ", " + std::to_string(failed) + " failed" : "") + ".";
  if (p.answer.best && !p.table.cell.empty())
    text += " The best point is on the front in " + study_number(100 * p.answer.point[*p.answer.best].front_share) +
            " % of the samples of the seeds.";
  return text;
}

// What the best rig sees that the worst does not, from the true geometry.
std::string why_words(const FastScore& best, const FastScore& worst) {
  constexpr std::array<const char*, 6> names{"along", "across", "up", "roll", "pitch", "yaw"};
  std::vector<std::string> parts;
  const auto share = [&](const char* what, double a, double b) {
    if (std::abs(a - b) >= 0.02)
      parts.push_back("it sees " + study_number(100 * a) + " % of the " + what + " about the path, not " +
                      study_number(100 * b) + " %");
  };
  share("void", best.volume, worst.volume);
  share("rock", best.surface, worst.surface);
  Eigen::Index most = 0;
  for (Eigen::Index k = 1; k < 6; ++k)
    if (worst.left[k] / best.left[k] > worst.left[most] / best.left[most]) most = k;
  const auto at = static_cast<size_t>(most);
  const std::string unit = most < 3 ? " m" : " deg";
  if (worst.left[most] > 2 * best.left[most])
    parts.push_back("a round of its scans fixes " + std::string(names[at]) + " to " + study_number(best.sigma[most]) +
                    unit + ", not to " + study_number(worst.sigma[most]) + unit +
                    (worst.left[most] > 0.5 ? ", which is hardly seen at all" : ""));
  if (worst.hull - best.hull >= 0.02)
    parts.push_back(study_number(100 * best.hull) + " % of a laser's beams end on the vehicle, not " +
                    study_number(100 * worst.hull) + " %");
  if (parts.empty()) return "By geometry the two see much the same: the difference lies in what a mapper makes of it.";
  std::string words = "Why the best is better than the worst: ";
  for (size_t i = 0; i < parts.size(); ++i) words += (i ? "; " : "") + parts[i];
  return words + ".";
}

// Best, second and worst beside each other: the answer in a glance.
std::string answer_table(const StudyPage& p) {
  const StudyAnswer& a = p.answer;
  if (!a.best || a.best == a.worst) return "";
  std::vector<std::pair<std::string, size_t>> rows{{"best", *a.best}};
  std::optional<size_t> second;
  for (size_t i = 0; i < a.point.size(); ++i)
    if (i != *a.best && a.point[i].failed < std::max<size_t>(1, a.point[i].runs) &&
        (!second || a.point[i].rank < a.point[*second].rank))
      second = i;
  if (second && second != a.worst) rows.emplace_back("second", *second);
  rows.emplace_back("worst", *a.worst);
  std::vector<Column> columns{{""}, {"point"}};
  for (size_t o = 0; o < p.table.objective.size(); ++o) columns.push_back({objective_words(p.table, o), true});
  std::string html = head(columns);
  for (const auto& [word, i] : rows) {
    html += "<tr>" + cell(word) + cell(std::to_string(i + 1) + ": " + words_of(p.table, i));
    for (const Spread& s : a.point[i].value) html += cell(spread(s), true);
    html += "</tr>\n";
  }
  return html + end_table;
}

std::string answer_html(const StudyPage& p) {
  std::string html = answer_table(p);
  if (p.why.size() == 2 && p.why[0].score && p.why[1].score)
    html += "<p>" + escaped(why_words(*p.why[0].score, *p.why[1].score)) + "</p>\n";
  html += "<div class=\"pair\">\n";
  if (p.table.objective.size() > 1) html += front_chart(p, 0, 1);
  if (!p.why.empty() && !p.why[0].pictures.empty())
    html += "<figure><h3>The best rig and what it sees</h3>" + image(p.why[0], 0) + "</figure>\n";
  return html + "</div>\n";
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
      escaped(p.table.about.empty() ? "" : p.table.about + ". ") + escaped(counts_of(p)) +
      "</p>\n</header>\n<main id=\"main\">\n";
  html += "<section><h2>The answer</h2>\n" + answer_html(p) + "</section>\n";
  html += "<section><h2>Points</h2>\n" + points_table(p) + "</section>\n";
  html += "<section><h2>What each factor does</h2>\n" + effects_table(p) + differences_table(p) + "</section>\n";
  html += "<section><h2>Why</h2>\n" + why_html(p) + "</section>\n";
  html += "<section><h2>How well geometry alone foretells it</h2>\n" + agreement_chart(p) + agreement_html(p) +
          "</section>\n";
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
