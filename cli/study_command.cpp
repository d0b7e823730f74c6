// SPDX-License-Identifier: BSD-3-Clause
#include "cli/study_command.h"

#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "cli/cells.h"
#include "cli/rig_command.h"
#include "cli/study_fast.h"
#include "cli/study_file.h"
#include "eval/study_page.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double guessed_cell_s = 20;  // of `mini` on one core, where no cell tells

// A study laid out: what is to be run and what geometry says of it.
struct Plan {
  Study study;
  std::vector<DesignPoint> point;
  std::vector<std::string> factor;
  std::vector<FastResult> fast;
  std::vector<std::string> notes;
};

std::string duration(double s) {
  char text[48];
  if (s < 120)
    std::snprintf(text, sizeof text, "%.0f s", s);
  else if (s < 7200)
    std::snprintf(text, sizeof text, "%.0f min", s / 60);
  else if (s < 2 * 86400)
    std::snprintf(text, sizeof text, "%.1f hours", s / 3600);
  else
    std::snprintf(text, sizeof text, "%.0f days", s / 86400);
  return text;
}

// What a cell took so far, mean over some of those that are there.
double seconds_a_cell(const std::string& cells) {
  double sum = 0, n = 0;
  std::error_code failed;
  for (const fs::directory_entry& entry : fs::directory_iterator(cells, failed)) {
    if (entry.path().filename().string().starts_with(".") || n == 100) continue;
    if (const auto cell = load_cell(cells, entry.path().filename().string())) sum += cell->seconds, n += 1;
  }
  return n > 0 ? sum / n : guessed_cell_s;
}

void demand_possible(const Study& study, double cells, const std::string& dir) {
  if (cells <= study.cells_max) return;
  char number[32];
  std::snprintf(number, sizeof number, "%.4g", cells);
  throw Error("the study asks for " + std::string(number) + " cells, some " +
              duration(cells * seconds_a_cell(dir) / threads()) + " on " + std::to_string(threads()) +
              " threads; it may have cells_max = " + std::to_string(study.cells_max) +
              "; a sample of the factors (sample = \"sobol\", samples = N) has fewer");
}

// Crosses the points with placements; the rig as given stays as the first of them.
void add_placements(Plan& plan, const std::string& out, Console& console) {
  const Scenario first = scenario_at(plan.study, plan.point.front(), plan.study.seeds.front());
  const Placements found = find_placements(plan.study, first, out + "/fast", console.progress());
  plan.notes.push_back("Placements: " + found.words + ".");
  std::vector<DesignPoint> crossed;
  for (const DesignPoint& p : plan.point)
    for (size_t i = 0; i <= found.mounts.size(); ++i) {
      DesignPoint q = p;
      q.level.push_back(i == 0 ? "rig as given" : found.label[i - 1]);
      if (i > 0) q.mounts.insert(q.mounts.end(), found.mounts[i - 1].begin(), found.mounts[i - 1].end());
      crossed.push_back(std::move(q));
    }
  plan.factor.push_back("placement");
  plan.point = std::move(crossed);
}

RigText rig_text(const Scenario& s) {
  RigText rig = read_rig(s.sensors.rig);
  change_rig(rig, s.sensors.mounts);
  return rig;
}

// Leaves out what the limits exclude. Error where nothing is left.
void limit(Plan& plan) {
  std::map<std::string, size_t> why;
  std::vector<DesignPoint> left;
  for (const DesignPoint& p : plan.point) {
    const Scenario s = scenario_at(plan.study, p, plan.study.seeds.front());
    const std::string reason = excluded(plan.study, rig_text(s), load_vehicle(s.vehicle).hull);
    if (reason.empty())
      left.push_back(p);
    else
      ++why[reason];
  }
  std::string words;
  for (const auto& [reason, n] : why) words += (words.empty() ? "" : ", ") + std::to_string(n) + " for " + reason;
  if (left.empty())
    throw Error("the study's limits exclude all " + std::to_string(plan.point.size()) + " points: " + words);
  if (!words.empty())
    plan.notes.push_back("Limits exclude " + std::to_string(plan.point.size() - left.size()) + " of " +
                         std::to_string(plan.point.size()) + " points: " + words + ".");
  plan.point = std::move(left);
}

