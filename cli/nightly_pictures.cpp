// SPDX-License-Identifier: BSD-3-Clause
#include "cli/nightly_pictures.h"

#include "base/error.h"
#include "base/files.h"
#include "cli/cells.h"
#include "cli/stages.h"
#include "eval/render.h"

#include <algorithm>
#include <filesystem>
#include <set>

namespace adit {
namespace {

namespace fs = std::filesystem;

// The first picture of the pipeline in which a metric of that kind shows.
std::string view_of(const std::string& metric) {
  if (metric.starts_with("trajectory.open_loop") || metric.starts_with("bound")) return "raw";
  if (metric.starts_with("trajectory")) return "errors";
  if (metric.starts_with("closures")) return "closures";
  return metric.starts_with("grid") ? "grid" : "plan";
}

std::string kept_name(const SuiteCell& c) {
  std::string name = c.scenario + "." + c.method + "." + std::to_string(c.run.seed);
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

// A run's truth and recording, made again: the same bytes as when its cell was made.
struct Remade {
  World world;
  Recording recording;
};
Remade remade(const Scenario& s) {
  Remade r;
  const auto seed = static_cast<std::uint64_t>(s.seed);
  r.world = sound_world(s);
  const Vehicle vehicle = load_vehicle(s.vehicle);
  const Drive driven = drive(r.world, plan_route(r.world, s.route, seed), vehicle, s.drive, seed);
  r.recording = record(r.world, driven, load_rig(s.sensors), vehicle.hull, s.sensors, seed);
  return r;
}

// The picture of a map, and its page where a folder for it is given.
void show(const std::string& png, const std::string& report, const std::string& view, const Remade& made,
          const std::string& map, const Scenario& s) {
  const Estimate estimate = load_estimate(map);
  const Score score = score_map(made.world, made.recording.truth, made.recording.log.rig, estimate, s.score);
  const ReportInput input{made.world, made.recording.log, made.recording.truth, estimate, score, resolved_toml(s),
                          s.name};
  write_png(png, render_view(view, input, s.report));
  if (!report.empty()) write_report(report, input, s.report);
}

const SuiteCell* cell_of(const std::vector<SuiteCell>& suite, const MetricVerdict& m) {
  for (const SuiteCell& c : suite)
    if (c.scenario == m.scenario && c.method == m.method && m.worst_seed && c.run.seed == *m.worst_seed) return &c;
  return nullptr;
}

}  // namespace

std::vector<BeforeAfter> show_regressions(const std::string& out, const std::string& cells, const Verdict& verdict,
                                          const std::vector<SuiteCell>& suite, const Progress& progress) {
  std::vector<BeforeAfter> shown;
  std::set<std::pair<std::string, std::string>> seen;
  for (const MetricVerdict& m : verdict.metric) {
    if (m.kind != "regressed" && m.kind != "crept" && m.kind != "beyond") continue;
    const SuiteCell* cell = cell_of(suite, m);
    const std::string now = cell ? cells + "/" + cell_name(cell->run) + "/map" : "";
    if (!cell || !fs::exists(now) || !seen.insert({m.scenario, m.method}).second) continue;
    const std::string view = view_of(m.metric.name), name = kept_name(*cell), kept = out + "/baseline/" + name;
    progress("pictures", static_cast<double>(shown.size()), static_cast<double>(shown.size() + 1));
    BeforeAfter b{
        {m.scenario, m.method, m.metric.name, m.kind, m.words}, cell->run.seed, "view '" + view + "'", "", "", ""};
    try {  // a picture that cannot be made must not cost the night
      show(out + "/trend/" + name + ".after.png", out + "/reports/" + name, view, remade(cell->run), now, cell->run);
      b.after = name + ".after.png", b.report = "../reports/" + name + "/index.html";
      if (fs::exists(kept + "/scenario.toml")) {
        // The map before was made of the recording before: only the truth is the same.
        const Scenario before = load_scenario(kept + "/scenario.toml");
        show(out + "/trend/" + name + ".before.png", "", view, remade(before), kept + "/map", before);
        b.before = name + ".before.png";
      }
    } catch (const Error& e) {
      b.title += std::string("; ") + e.what();
    }
    shown.push_back(std::move(b));
  }
  return shown;
}

void keep_maps(const std::string& out, const std::string& cells, const Night& night,
               const std::vector<SuiteCell>& suite) {
  if (night.verdict == "regressed") return;
  const std::string fresh = out + "/baseline.new", dir = out + "/baseline";
  std::error_code failed;
  fs::remove_all(fresh, failed);
  for (const SuiteCell& c : suite) {
    const std::string cell = cells + "/" + cell_name(c.run), to = fresh + "/" + kept_name(c);
    if (!fs::exists(cell + "/map")) continue;
    write_text(to + "/scenario.toml", resolved_toml(c.run));
    fs::copy(cell + "/map", to + "/map", fs::copy_options::recursive | fs::copy_options::create_hard_links, failed);
    if (failed) throw Error(to + ": cannot keep the map: " + failed.message(), Fault::file);
  }
  if (!fs::exists(fresh)) return;
  fs::remove_all(dir, failed);
  fs::rename(fresh, dir, failed);
  if (failed) throw Error(dir + ": cannot be put in place: " + failed.message(), Fault::file);
  for (const fs::directory_entry& build : fs::directory_iterator(fs::path(cells).parent_path()))
    if (build.is_directory() && build.path().filename() != fs::path(cells).filename())
      for (const fs::directory_entry& old : fs::directory_iterator(build)) fs::remove_all(old.path() / "map", failed);
}

}  // namespace adit
