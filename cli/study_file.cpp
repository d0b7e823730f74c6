// SPDX-License-Identifier: BSD-3-Clause
#include "cli/study_file.h"

#include "base/error.h"
#include "base/files.h"
#include "eval/explain.h"
#include "eval/study.h"

#include <algorithm>
#include <filesystem>
#include <set>

namespace adit {
namespace {

Fields fields(MountSearch& m) {
  return {{"count", &m.count, "lasers to be placed; 0: none", 0, 16},
          {"fixed", &m.fixed, "lasers of the rig that stay; the others go"},
          {"models", &m.models, "that may be placed"},
          {"spacing_m", &m.spacing_m, "of candidate places on the hull", 0.01, 10},
          {"clearance_m", &m.clearance_m, "of a mirror from the hull", 0, 10},
          {"apart_m", &m.apart_m, "least distance of two mirrors", 0, 10},
          {"most", &m.most, "candidates", 1, 100000},
          {"best", &m.best, "placements that go on to full runs", 1, 10000},
          {"spread", &m.spread, "besides, so many evenly over all that were scored", 0, 10000}};
}

Fields fields(Factor& f) {
  return {{"key", &f.key, "of the scenario, rig.LASER.KEY, or set: lists of key=value of the scenario"},
          {"name", &f.name, "how results call it"},
          {"labels", &f.labels, "of the values"},
          {"from", &f.from, "of a range"},
          {"to", &f.to, "of a range"},
          {"steps", &f.steps, "of a range in a grid", 1, 100000},
          {"log", &f.log, "steps of equal ratio"},
          {"whole", &f.whole, "whole numbers"}};
}

void check_factor(const Document& table, const Factor& f, const Study& study) {
  if (f.key.empty()) table.fail("key", "is missing: every [[factor]] needs one");
  if (table.has("values") && f.values.empty()) table.fail("values", "is empty: a factor needs a value at least");
  if (f.values.empty() && !(table.has("from") && table.has("to")))
    table.fail("key", "'" + f.key + "' needs values = [...], or from and to");
  if (!f.values.empty() && (table.has("from") || table.has("to")))
    table.fail("values", "and from, to exclude one another");
  if (!f.labels.empty() && f.labels.size() != f.values.size())
    table.fail("labels", "must be as many as the values, " + std::to_string(f.values.size()));
  if (f.values.empty() && study.sample == "grid" && f.steps < 1)
    table.fail("key", "'" + f.key + "' needs steps = N: how many values of its range the grid takes");
  if (f.values.empty() && f.to < f.from) table.fail("to", "must not be below from");
  if (f.log && !(f.from > 0)) table.fail("from", "must be above 0 with log = true");
  if (f.key == "seed") table.fail("key", "cannot be 'seed': the study's seeds are seeds = [...]");
  if (f.key.starts_with("rig.") && f.key.find('.', 4) == std::string::npos)
    table.fail("key", "'" + f.key + "' must be rig.LASER.KEY, as rig.up.pitch_deg");
}

// Every level must be a scenario that can be: a misspelt key is said before anything runs.
void check_levels(const Study& study, const Document& file) {
  std::set<std::string> seen;
  for (const Factor& f : study.factor) {
    if (!seen.insert(f.key).second && f.key != "set")
      throw Error(file.name() + ": two factors have the key '" + f.key + "'");
    Study alone = study;
    alone.sample = "grid";
    alone.factor = {f};
    if (f.values.empty()) alone.factor[0].steps = 2;
    for (const DesignPoint& point : design_of(alone)) {
      try {
        scenario_at(alone, point, 0);
      } catch (const Error& e) {
        throw Error(file.name() + ": factor '" + f.key + "': " + e.what());
      }
    }
  }
}

std::string list_of(const std::vector<std::string>& items) {
  std::string text;
  for (const std::string& item : items) text += (text.empty() ? "" : ", ") + item;
  return "[" + text + "]";
}

// An objective that no column will have is said before anything runs.
void check_objectives(const Study& s, const Document& file) {
  for (const std::string& o : s.objectives) {
    const bool fast = std::any_of(fast_columns().begin(), fast_columns().end(),
                                  [&](const StudyColumn& column) { return column.name == o; });
    if (fast || o == "price" || o == "mass_kg") continue;
    if (!is_metric(o))
      file.fail(
          "objectives",
          "names '" + o + "', which is no metric of a score ('adit list metrics'), none of fast.*, price, mass_kg");
    if (!s.full)
      file.fail(
          "objectives",
          "names '" + o + "', which needs runs, and full = false; of geometry alone there are fast.*, price, mass_kg");
  }
}

}  // namespace

Fields study_fields(Study& s) {
  Fields all{{"name", &s.name, "how results call it"},
             {"about", &s.about, "one sentence"},
             {"scenario", &s.scenario, "bundled or a file: what every run begins with"},
             {"set", &s.set, "key=value of the scenario"},
             {"seeds", &s.seeds, "every point is run with each", 0, 2147483647},
             {"objectives", &s.objectives, "metrics, fast.*, price, mass_kg by which points are judged"},
             {"sample", &s.sample, "of the factors", {"grid", "sobol", "latin"}},
             {"samples", &s.samples, "of sobol and latin", 1, 1000000},
             {"sample_seed", &s.sample_seed, "of sobol and latin", 0, 2147483647},
             {"price_max", &s.price_max, "of a rig; 0: no limit", 0, 1e12},
             {"mass_max_kg", &s.mass_max_kg, "of a rig's lasers; 0: no limit", 0, 1e9},
             {"clearance_m", &s.clearance_m, "of every mirror from the hull; 0: any", 0, 10},
             {"cells_max", &s.cells_max, "more runs than this are refused", 1, 2147483647},
             {"at_once", &s.at_once, "cells side by side; 0: as many as threads", 0, 1024},
             {"full", &s.full, "the whole pipeline after the fast score"},
             {"keep_maps", &s.keep_maps, "in the cells' folders"},
             {"keep_recordings", &s.keep_recordings, "in the cells' folders"}};
  append(all, "mounts", fields(s.mounts));
  append(all, "fast", fields(s.fast));
  return all;
}

Study load_study(const std::string& name_or_file, const std::vector<std::string>& assignments, int seed) {
  const Document file = Document::find("cli/studies", name_or_file);
  Study s;
  s.name = std::filesystem::path(name_or_file).stem().string();
  file.read(study_fields(s), {"factor", "device", "mounts.orientations"});
  for (const Document& table : file.tables("factor")) {
    Factor f;
    table.read(fields(f), {"values"});
    f.values = table.texts("values");
    check_factor(table, f, s);
    if (f.name.empty()) f.name = f.key;
    s.factor.push_back(std::move(f));
  }
  for (const Document& table : file.tables("device")) {
    Device d;
    table.read({{"model", &d.model, "of lasers"},
                {"price", &d.price, "of one", 0, 1e12},
                {"mass_kg", &d.mass_kg, "of one", 0, 1e6}});
    if (d.model.empty()) table.fail("model", "is missing: every [[device]] needs one");
    s.device.push_back(std::move(d));
  }
  s.mounts.orientations = file.texts("mounts.orientations");
  s.set.insert(s.set.end(), assignments.begin(), assignments.end());
  if (seed >= 0) s.seeds = {seed};
  if (s.seeds.empty()) file.fail("seeds", "is empty: a study needs one seed at least");
  if (s.objectives.empty()) file.fail("objectives", "is empty: a study needs one at least");
  check_objectives(s, file);
  if (std::set<int>(s.seeds.begin(), s.seeds.end()).size() != s.seeds.size()) file.fail("seeds", "holds a seed twice");
  load_scenario(s.scenario, s.set);
  if (design_size(s) <= s.cells_max) check_levels(s, file);
  return s;
}

std::string to_toml(const Study& study) {
  Study s = study;
  const std::string orientations = "orientations = " + list_of(s.mounts.orientations) + "\n";
  std::string text = to_toml(study_fields(s));
  text.insert(text.find("[mounts]\n") + 9, orientations);
  for (Factor& f : s.factor) {
    Fields kept;
    for (const Field& field : fields(f)) {
      const bool of_range = field.key == "from" || field.key == "to" || field.key == "steps";
      if ((of_range && !f.values.empty()) || (field.key == "steps" && f.steps == 0)) continue;
      kept.push_back(field);
    }
    text += "\n[[factor]]\n" + to_toml(kept);
    if (!f.values.empty()) text += "values = " + list_of(f.values) + "\n";
  }
  for (Device& d : s.device)
    text += "\n[[device]]\n" + to_toml({{"model", &d.model, ""}, {"price", &d.price, ""}, {"mass_kg", &d.mass_kg, ""}});
  return text;
}

}  // namespace adit