Plan plan_of(Study study, const std::string& out, Console& console) {
  Plan plan;
  const auto seeds = static_cast<double>(study.seeds.size());
  const double placements = study.mounts.count > 0 ? 1 + study.mounts.best + study.mounts.spread : 1;
  demand_possible(study, design_size(study) * seeds * placements, out + "/cells");
  plan.study = std::move(study);
  plan.point = design_of(plan.study);
  for (const Factor& f : plan.study.factor) plan.factor.push_back(f.name);
  if (plan.study.mounts.count > 0) add_placements(plan, out, console);
  limit(plan);
  std::vector<Scenario> scenarios;
  for (const DesignPoint& p : plan.point) scenarios.push_back(scenario_at(plan.study, p, plan.study.seeds.front()));
  plan.fast = fast_scores(scenarios, plan.study.fast, out + "/fast", console.progress());
  return plan;
}

// All cells, point by point, each with every seed.
std::vector<Scenario> scenarios_of(const Plan& plan) {
  std::vector<Scenario> all;
  if (!plan.study.full) return all;
  for (const DesignPoint& p : plan.point)
    for (const int seed : plan.study.seeds) all.push_back(scenario_at(plan.study, p, seed));
  return all;
}

// Names of all metrics in the order in which scores have them.
void add_metrics(StudyTable& table, std::map<std::string, size_t>& index, const Score& score) {
  for (const Metric& m : score.metrics)
    if (index.emplace(m.name, table.metric.size()).second) table.metric.push_back({m.name, m.unit, m.better});
}

StudyTable table_of(const Plan& plan, const std::string& out) {
  StudyTable table;
  const Study& study = plan.study;
  table.name = study.name, table.about = study.about, table.notes = plan.notes;
  table.factor = plan.factor;
  table.objective = study.objectives;
  std::map<std::string, size_t> index;
  for (size_t p = 0; p < plan.point.size(); ++p) {
    const Device cost = cost_of(study, rig_text(scenario_at(study, plan.point[p], study.seeds.front())));
    const FastResult& fast = plan.fast[p];
    table.point.push_back({plan.point[p].level, cost.price, cost.mass_kg,
                           fast.score ? fast_values(*fast.score) : std::vector<double>(fast_columns().size(), none)});
    if (!fast.score) table.notes.push_back("No fast score of " + words_of(table, p) + ": " + fast.failure + ".");
    for (const int seed : study.seeds) {
      if (!study.full) break;
      const Cell cell = load_cell(out + "/cells", cell_name(scenario_at(study, plan.point[p], seed))).value();
      StudyCell row{cell.name, cell.failure, p, seed, {}, cell.seconds};
      if (cell.score) {
        add_metrics(table, index, *cell.score);
        row.value.assign(table.metric.size(), none);
        for (const Metric& m : cell.score->metrics) row.value[index.at(m.name)] = m.value;
      }
      table.cell.push_back(std::move(row));
    }
  }
  for (StudyCell& c : table.cell)
    if (c.failure.empty()) c.value.resize(table.metric.size(), none);
  return table;
}

RigWhy why_of(const Plan& plan, const StudyTable& table, size_t point, const std::string& word) {
  const Scenario s = scenario_at(plan.study, plan.point[point], plan.study.seeds.front());
  RigWhy why{word + ": " + words_of(table, point), plan.fast[point].score, {}};
  const RigPictures shown(load_rig(s.sensors), load_vehicle(s.vehicle), s.sensors);
  for (const auto& [view, name] : {std::pair{RigView::corner, "corner"}, {RigView::front, "front"}})
    why.pictures.emplace_back(word + "-" + name, shown.from(view));
  return why;
}

void say(const StudyTable& table, const StudyAnswer& answer, const std::string& out, Console& console) {
  for (size_t p = 0; p < table.point.size(); ++p) {
    const StudyAnswer::Point& point = answer.point[p];
    std::string line = (point.front ? "* " : "  ") + words_of(table, p) + ":";
    for (size_t o = 0; o < table.objective.size(); ++o) {
      char text[160];
      const Spread& v = point.value[o];
      std::snprintf(text, sizeof text, std::isfinite(v.low) ? " %s %.4g [%.4g, %.4g]" : " %s %.4g",
                    table.objective[o].c_str(), v.median, v.low, v.high);
      line += text;
    }
    if (point.failed > 0) line += ", " + std::to_string(point.failed) + " of " + std::to_string(point.runs) + " failed";
    if (table.point.size() <= 60 || point.front) console.result(line);
  }
  if (answer.best) console.result("best: " + words_of(table, *answer.best) + " (* no other is as good in everything)");
  console.result("page: " + out + "/index.html");
}

