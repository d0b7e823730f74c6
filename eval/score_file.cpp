// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/files.h"
#include "eval/score.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

constexpr int schema = 2;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
double number_of(const Json& j) {
  return j.is_null() ? none : j.get<double>();
}

Json* block(Json& root, const std::string& dotted) {
  Json* at = &root;
  for (size_t begin = 0;;) {
    const size_t dot = dotted.find('.', begin);
    at = &(*at)[dotted.substr(begin, dot == std::string::npos ? dot : dot - begin)];
    if (dot == std::string::npos) return at;
    begin = dot + 1;
  }
}

Json written(const Metric& m) {
  Json j{{"value", number(m.value)}, {"unit", m.unit}, {"better", better_name(m.better)}, {"n", m.n}};
  if (!m.why.empty()) j["why"] = m.why;
  return j;
}

bool is_metric(const Json& j) {
  return j.is_object() && j.contains("value") && j.contains("unit") && j.contains("better");
}

void read_metrics(const Json& j, const std::string& name, std::vector<Metric>& metrics) {
  if (is_metric(j)) {
    metrics.push_back({name, number_of(j["value"]), j["unit"], j["better"] == "higher" ? Better::higher : Better::lower,
                       j.value("n", 0), j.value("why", "")});
    return;
  }
  if (!j.is_object()) return;
  for (const auto& [key, value] : j.items()) read_metrics(value, name.empty() ? key : name + "." + key, metrics);
}

}  // namespace

void write_score(const std::string& file, const Score& score) {
  Json j;
  j["schema"] = schema;
  Json& meta = j["meta"] = Json::object();
  for (const auto& [key, value] : score.meta) meta[key] = value;
  j["notes"] = score.notes;
  for (const Metric& m : score.metrics) *block(j, m.name) = written(m);
  Json& passages = j["passages"] = Json::array();
  for (const PassageScore& p : score.passages)
    passages.push_back({{"passage", p.passage},
                        {"n", p.n},
                        {"bias_m", number(p.bias_m)},
                        {"mae_m", number(p.mae_m)},
                        {"p95_m", number(p.p95_m)},
                        {"observable_m3", number(p.observable_m3)},
                        {"mapped_m3", number(p.mapped_m3)}});
  Json& pillars = j["pillars"] = Json::array();
  for (const PillarScore& p : score.pillars)
    pillars.push_back({{"pillar", p.pillar}, {"true_m2", number(p.true_m2)}, {"found_m2", number(p.found_m2)}});
  Json& worst = j["worst"] = Json::array();
  for (const WorstPlace& w : score.worst)
    worst.push_back({{"x_m", w.p_W.x()},
                     {"y_m", w.p_W.y()},
                     {"z_m", w.p_W.z()},
                     {"passage", w.passage},
                     {"n", w.n},
                     {"bias_m", number(w.bias_m)},
                     {"mae_m", number(w.mae_m)}});
  write_text(file, j.dump(1) + "\n");
}

Score read_score(const std::string& file) {
  const std::string text = read_text(file);
  try {
    const Json j = Json::parse(text);
    if (!j.is_object() || j.value("schema", 0) != schema)
      throw Error(file + ": is no score of schema " + std::to_string(schema) + " (key 'schema')",
                  Fault::not_comparable);
    Score score;
    for (const auto& [key, value] : j.at("meta").items()) score.meta.emplace_back(key, value.get<std::string>());
    score.notes = j.at("notes").get<std::vector<std::string>>();
    read_metrics(j, "", score.metrics);
    for (const Json& p : j.at("passages"))
      score.passages.push_back({p.at("passage"), p.at("n"), number_of(p.at("bias_m")), number_of(p.at("mae_m")),
                                number_of(p.at("p95_m")), number_of(p.at("observable_m3")),
                                number_of(p.at("mapped_m3"))});
    for (const Json& p : j.at("pillars"))
      score.pillars.push_back({p.at("pillar"), number_of(p.at("true_m2")), number_of(p.at("found_m2"))});
    for (const Json& w : j.at("worst"))
      score.worst.push_back({Vec3(w.at("x_m"), w.at("y_m"), w.at("z_m")), w.at("passage"), w.at("n"),
                             number_of(w.at("bias_m")), number_of(w.at("mae_m"))});
    return score;
  } catch (const Json::exception& e) {
    throw Error(file + ": " + e.what());
  }
}

}  // namespace adit
