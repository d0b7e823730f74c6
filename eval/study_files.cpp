// SPDX-License-Identifier: BSD-3-Clause
#include "base/files.h"
#include "base/sqlite.h"
#include "eval/spread_json.h"
#include "eval/study.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace adit {
namespace {

using Json = nlohmann::ordered_json;

Json levels_of(const StudyTable& t, size_t p) {
  Json levels = Json::object();
  for (size_t f = 0; f < t.factor.size(); ++f) levels[t.factor[f]] = t.point[p].level[f];
  return levels;
}

Json point_of(const StudyTable& t, const StudyAnswer& a, size_t p) {
  const StudyAnswer::Point& point = a.point[p];
  Json j{{"levels", levels_of(t, p)}, {"price", t.point[p].price}, {"mass_kg", t.point[p].mass_kg}};
  for (size_t f = 0; f < fast_columns().size(); ++f)
    j["fast"][fast_columns()[f].name] = json_of<Json>(t.point[p].fast[f]);
  for (size_t o = 0; o < t.objective.size(); ++o) j["objectives"][t.objective[o]] = json_of<Json>(point.value[o]);
  j["runs"] = point.runs, j["failed"] = point.failed;
  j["front"] = point.front, j["front_share"] = point.front_share, j["rank"] = point.rank;
  return j;
}

void write_json(const std::string& file, const StudyTable& t, const StudyAnswer& a) {
  Json j{{"schema", 1}, {"name", t.name}, {"about", t.about}, {"factors", t.factor}, {"objectives", t.objective}};
  j["points"] = j["effects"] = j["interactions"] = j["fast_against_full"] = Json::array();
  for (size_t p = 0; p < t.point.size(); ++p) j["points"].push_back(point_of(t, a, p));
  j["best"] = a.best ? Json(*a.best) : Json(nullptr);
  j["worst"] = a.worst ? Json(*a.worst) : Json(nullptr);
  for (const StudyAnswer::Effect& e : a.effect) {
    Json levels = Json::object();
    for (const StudyAnswer::Level& l : e.level) levels[l.name] = json_of<Json>(l.value);
    j["effects"].push_back({{"factor", t.factor[e.factor]},
                            {"objective", t.objective[e.objective]},
                            {"variance_share", json_of<Json>(e.share)},
                            {"levels", levels}});
  }
  for (const StudyAnswer::Interaction& i : a.interaction)
    j["interactions"].push_back({{"factors", {t.factor[i.a], t.factor[i.b]}},
                                 {"objective", t.objective[i.objective]},
                                 {"variance_share", json_of<Json>(i.share)}});
  for (const StudyAnswer::Agreement& g : a.agreement)
    j["fast_against_full"].push_back({{"fast", g.fast},
                                      {"metric", g.metric},
                                      {"n", g.n},
                                      {"spearman", json_of<Json>(g.rho)},
                                      {"low", json_of<Json>(g.low)},
                                      {"high", json_of<Json>(g.high)}});
  j["failures"] = Json::array();
  for (const StudyCell& c : t.cell)
    if (!c.failure.empty())
      j["failures"].push_back({{"cell", c.name}, {"point", c.point}, {"seed", c.seed}, {"why", c.failure}});
  j["notes"] = t.notes;
  write_text(file, j.dump(1) + "\n");
}

std::string in_csv(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string in_csv(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  return std::isfinite(value) ? text : "";
}

void write_csv(const std::string& file, const StudyTable& t) {
  std::string csv = "cell,point,seed,failure";
  for (const std::string& f : t.factor) csv += "," + in_csv(f);
  csv += ",price,mass_kg";
  for (const StudyColumn& c : fast_columns()) csv += "," + c.name;
  for (const StudyColumn& c : t.metric) csv += "," + c.name;
  csv += "\n";
  for (const StudyCell& c : t.cell) {
    const StudyPoint& p = t.point[c.point];
    csv += c.name + "," + std::to_string(c.point) + "," + std::to_string(c.seed) + "," + in_csv(c.failure);
    for (const std::string& level : p.level) csv += "," + in_csv(level);
    csv += "," + in_csv(p.price) + "," + in_csv(p.mass_kg);
    for (const double v : p.fast) csv += "," + in_csv(v);
    for (size_t m = 0; m < t.metric.size(); ++m) csv += "," + (c.failure.empty() ? in_csv(c.value[m]) : "");
    csv += "\n";
  }
  write_text(file, csv);
}

void write_sqlite(const std::string& file, const StudyTable& t) {
  Sqlite base(file);
  base.exec(
      "PRAGMA journal_mode = OFF; BEGIN;"
      "CREATE TABLE points(point INTEGER PRIMARY KEY, price REAL, mass_kg REAL);"
      "CREATE TABLE levels(point INTEGER, factor TEXT, level TEXT, PRIMARY KEY(point, factor)) WITHOUT ROWID;"
      "CREATE TABLE fast(point INTEGER, name TEXT, value REAL, PRIMARY KEY(point, name)) WITHOUT ROWID;"
      "CREATE TABLE metrics(metric INTEGER PRIMARY KEY, name TEXT UNIQUE, unit TEXT, better TEXT);"
      "CREATE TABLE cells(cell TEXT PRIMARY KEY, point INTEGER, seed INTEGER, failure TEXT) WITHOUT ROWID;"
      "CREATE TABLE numbers(cell TEXT, metric INTEGER, value REAL, PRIMARY KEY(cell, metric)) WITHOUT ROWID;"
      "CREATE TABLE seconds(cell TEXT PRIMARY KEY, seconds REAL) WITHOUT ROWID;");
  SqliteStatement point = base.prepare("INSERT INTO points VALUES(?, ?, ?)");
  SqliteStatement level = base.prepare("INSERT INTO levels VALUES(?, ?, ?)");
  SqliteStatement fast = base.prepare("INSERT INTO fast VALUES(?, ?, ?)");
  for (size_t p = 0; p < t.point.size(); ++p) {
    const auto id = static_cast<std::int64_t>(p);
    point.bind(0, id).bind(1, t.point[p].price).bind(2, t.point[p].mass_kg).step();
    for (size_t f = 0; f < t.factor.size(); ++f)
      level.bind(0, id).bind(1, t.factor[f]).bind(2, t.point[p].level[f]).step();
    for (size_t f = 0; f < fast_columns().size(); ++f)
      fast.bind(0, id).bind(1, fast_columns()[f].name).bind(2, t.point[p].fast[f]).step();
  }
  SqliteStatement metric = base.prepare("INSERT INTO metrics VALUES(?, ?, ?, ?)");
  for (size_t m = 0; m < t.metric.size(); ++m)
    metric.bind(0, static_cast<std::int64_t>(m))
        .bind(1, t.metric[m].name)
        .bind(2, t.metric[m].unit)
        .bind(3, better_name(t.metric[m].better))
        .step();
  // Two points may come to one run; it stands once.
  SqliteStatement cell = base.prepare("INSERT OR IGNORE INTO cells VALUES(?, ?, ?, NULLIF(?, ''))");
  SqliteStatement value = base.prepare("INSERT OR IGNORE INTO numbers VALUES(?, ?, ?)");
  SqliteStatement seconds = base.prepare("INSERT OR IGNORE INTO seconds VALUES(?, ?)");
  for (const StudyCell& c : t.cell) {
    cell.bind(0, c.name).bind(1, static_cast<std::int64_t>(c.point)).bind(2, std::int64_t{c.seed}).bind(3, c.failure);
    cell.step();
    seconds.bind(0, c.name).bind(1, c.seconds).step();
    for (size_t m = 0; c.failure.empty() && m < t.metric.size(); ++m)
      value.bind(0, c.name).bind(1, static_cast<std::int64_t>(m)).bind(2, c.value[m]).step();
  }
  base.exec("COMMIT;");
}

}  // namespace

void write_study(const std::string& dir, const StudyTable& table, const StudyAnswer& answer) {
  write_json(dir + "/study.json", table, answer);
  write_comparison(dir + "/comparison.json", answer.comparison);
  write_csv(dir + "/cells.csv", table);
  write_whole(dir + "/study.sqlite", [&](const std::string& temporary) {
    std::filesystem::remove(temporary);
    write_sqlite(temporary, table);
  });
}

}  // namespace adit
