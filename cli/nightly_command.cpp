// SPDX-License-Identifier: BSD-3-Clause
#include "cli/nightly_command.h"

#include "base/error.h"
#include "base/files.h"
#include "cli/cells.h"
#include "cli/nightly_pictures.h"
#include "cli/suite.h"

#include <nlohmann/json.hpp>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>

namespace adit {
namespace {

namespace fs = std::filesystem;

std::string first_line(const std::string& file) {
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  return line;
}

std::string environment(std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (const char* value = std::getenv(name); value && *value) return value;
  return "";
}

// Commit and branch of the working folder's repository; empty where there is none.
struct GitHead {
  std::string commit, branch;
};
GitHead git_head() {
  for (fs::path at = fs::current_path();; at = at.parent_path()) {
    if (fs::is_directory(at / ".git")) {
      const std::string head = first_line((at / ".git/HEAD").string());
      if (!head.starts_with("ref: ")) return {head, ""};
      const std::string ref = head.substr(5), heads = "refs/heads/";
      GitHead found{first_line((at / ".git" / ref).string()), ref.starts_with(heads) ? ref.substr(heads.size()) : ref};
      std::ifstream packed((at / ".git/packed-refs").string());
      for (std::string line; found.commit.empty() && std::getline(packed, line);)
        if (line.ends_with(" " + ref)) found.commit = line.substr(0, line.find(' '));
      return found;
    }
    if (at == at.root_path()) return {};
  }
}

std::string machine_name() {
  std::ifstream lines("/proc/cpuinfo");
  std::string model = "unknown processor";
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  return model + ", " + std::to_string(::sysconf(_SC_NPROCESSORS_ONLN)) + " cores";
}

std::string date_now() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M", &utc);
  return text;
}

// Runs of another build are other runs, even of the same version.
std::string build_name(const std::string& commit) {
  std::ifstream exe("/proc/self/exe", std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(exe)), std::istreambuf_iterator<char>());
  return (commit.empty() ? "" : digest(commit).substr(0, 8) + "-") + digest(bytes).substr(0, 8);
}

Night head_of(const NightlyInput& in, const Suite& suite, const std::vector<SuiteCell>& cells) {
  const GitHead git = in.commit.empty() || in.branch.empty() ? git_head() : GitHead{};
  Night n;
  n.suite = suite.name;
  n.commit = !in.commit.empty() ? in.commit : environment({"GITHUB_SHA", "CI_COMMIT_SHA"});
  n.branch = !in.branch.empty() ? in.branch : environment({"GITHUB_HEAD_REF", "GITHUB_REF_NAME", "CI_COMMIT_REF_NAME"});
  if (n.commit.empty()) n.commit = git.commit;
  if (n.branch.empty()) n.branch = git.branch;
  n.version = ADIT_VERSION;
  n.evaluator = evaluator_of(cells);
  n.machine = machine_name();
  n.compiler = "GCC " __VERSION__;
  n.date = date_now();
  return n;
}

std::string meta_of(const Score& score, const std::string& key) {
  for (const auto& [name, value] : score.meta)
    if (name == key) return value;
  return "";
}

NightCell night_cell(const SuiteCell& c, const std::string& dir, const SuiteRules& rules, const std::string& page) {
  const std::optional<Cell> cell = load_cell(dir, cell_name(c.run));
  ADIT_CHECK(cell.has_value());
  NightCell out{c.scenario, c.method, c.run.seed, "", cell->failure, page, cell->seconds, {}};
  if (cell->peak_gib > 0) out.peak_gib = cell->peak_gib;
  if (!cell->score) return out;
  out.truth = meta_of(*cell->score, "truth_hash") + "/" + meta_of(*cell->score, "path_hash");
  for (const SuiteMetric& m : rules.metric)
    if (const Metric* found = cell->score->find(m.name); found && std::isfinite(found->value))
      out.value[m.name] = found->value;
  return out;
}

std::string out_of(const Common& common, const Suite& suite) {
  return common.out.empty() ? "out/nightly/" + suite.name : common.out;
}

CellsSettings cells_settings(const NightlyInput& in, const std::string& dir, bool keep_map) {
  CellsSettings settings;
  settings.dir = dir, settings.keep_map = keep_map;
  char rest = 0;
  if (!in.shard.empty() && std::sscanf(in.shard.c_str(), "%d/%d%c", &settings.shard, &settings.shards, &rest) != 2)
    throw Error("--shard " + in.shard + ": must be I/N, as 1/4");
  return settings;
}

