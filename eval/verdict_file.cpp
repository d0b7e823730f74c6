// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "eval/spread_json.h"
#include "eval/verdict.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

std::string short_number(double value, int digits = 4) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return std::isfinite(value) ? text : "–";
}

// For XML 1.0, which has no way to write most control characters.
std::string xml(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += code < 32 && c != '\n' && c != '\t' ? ' ' : c;
  }
  return out;
}

bool is_bad(const std::string& kind) {
  return kind == "regressed" || kind == "crept" || kind == "beyond" || kind == "failing";
}

std::string testcase(const std::string& suite, const std::string& scenario, const std::string& method,
                     const std::string& name, const std::string& kind, const std::string& words) {
  std::string out =
      "    <testcase classname=\"" + xml(suite + "." + scenario + "." + method) + "\" name=\"" + xml(name) + "\"";
  if (is_bad(kind)) return out + "><failure type=\"" + kind + "\" message=\"" + xml(words) + "\"/></testcase>\n";
  if (kind == "not comparable" || kind == "few" || kind == "new")
    return out + "><skipped message=\"" + xml(words.empty() ? kind : kind + ": " + words) + "\"/></testcase>\n";
  return out + "><system-out>" + xml(words) + "</system-out></testcase>\n";
}

// A cell of a Markdown table.
std::string cell(std::string text) {
  for (size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string headline(const Night& night, const Verdict& v) {
  const auto count = [&](const std::string& kind) {
    return std::count_if(v.claims.begin(), v.claims.end(), [&](const Claim& c) { return c.kind == kind; });
  };
  std::string words = night.suite + ": " + v.verdict;
  std::string parts;
  for (const char* kind : {"regressed", "crept", "beyond", "failing", "improved", "not comparable"})
    if (count(kind) > 0) parts += (parts.empty() ? "" : ", ") + std::to_string(count(kind)) + " " + kind;
  return parts.empty() ? words : words + " (" + parts + ")";
}

}  // namespace

void write_junit(const std::string& file, const Night& night, const Verdict& v) {
  std::string cases;
  size_t failures = 0, skipped = 0, count = 0;
  for (const Claim& c : v.claims) {
    if (!c.metric.empty()) continue;  // told by its own case below
    ++count, failures += is_bad(c.kind), skipped += c.kind == "not comparable";
    cases += testcase(night.suite, c.scenario, c.method, c.kind == "failing" ? "runs" : "comparison", c.kind, c.words);
  }
  for (const MetricVerdict& m : v.metric) {
    ++count, failures += is_bad(m.kind);
    skipped += m.kind == "not comparable" || m.kind == "few" || m.kind == "new";
    cases += testcase(night.suite, m.scenario, m.method, m.metric.name, m.kind,
                      m.words.empty() ? "value " + short_number(m.value) : m.words);
  }
  const std::string counts = "tests=\"" + std::to_string(count) + "\" failures=\"" + std::to_string(failures) +
                             "\" skipped=\"" + std::to_string(skipped) + "\"";
  write_text(file, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites " + counts + ">\n  <testsuite name=\"" +
                       xml(night.suite) + "\" " + counts + ">\n" + cases + "  </testsuite>\n</testsuites>\n");
}

void write_verdict_json(const std::string& file, const Night& night, const Verdict& v) {
  Json j{{"schema", 1},
         {"suite", night.suite},
         {"verdict", v.verdict},
         {"exit_code", v.exit_code},
         {"night", night.id},
         {"branch", night.branch},
         {"commit", night.commit},
         {"version", night.version},
         {"evaluator", night.evaluator},
         {"machine", night.machine},
         {"compiler", night.compiler},
         {"baseline", v.baseline},
         {"notes", v.notes}};
  j["claims"] = Json::array();
  for (const Claim& c : v.claims)
    j["claims"].push_back(
        {{"kind", c.kind}, {"scenario", c.scenario}, {"method", c.method}, {"metric", c.metric}, {"words", c.words}});
  j["metrics"] = Json::array();
  for (const MetricVerdict& m : v.metric)
    j["metrics"].push_back({{"scenario", m.scenario},
                            {"method", m.method},
                            {"metric", m.metric.name},
                            {"kind", m.kind},
                            {"runs", m.runs},
                            {"value", json_of<Json>(m.value)},
                            {"baseline", json_of<Json>(m.baseline)},
                            {"difference", json_of<Json>(m.difference)},
                            {"relevant", m.relevant},
                            {"p_holm", json_of<Json>(m.p_holm)},
                            {"p_creep", json_of<Json>(m.p_creep)},
                            {"worst_seed", m.worst_seed ? Json(*m.worst_seed) : Json(nullptr)},
                            {"words", m.words}});
  j["speed"] = Json::array();
  for (const SpeedVerdict& s : v.speed)
    j["speed"].push_back({{"scenario", s.scenario},
                          {"method", s.method},
                          {"seconds", json_of<Json>(s.seconds)},
                          {"baseline_s", json_of<Json>(s.baseline_s)},
                          {"ratio", json_of<Json>(s.ratio)},
                          {"peak_gib", json_of<Json>(s.peak_gib)},
                          {"baseline_gib", json_of<Json>(s.baseline_gib)},
                          {"memory_ratio", json_of<Json>(s.memory_ratio)}});
  write_text(file, j.dump(1) + "\n");
}

void write_verdict_md(const std::string& file, const Night& night, const Verdict& v) {
  std::string out = "### " + headline(night, v) + "\n\n";
  if (!night.commit.empty())
    out += "Commit " + night.commit + (night.branch.empty() ? "" : " on " + night.branch) + ". ";
  if (!v.baseline.empty()) out += "Compared with " + v.baseline + ".";
  out += "\n\n";
  if (!v.claims.empty()) {
    out += "| | scenario | method | metric | |\n|---|---|---|---|---|\n";
    for (const Claim& c : v.claims)
      out += "| **" + c.kind + "** | " + cell(c.scenario) + " | " + cell(c.method) + " | `" +
             (c.metric.empty() ? "-" : c.metric) + "` | " + cell(c.words) + " |\n";
    out += "\n";
  }
  for (const std::string& note : v.notes) out += note + "\n\n";
  out += "<details><summary>all " + std::to_string(v.metric.size()) +
         " metrics</summary>\n\n| scenario | method | metric | now | before | difference | "
         "|\n|---|---|---|---|---|---|---|\n";
  for (const MetricVerdict& m : v.metric)
    out += "| " + cell(m.scenario) + " | " + cell(m.method) + " | `" + m.metric.name + "` | " + short_number(m.value) +
           " | " + short_number(m.baseline) + " | " + short_number(m.difference.median, 3) + " | " + m.kind + " |\n";
  write_text(file, out + "\n</details>\n");
}

}  // namespace adit
