// SPDX-License-Identifier: BSD-3-Clause
#include "cli/set_command.h"

#include "base/error.h"
#include "base/files.h"
#include "base/mine_export.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "cli/scenario.h"
#include "cli/stages.h"
#include "worlds/stats.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>

namespace adit {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

const char* const parts[] = {"train", "val", "test"};

// A key and how its values are drawn.
struct Variable {
  std::string key, how;
  std::vector<std::string> words;
  std::vector<double> numbers;
};

Variable variable_of(const std::string& text) {
  Variable v;
  std::istringstream in(text);
  in >> v.key >> v.how;
  for (std::string word; in >> word;) v.words.push_back(word);
  const auto fail = [&](const std::string& what) { throw Error("vary = \"" + text + "\": " + what); };
  const std::map<std::string, size_t> needs{{"uniform", 2}, {"integer", 2}, {"normal", 4}, {"choice", 0}};
  if (!needs.contains(v.how)) fail("after the key comes uniform, integer, normal or choice");
  if (v.how == "choice") {
    if (v.words.empty()) fail("choice needs values");
    return v;
  }
  if (v.words.size() != needs.at(v.how))
    fail(v.how + " needs " +
         std::string(v.how == "normal" ? "mean, sd, least and greatest" : "the least and the greatest"));
  for (const std::string& word : v.words) {
    char* end = nullptr;
    v.numbers.push_back(std::strtod(word.c_str(), &end));
    if (end == word.c_str() || *end != 0) fail("'" + word + "' is no number");
  }
  const size_t low = v.how == "normal" ? 2 : 0;
  if (v.numbers[low] > v.numbers[low + 1]) fail("the least is above the greatest");
  return v;
}

std::string value_of(const Variable& v, std::uint64_t seed, std::uint64_t mine, std::uint64_t which) {
  const double u = uniform(seed, Draw::set_value, mine, which);
  char text[40];
  if (v.how == "choice") return v.words[static_cast<size_t>(u * static_cast<double>(v.words.size()))];
  if (v.how == "integer") {
    std::snprintf(text, sizeof text, "%.0f", v.numbers[0] + std::floor(u * (v.numbers[1] - v.numbers[0] + 1)));
    return text;
  }
  double value = v.numbers[0] + u * (v.numbers[1] - v.numbers[0]);
  if (v.how == "normal")
    value = std::clamp(v.numbers[0] + v.numbers[1] * normal(seed, Draw::set_value, mine, which), v.numbers[2],
                       v.numbers[3]);
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

// Mines of one plan must not be in two parts of a split: a plan that is read is named, others are drawn by their seed.
std::string plan_of(const Scenario& s) {
  if (s.world.kind != "plan") return s.world.kind + " of seed " + std::to_string(s.seed);
  return "plan " + s.world.plan;
}

struct Mine {
  std::string name;
  Scenario scenario;
  std::vector<std::string> values;
  std::string part;
  ordered_json row;
};

// Plans in an order by chance; the first share of the mines trains, and so on, whole plans at a time.
void split(const MineSet& set, std::vector<Mine>& mines) {
  std::map<std::string, std::vector<size_t>> by_plan;
  for (size_t i = 0; i < mines.size(); ++i) by_plan[plan_of(mines[i].scenario)].push_back(i);
  std::vector<std::pair<double, std::string>> order;
  for (const auto& [plan, some] : by_plan)
    order.emplace_back(uniform(static_cast<std::uint64_t>(set.seed), Draw::set_value, some.front(), 1 << 20), plan);
  std::sort(order.begin(), order.end());
  double done = 0, all = 0;
  for (double share : set.split) all += share;
  for (const auto& [key, plan] : order) {
    const auto n = static_cast<double>(by_plan[plan].size());
    const double at = (done + 0.5 * n) / static_cast<double>(mines.size()) * all;
    size_t part = 0;
    for (double until = set.split[0]; part < 2 && at >= until; until += set.split[part]) ++part;
    for (size_t i : by_plan[plan]) mines[i].part = parts[part];
    done += n;
  }
}

std::vector<Mine> mines_of(const MineSet& set, const Common& common) {
  std::vector<Variable> variables;
  for (const std::string& text : set.vary) variables.push_back(variable_of(text));
  std::vector<Mine> mines(static_cast<size_t>(set.mines));
  for (size_t i = 0; i < mines.size(); ++i) {
    Mine& m = mines[i];
    char name[32];
    std::snprintf(name, sizeof name, "mine-%04zu", i);
    m.name = name;
    std::vector<std::string> assignments = set.set;
    assignments.insert(assignments.end(), common.assignments.begin(), common.assignments.end());
    for (size_t k = 0; k < variables.size(); ++k) {
      m.values.push_back(value_of(variables[k], static_cast<std::uint64_t>(set.seed), i, k));
      assignments.push_back(variables[k].key + "=" + m.values.back());
    }
    m.scenario = load_scenario(set.scenario, assignments);
    m.scenario.seed = set.seed + static_cast<int>(i);
    m.scenario.name = m.name;
  }
  split(set, mines);
  return mines;
}

// What a mine is, as its line of the manifest.
ordered_json row_of(const MineSet& set, const Mine& m, const World& world) {
  ordered_json row{{"mine", m.name}, {"split", m.part}, {"seed", m.scenario.seed}, {"plan", plan_of(m.scenario)}};
  for (size_t k = 0; k < set.vary.size(); ++k) row[set.vary[k].substr(0, set.vary[k].find(' '))] = m.values[k];
  double length = 0, width = 0, height = 0;
  for (const Passage& p : world.passages) {
    length += p.length_m;
    width += p.width_m * p.length_m;
    height += p.height_m * p.length_m;
  }
  row["volume_m3"] = world.numbers.volume_m3;
  row["passages_m"] = length;
  row["width_m"] = width / length;
  row["height_m"] = height / length;
  row["loops"] = world.numbers.loops;
  row["blocked"] =
      std::count_if(world.passages.begin(), world.passages.end(), [](const Passage& p) { return p.blocked; });
  row["things"] = world.objects.size();
  int left_out = 0;
  for (const auto& [label, n] : world.left_out) left_out += n;
  row["left_out"] = left_out;
  row["error"] = "";
  return row;
}

// One mine, whole or not at all in the manifest's eyes: mine.json comes last, and tells the settings it was made by.
void make(const MineSet& set, const std::string& out, Mine& m) {
  const std::string dir = out + "/" + m.name, file = dir + "/mine.json", settings = resolved_toml(m.scenario);
  if (fs::exists(file)) {
    const ordered_json known = ordered_json::parse(read_text(file), nullptr, false);
    if (!known.is_discarded() && known.value("settings", "") == settings && known.value("until", "") == set.until) {
      m.row = known["row"];
      m.row["split"] = m.part;
      return;
    }
  }
  Console silent(true, false);
  Stages stages(dir, silent);
  try {
    World world;
    if (m.scenario.world.tile_m > 0 && set.until == "world") {
      stages.world_in_parts(m.scenario);
      world = load_world(dir + "/world");
    } else {
      world = stages.world(m.scenario);
    }
    write_instances(dir + "/world/objects.json", world);
    if (set.until == "drive") stages.drive(m.scenario, world, nullptr);
    m.row = row_of(set, m, world);
  } catch (const Error& e) {
    if (e.fault() == Fault::file || e.fault() == Fault::bug) throw;
    m.row = {{"mine", m.name}, {"split", m.part}, {"seed", m.scenario.seed}, {"error", e.what()}};
  }
  stages.save_timing();
  write_text(file, ordered_json{{"settings", settings}, {"until", set.until}, {"row", m.row}}.dump(1) + "\n");
}

std::string quoted(const ordered_json& v) {
  const std::string text = v.is_string() ? v.get<std::string>() : v.dump();
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string out = "\"";
  for (char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

void write_manifest(const std::string& out, const std::vector<Mine>& mines) {
  std::vector<std::string> columns;
  ordered_json all = ordered_json::array();
  for (const Mine& m : mines) {
    all.push_back(m.row);
    for (const auto& [key, value] : m.row.items())
      if (std::find(columns.begin(), columns.end(), key) == columns.end()) columns.push_back(key);
  }
  std::string csv;
  for (size_t k = 0; k < columns.size(); ++k) csv += (k ? "," : "") + columns[k];
  csv += "\n";
  for (const Mine& m : mines) {
    for (size_t k = 0; k < columns.size(); ++k)
      csv += (k ? "," : "") + (m.row.contains(columns[k]) ? quoted(m.row[columns[k]]) : "");
    csv += "\n";
  }
  write_text(out + "/manifest.csv", csv);
  write_text(out + "/manifest.json", all.dump(1) + "\n");
}

std::string card_of(const MineSet& set, const std::vector<Mine>& mines, const std::string& toml) {
  std::map<std::string, int> in_part, plans;
  double length = 0, volume = 0;
  int failed = 0, things = 0, left_out = 0;
  for (const Mine& m : mines) {
    if (!m.row.value("error", "").empty()) {
      ++failed;
      continue;
    }
    ++in_part[m.part];
    ++plans[m.row.value("plan", "")];
    length += m.row.value("passages_m", 0.0);
    volume += m.row.value("volume_m3", 0.0);
    things += m.row.value("things", 0);
    left_out += m.row.value("left_out", 0);
  }
  std::ostringstream card;
  card << "# " << set.name << "\n\n" << (set.about.empty() ? "Synthetic room-and-pillar mines." : set.about) << "\n\n";
  card << "| | |\n|---|---|\n| mines | " << mines.size() - static_cast<size_t>(failed) << " |\n| plans | "
       << plans.size() << " |\n";
  for (const char* part : parts) card << "| " << part << " | " << in_part[part] << " |\n";
  card << "| passages | " << std::llround(length) << " m |\n| void | " << std::llround(volume) << " m3 |\n";
  card << "| things | " << things << "; " << left_out << " more were asked for and had no room |\n";
  if (failed > 0) card << "| could not be made | " << failed << ", see `error` in the manifest |\n";
  card << "| licence | " << set.licence << " |\n\n";
  card << "## What it holds\n\nA folder for each mine: `scenario.toml` (every setting; it makes the mine again), "
          "`world/` "
          "(watertight labelled mesh, exact truth, plans, `objects.json` with a box for each thing)"
       << (set.until == "drive" ? ", `recording/` (laser log and its truth)" : "")
       << ". `manifest.csv` and `manifest.json` have a line a mine: what was drawn, what it measures, its part of the "
          "split. No two parts of the split share a plan.\n\n";
  card << "## How it was made\n\nBy adit " << ADIT_VERSION
       << ", all by numbers: nobody was recorded, no survey of a real mine is in it but for plans that are named. The "
          "same file makes the same bytes:\n\n```toml\n"
       << toml << "```\n";
  return card.str();
}

}  // namespace

Fields fields(MineSet& s) {
  return {
      {"name", &s.name, "of the set"},
      {"about", &s.about, "one sentence"},
      {"scenario", &s.scenario, "bundled name or TOML file that all mines begin with"},
      {"mines", &s.mines, "how many", 1, 1000000},
      {"seed", &s.seed, "of the first mine; the next has the next", 0, 2000000000},
      {"until", &s.until, "what is made of each", {"world", "drive"}},
      {"vary", &s.vary,
       "what is drawn for each mine: 'KEY uniform LOW HIGH', 'KEY normal MEAN SD LOW HIGH', 'KEY integer LOW HIGH', "
       "'KEY choice A B ...'"},
      {"set", &s.set, "key=value, for all mines"},
      {"split", &s.split, "shares of train, val and test"},
      {"licence", &s.licence, "as the card tells it"}};
}

bool is_set(const std::string& name) {
  if (!name.ends_with(".toml") || !fs::exists(name)) return false;
  const Document file = Document::load(name);
  return file.has("mines") || file.has("vary");
}

int set_command(const std::string& file, const Common& common, Console& console) {
  MineSet set;
  set.name = fs::path(file).stem().string();
  const Document document = Document::load(file);
  document.read(fields(set));
  if (common.seed >= 0) set.seed = common.seed;
  if (set.split.size() != 3 || *std::min_element(set.split.begin(), set.split.end()) < 0 ||
      !(set.split[0] + set.split[1] + set.split[2] > 0))
    document.fail("split", "three shares are needed: train, val, test");
  const std::string out = common.out.empty() ? "out/" + set.name : common.out;
  std::vector<Mine> mines = mines_of(set, common);
  console.note(std::to_string(mines.size()) + " mines");
  parallel_for(mines.size(), [&](size_t i) { make(set, out, mines[i]); });
  write_manifest(out, mines);
  write_text(out + "/README.md", card_of(set, mines, to_toml(fields(set))));
  int failed = 0;
  for (const Mine& m : mines) {
    const std::string error = m.row.value("error", "");
    if (error.empty()) continue;
    ++failed;
    console.note(m.name + ": " + error);
  }
  console.result("set: " + out + ", " + std::to_string(mines.size() - static_cast<size_t>(failed)) + " mines" +
                 (failed > 0 ? ", " + std::to_string(failed) + " could not be made" : ""));
  console.json(ordered_json{{"out", out}, {"mines", mines.size()}, {"failed", failed}}.dump());
  return failed == 0 ? 0 : 1;
}

}  // namespace adit