// The page of the night's branch, and pictures where something is worse.
void write_pages(const std::string& out, const Suite& suite, const Night& tonight, std::vector<Night> past,
                 std::vector<BeforeAfter> pictures) {
  TrendInput page{suite.name, suite.about, {}, {}, std::move(pictures)};
  for (const SuiteMetric& m : suite.rules.metric) page.metrics.push_back(m.name);
  for (Night& n : past)
    if (n.branch == tonight.branch) page.nights.push_back(std::move(n));
  page.nights.push_back(tonight);
  write_trend_page(out + "/trend", page);
}

void tell(const Night& night, const Verdict& v, const std::string& out, Console& console) {
  console.result(night.suite + ": " + v.verdict + (v.baseline.empty() ? "" : ", against " + v.baseline));
  for (const Claim& c : v.claims)
    console.result("  " + c.kind + ": " + c.scenario + ", " + c.method + (c.metric.empty() ? "" : ", " + c.metric) +
                   ": " + c.words);
  for (const std::string& note : v.notes) console.note("  " + note);
  console.result("trend: " + out + "/trend/index.html");
  if (console.wants_json()) console.json(nlohmann::ordered_json::parse(read_text(out + "/verdict.json")).dump());
}

int accept_command(const NightlyInput& in, const Suite& suite, Console& console) {
  if (in.history.empty()) throw Error("nightly --accept: name the --history whose last night is accepted");
  const std::int64_t night = History(in.history).accept(suite.name, in.branch, in.accept);
  console.result("night " + std::to_string(night) + " is the new baseline of " + suite.name);
  console.json(nlohmann::ordered_json{{"accepted", night}}.dump());
  return 0;
}

}  // namespace

int nightly_command(const NightlyInput& in, const Common& common, Console& console) {
  Suite suite = load_suite(in.suite);
  if (!in.accept.empty()) return accept_command(in, suite, console);
  if (!in.baseline.empty()) suite.rules.baseline = in.baseline;
  const std::vector<SuiteCell> cells = cells_of(suite, common.assignments);
  Night tonight = head_of(in, suite, cells);
  std::optional<History> history;  // opened before hours are spent
  if (!in.history.empty() && in.shard.empty()) history.emplace(in.history);
  if (history) {
    Night empty = tonight;
    judge(empty, history->nights(suite.name), suite.rules);  // a baseline that there is not is said now
  }
  const std::string out = out_of(common, suite), dir = out + "/cells/" + build_name(tonight.commit);
  std::vector<Scenario> runs;
  for (const SuiteCell& c : cells) runs.push_back(c.run);
  const CellsRun made = run_cells(runs, cells_settings(in, dir, suite.pictures), console.progress());
  console.note("  " + std::to_string(made.made) + " runs made, " + std::to_string(made.there) + " there before, " +
               std::to_string(made.failed) + " failed");
  if (!in.shard.empty()) {
    console.json(nlohmann::ordered_json{{"cells", dir}, {"made", made.made}, {"failed", made.failed}}.dump());
    return 0;
  }
  for (const SuiteCell& c : cells)
    tonight.cells.push_back(night_cell(
        c, dir, suite.rules, "../cells/" + fs::path(dir).filename().string() + "/" + cell_name(c.run) + "/score.json"));
  const std::vector<Night> past = history ? history->nights(suite.name) : std::vector<Night>{};
  const Verdict verdict = judge(tonight, past, suite.rules);
  tonight.verdict = verdict.verdict, tonight.claims = verdict.claims;
  std::vector<BeforeAfter> pictures;
  if (suite.pictures) pictures = show_regressions(out, dir, verdict, cells, console.progress());
  for (const BeforeAfter& p : pictures)
    for (NightCell& c : tonight.cells)
      if (c.scenario == p.claim.scenario && c.method == p.claim.method) c.run = p.report;
  tonight.id = history ? history->add(tonight) : static_cast<std::int64_t>(past.size()) + 1;
  write_verdict_json(out + "/verdict.json", tonight, verdict);
  write_verdict_md(out + "/verdict.md", tonight, verdict);
  write_junit(out + "/junit.xml", tonight, verdict);
  write_pages(out, suite, tonight, past, std::move(pictures));
  if (suite.pictures) keep_maps(out, dir, tonight, cells);
  tell(tonight, verdict, out, console);
  return verdict.exit_code;
}

}  // namespace adit
