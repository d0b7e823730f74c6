// SPDX-License-Identifier: BSD-3-Clause
#include "cli/suite.h"

#include "base/error.h"
#include "cli/cells.h"
#include "eval/explain.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <set>

namespace adit {
namespace {

Direction direction_of(const std::string& name) {
  if (name == "higher") return Direction::higher;
  if (name == "zero") return Direction::zero;
  return name == "steady" ? Direction::steady : Direction::lower;
}

SuiteMetric metric_of(const Document& table) {
  SuiteMetric m;
  std::string better = "lower";
  table.read({{"name", &m.name, "as 'adit list metrics' has it"},
              {"better", &better, "which way", {"lower", "higher", "zero", "steady"}},
              {"relevant", &m.relevant, "smallest difference that matters", 0, 1e12},
              {"relevant_percent", &m.relevant_percent, "the same, of the baseline", 0, 1e6},
              {"at_most", &m.at_most, "of every run"},
              {"at_least", &m.at_least, "of every run"}});
  m.better = direction_of(better);
  if (m.name.empty()) table.fail("name", "a [[metric]] needs a name");
  try {
    explain_metric(m.name);
  } catch (const Error& e) {
    table.fail("name", e.what());
  }
  return m;
}

// Scenarios beside the suite's file may be named by their path from there.
std::string beside(const std::string& scenario, const std::string& suite) {
  const std::filesystem::path path = std::filesystem::path(suite).parent_path() / scenario;
  return scenario.ends_with(".toml") && std::filesystem::exists(path) ? path.string() : scenario;
}

template <class T>
void demand_names(const Document& file, const std::string& kind, const std::vector<T>& all) {
  if (all.empty()) file.fail(kind, "a suite needs at least one [[" + kind + "]]");
  std::set<std::string> seen;
  for (const T& one : all)
    if (!seen.insert(one.name).second) file.fail(kind, "the name '" + one.name + "' is there twice");
}

}  // namespace

Fields suite_fields(Suite& s) {
  return {{"name", &s.name, "how the history calls it"},
          {"about", &s.about, "one sentence"},
          {"first_seed", &s.first_seed, "of every scenario", 0, 2147483647},
          {"seeds", &s.seeds, "how many, from the first on", 1, 100000},
          {"pictures", &s.pictures, "keep maps, to show a regression before and after"},
          {"alpha", &s.rules.alpha, "chance of a false alarm in a night of the whole suite", 1e-9, 0.5},
          {"test", &s.rules.test, "of paired seeds: by ranks or by means", {"wilcoxon", "sign_flip"}},
          {"baseline", &s.rules.baseline, "window, branch:NAME, commit:ID or night:ID"},
          {"window", &s.rules.window, "nights whose median is the baseline", 1, 1000},
          {"reach", &s.rules.reach, "nights over which creep is looked for", 2, 100000},
          {"failures", &s.rules.failures, "runs that may fail which did not before", 0, 100000}};
}

Suite load_suite(const std::string& name_or_file) {
  const Document file = Document::find("cli/suites", name_or_file);
  Suite s;
  s.name = std::filesystem::path(name_or_file).stem().string();
  file.read(suite_fields(s), {"scenario", "method", "metric"});
  for (const Document& table : file.tables("scenario")) {
    Suite::Part p;
    table.read({{"scenario", &p.scenario, "bundled, or a file"},
                {"name", &p.name, "how the history calls it"},
                {"first_seed", &p.first_seed, "of this one", 0, 2147483647},
                {"seeds", &p.seeds, "of this one", 1, 100000},
                {"set", &p.set, "settings, 'key=value'"}});
    if (p.scenario.empty()) table.fail("scenario", "a [[scenario]] needs the name of one");
    if (p.name.empty()) p.name = std::filesystem::path(p.scenario).stem().string();
    p.scenario = beside(p.scenario, name_or_file);
    try {
      load_scenario(p.scenario, p.set);
    } catch (const Error& e) {
      table.fail("scenario", e.what());
    }
    s.scenario.push_back(p);
  }
  for (const Document& table : file.tables("method")) {
    Suite::Method m;
    table.read({{"name", &m.name, "how the history calls it"}, {"set", &m.set, "settings, 'key=value'"}});
    s.method.push_back(m);
  }
  if (s.method.empty()) s.method.push_back({"adit", {}});
  for (const Document& table : file.tables("metric")) s.rules.metric.push_back(metric_of(table));
  demand_names(file, "scenario", s.scenario);
  demand_names(file, "method", s.method);
  demand_names(file, "metric", s.rules.metric);
  cells_of(s, {});  // settings that do not fit are said now
  return s;
}

std::vector<SuiteCell> cells_of(const Suite& suite, const std::vector<std::string>& assignments) {
  std::vector<SuiteCell> cells;
  for (const Suite::Part& part : suite.scenario)
    for (const Suite::Method& method : suite.method) {
      std::vector<std::string> all = part.set;
      all.insert(all.end(), method.set.begin(), method.set.end());
      all.insert(all.end(), assignments.begin(), assignments.end());
      Scenario run = load_scenario(part.scenario, all);
      const int first = part.first_seed > 0 ? part.first_seed : suite.first_seed,
                count = part.seeds > 0 ? part.seeds : suite.seeds;
      for (int k = 0; k < count; ++k) {
        run.seed = first + k;
        cells.push_back({part.name, method.name, run});
      }
    }
  return cells;
}

std::string evaluator_of(const std::vector<SuiteCell>& cells) {
  ScoreSettings defaults;
  std::set<std::string> others;
  for (const SuiteCell& c : cells) {
    ScoreSettings settings = c.run.score;
    if (const std::string text = to_toml(fields(settings)); text != to_toml(fields(defaults))) others.insert(text);
  }
  std::string words = "evaluator " + std::to_string(evaluator_version), all;
  for (const std::string& text : others) all += text;
  return others.empty() ? words : words + " with [score] " + digest(all);
}

}  // namespace adit
