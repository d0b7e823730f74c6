// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "eval/compare.h"
#include "eval/spread_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

std::string short_number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::isfinite(value) ? text : "-";
}

std::string short_spread(const Spread& s) {
  std::string text = short_number(s.median);
  if (std::isfinite(s.low)) text += " [" + short_number(s.low) + ", " + short_number(s.high) + "]";
  return text;
}

std::string padded(std::string text, size_t width) {
  text.resize(std::max(width, text.size()), ' ');
  return text;
}

}  // namespace

std::string comparison_table(const Comparison& c, const std::vector<std::string>& names) {
  std::string out;
  for (size_t g = 0; g < c.group.size(); ++g) {
    const Comparison::Group& group = c.group[g];
    out += std::string(1, static_cast<char>('A' + g % 26)) + ": " + std::to_string(group.seed.size()) + " runs, " +
           std::to_string(group.failed.size()) + " failed";
    for (size_t k = 0; k < group.failed.size(); ++k)
      out += (k == 0 ? " (seed " : ", ") + std::to_string(group.failed[k]) + (k + 1 == group.failed.size() ? ")" : "");
    if (!group.label.empty()) out += "; " + group.label;
    out += "\n";
  }
  for (const std::string& name : names) {
    const auto m = std::find_if(c.metric.begin(), c.metric.end(), [&](const auto& x) { return x.name == name; });
    if (m == c.metric.end()) continue;
    out += "\n" + name + " (" + m->unit + ", " + better_name(m->better) + " is better)\n";
    for (size_t g = 0; g < m->group.size(); ++g) {
      const ComparedMetric::Group& group = m->group[g];
      out += "  " + std::string(1, static_cast<char>('A' + g % 26)) + "  " + padded(short_spread(group.value), 34);
      if (group.worst_seed) out += "worst: seed " + std::to_string(*group.worst_seed);
      if (g > 0 && group.difference.n > 0)
        out += "   minus A: " + short_spread(group.difference) + " over " + std::to_string(group.difference.n) +
               " seeds, p = " + short_number(group.p) +
               (group.p_holm ? " (Holm " + short_number(*group.p_holm) + ")" : "") + ", effect " +
               short_number(group.effect) + ": " + group.verdict;
      if (group.missing > 0) out += "   missing in " + std::to_string(group.missing);
      out += "\n";
    }
  }
  return out;
}

void write_comparison(const std::string& file, const Comparison& c) {
  Json j;
  j["schema"] = 2;
  j["groups"] = Json::array();
  for (const Comparison::Group& g : c.group)
    j["groups"].push_back({{"differs_by", g.label}, {"seeds", g.seed}, {"failed", g.failed}});
  j["metrics"] = Json::object();
  for (const ComparedMetric& m : c.metric) {
    Json groups = Json::array();
    for (size_t g = 0; g < m.group.size(); ++g) {
      Json one = json_of<Json>(m.group[g].value);
      one["mean"] = json_of<Json>(m.group[g].mean);
      one["missing"] = m.group[g].missing;
      one["worst_seed"] = m.group[g].worst_seed ? Json(*m.group[g].worst_seed) : Json(nullptr);
      if (g > 0) {
        one["difference"] = json_of<Json>(m.group[g].difference);
        one["effect"] = json_of<Json>(m.group[g].effect);
        one["p"] = m.group[g].p;
        one["p_holm"] = m.group[g].p_holm ? Json(*m.group[g].p_holm) : Json(nullptr);
        one["verdict"] = m.group[g].verdict;
      }
      groups.push_back(one);
    }
    j["metrics"][m.name] = {
        {"unit", m.unit}, {"better", better_name(m.better)}, {"relevant", m.relevant}, {"groups", groups}};
  }
  write_text(file, j.dump(1) + "\n");
}

}  // namespace adit