int tell(const Plan& plan, const std::string& out, Console& console) {
  const StudyTable table = table_of(plan, out);
  const StudyAnswer answer = answer_of(table);
  write_study(out, table, answer);
  StudyPage page{table, answer, {}, to_toml(plan.study), ""};
  if (answer.best) {
    RigText best = rig_text(scenario_at(plan.study, plan.point[*answer.best], plan.study.seeds.front()));
    best.name = plan.study.name + "-best";
    page.recommended_toml = to_toml(best);
    write_text(out + "/recommended.toml", page.recommended_toml);
    page.why.push_back(why_of(plan, table, *answer.best, "best"));
    if (answer.worst != answer.best) page.why.push_back(why_of(plan, table, *answer.worst, "worst"));
  }
  write_study_page(out, page);
  say(table, answer, out, console);
  if (console.wants_json()) console.json(ordered_json::parse(read_text(out + "/study.json")).dump());
  return 0;
}

std::pair<int, int> shard_of(const std::string& text) {
  int i = 0, n = 0, used = 0;
  if (std::sscanf(text.c_str(), "%d/%d%n", &i, &n, &used) != 2 || used != static_cast<int>(text.size()) || i < 1 ||
      i > n)
    throw Error("--shard " + text + ": must be I/N with 1 <= I <= N");
  return {i, n};
}

int run_study(const Study& study, const std::string& out, const std::string& shard, Console& console) {
  const auto [part, parts] = shard.empty() ? std::pair{1, 1} : shard_of(shard);
  const Plan plan = plan_of(study, out, console);
  write_text(out + "/study.toml", to_toml(plan.study));
  const std::vector<Scenario> cells = scenarios_of(plan);
  const double seconds = static_cast<double>(cells.size()) / parts * seconds_a_cell(out + "/cells") / threads();
  console.note(std::to_string(plan.point.size()) + " points, " + std::to_string(cells.size()) + " cells" +
               (shard.empty() ? "" : ", shard " + shard) + (cells.empty() ? "" : "; some " + duration(seconds)));
  const CellsRun run = run_cells(cells,
                                 {.dir = out + "/cells",
                                  .keep_map = study.keep_maps,
                                  .keep_recording = study.keep_recordings,
                                  .at_once = study.at_once,
                                  .shard = part,
                                  .shards = parts},
                                 console.progress());
  console.note(std::to_string(run.asked) + " cells: " + std::to_string(run.there) + " were there, " +
               std::to_string(run.made) + " made, " + std::to_string(run.failed) + " failed");
  if (shard.empty()) return tell(plan, out, console);
  console.result("shard " + shard + " is done; when all are: adit study merge " + out);
  console.json(
      ordered_json{{"out", out}, {"shard", shard}, {"cells", run.asked}, {"made", run.made}, {"failed", run.failed}}
          .dump());
  return 0;
}

int merge_study(const std::string& out, Console& console) {
  if (!fs::exists(out + "/study.toml"))
    throw Error(out + ": no study.toml in it; it must be the folder of a study that was run");
  const Plan plan = plan_of(load_study(out + "/study.toml"), out, console);
  size_t missing = 0;
  const std::vector<Scenario> cells = scenarios_of(plan);
  for (const Scenario& s : cells) missing += !fs::exists(out + "/cells/" + cell_name(s));
  if (missing > 0) {
    console.result(std::to_string(missing) + " of " + std::to_string(cells.size()) +
                   " cells are not made yet; adit study " + out + "/study.toml -o " + out + " makes them");
    console.json(ordered_json{{"out", out}, {"cells", cells.size()}, {"missing", missing}}.dump());
    return 1;
  }
  return tell(plan, out, console);
}

}  // namespace

int study_command(const std::string& name, const std::string& merged, const std::string& shard, const Common& common,
                  Console& console) {
  if (name == "merge") {
    if (merged.empty()) throw Error("study merge: name the folder of the study");
    return merge_study(merged, console);
  }
  if (!merged.empty()) throw Error("study " + name + " " + merged + ": one study at a time");
  const Study study = load_study(name, common.assignments, common.seed);
  return run_study(study, common.out.empty() ? "out/" + study.name : common.out, shard, console);
}

}  // namespace adit
