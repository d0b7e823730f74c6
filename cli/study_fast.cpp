// SPDX-License-Identifier: BSD-3-Clause
#include "cli/study_fast.h"

#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "cli/cells.h"
#include "cli/stages.h"
#include "rays/caster.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>

namespace adit {

struct FastCourse::Impl {
  World world;
  Vehicle vehicle;
  Caster caster;
  std::optional<Course> course;

  explicit Impl(const Scenario& s) : world(sound_world(s)), vehicle(load_vehicle(s.vehicle)), caster(world.mesh) {}
};

FastCourse::FastCourse(const Scenario& s, const FastSettings& settings) : impl_(std::make_unique<Impl>(s)) {
  const auto seed = static_cast<std::uint64_t>(s.seed);
  const Drive d = drive(impl_->world, plan_route(impl_->world, s.route, seed), impl_->vehicle, s.drive, seed);
  if (d.end != DriveEnd::finished) throw Error("drive " + drive_end_name(d.end) + ": " + d.cause);
  impl_->course.emplace(impl_->caster, d.path, settings);
}
FastCourse::~FastCourse() = default;
const Course& FastCourse::course() const {
  return *impl_->course;
}
const Hull& FastCourse::hull() const {
  return impl_->vehicle.hull;
}

namespace {

using Json = nlohmann::ordered_json;

std::string settings_text(FastSettings settings) {
  return to_toml(fields(settings));
}

// A scenario without what true geometry does not ask.
Scenario geometry_of(Scenario s) {
  s.map = {}, s.external = {}, s.score = {};
  return s;
}
Scenario drive_of(Scenario s) {
  s = geometry_of(s);
  s.sensors = {};
  return s;
}

Json written(const FastResult& r) {
  if (!r.score) return {{"failure", r.failure}};
  const FastScore& s = *r.score;
  return {{"value", s.value},
          {"information", s.information},
          {"surface", s.surface},
          {"volume", s.volume},
          {"hull", s.hull},
          {"sigma", std::vector<double>(s.sigma.data(), s.sigma.data() + 6)},
          {"left", std::vector<double>(s.left.data(), s.left.data() + 6)},
          {"blind_left", s.blind_left}};
}

FastResult read_fast(const Json& j) {
  if (j.contains("failure")) return {{}, j["failure"]};
  FastScore s;
  s.value = j.at("value"), s.information = j.at("information"), s.surface = j.at("surface");
  s.volume = j.at("volume"), s.blind_left = j.at("blind_left"), s.hull = j.at("hull");
  for (size_t k = 0; k < 6; ++k) {
    s.sigma[static_cast<Eigen::Index>(k)] = j.at("sigma").at(k);
    s.left[static_cast<Eigen::Index>(k)] = j.at("left").at(k);
  }
  return {s, ""};
}

// What is kept under a name, if it was made by the same settings.
std::optional<Json> kept(const std::string& file, const std::string& settings) {
  if (!std::filesystem::exists(file)) return {};
  Json j = Json::parse(read_text(file), nullptr, false);
  if (j.is_discarded() || j.value("settings", "") != settings) return {};
  return j["result"];
}

void keep(const std::string& file, const std::string& settings, const Json& result) {
  write_text(file, Json{{"settings", settings}, {"result", result}}.dump(1) + "\n");
}

FastScore score_rig(const FastCourse& at, const Rig& rig) {
  std::vector<Sight> sights;
  for (const Mount& mount : rig.mounts) sights.push_back(at.course().sight(mount, at.hull()));
  std::vector<const Sight*> lasers;
  for (const Sight& s : sights) lasers.push_back(&s);
  return at.course().score(lasers);
}

std::string short_number(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", v);
  return text;
}

std::string change_of(const MountText& m) {
  return m.name + " model=" + m.model + " x_m=" + short_number(m.position_m[0]) +
         " y_m=" + short_number(m.position_m[1]) + " z_m=" + short_number(m.position_m[2]) +
         " yaw_deg=" + short_number(m.yaw_deg) + " pitch_deg=" + short_number(m.pitch_deg) +
         " roll_deg=" + short_number(m.roll_deg);
}

// "up (-0.20, 0.00, 0.55)": which way a laser looks, and where its mirror is in B.
std::string place_of(const Mount& mount) {
  constexpr std::array<const char*, 5> names{"level", "ahead on edge", "up", "down", "askew"};  // in the order of View
  const Vec3& p = mount.X_BS.translation();
  char text[96];
  std::snprintf(text, sizeof text, "%s (%.2f, %.2f, %.2f)", names[static_cast<size_t>(view_of(mount))], p.x(), p.y(),
                p.z());
  return text;
}

// The lasers of the scenario's rig that stay, and the changes that take the others out.
RigText fixed_rig(const Study& study, const Scenario& s, std::vector<std::string>& off) {
  RigText rig = read_rig(s.sensors.rig);
  change_rig(rig, s.sensors.mounts);
  const auto& fixed = study.mounts.fixed;
  for (const std::string& name : fixed)
    if (std::none_of(rig.lasers.begin(), rig.lasers.end(), [&](const MountText& m) { return m.name == name; }))
      throw Error("mounts.fixed: the rig '" + rig.name + "' has no laser '" + name + "'");
  for (const MountText& m : rig.lasers)
    if (std::find(fixed.begin(), fixed.end(), m.name) == fixed.end()) off.push_back(m.name + " off");
  change_rig(rig, off);
  return rig;
}

void write_placements(const std::string& file, const Search& found, const std::vector<Candidate>& candidates) {
  std::string csv = "rank,value,information,surface,volume,mounts\n";
  for (size_t i = 0; i < found.scored.size(); ++i) {
    const FastScore& s = found.scored[i].score;
    csv += std::to_string(i + 1);
    for (const double v : {s.value, s.information, s.surface, s.volume}) csv += "," + short_number(v);
    csv += ",\"";
    for (const size_t c : found.scored[i].candidate)
      csv += (csv.back() == '"' ? "" : "; ") + change_of(candidates[c].mount);
    csv += "\"\n";
  }
  write_text(file, csv);
}

}  // namespace

std::vector<FastResult> fast_scores(const std::vector<Scenario>& scenarios, const FastSettings& settings,
                                    const std::string& dir, const Progress& progress) {
  const std::string made_by = settings_text(settings);
  std::vector<FastResult> results(scenarios.size());
  std::map<std::string, std::vector<size_t>> by_drive;  // those that are not kept yet
  std::vector<std::string> file(scenarios.size());
  for (size_t i = 0; i < scenarios.size(); ++i) {
    file[i] = dir + "/" + cell_name(geometry_of(scenarios[i])) + ".json";
    if (const auto there = kept(file[i], made_by))
      results[i] = read_fast(*there);
    else
      by_drive[cell_name(drive_of(scenarios[i]))].push_back(i);
  }
  size_t done = 0, all = 0;
  for (const auto& [name, some] : by_drive) all += some.size();
  for (const auto& [name, some] : by_drive) {
    std::unique_ptr<FastCourse> course;
    std::string failure;
    try {
      course = std::make_unique<FastCourse>(scenarios[some[0]], settings);
    } catch (const Error& e) {
      if (e.fault() == Fault::file) throw;
      failure = e.what();
    }
    parallel_for(some.size(), [&](size_t k) {
      FastResult& r = results[some[k]];
      r.failure = failure;
      if (!course) return;
      try {
        r.score = score_rig(*course, load_rig(scenarios[some[k]].sensors));
      } catch (const Error& e) {
        r.failure = e.what();
      }
    });
    for (const size_t i : some) keep(file[i], made_by, written(results[i]));
    progress("fast scores", static_cast<double>(done += some.size()), static_cast<double>(all));
  }
  return results;
}

Placements find_placements(const Study& study, const Scenario& s, const std::string& dir, const Progress& progress) {
  std::vector<std::string> off;
  const RigText fixed_text = fixed_rig(study, s, off);
  Study asked;  // what the search depends on, besides the scenario
  asked.mounts = study.mounts, asked.fast = study.fast, asked.device = study.device;
  asked.price_max = study.price_max, asked.mass_max_kg = study.mass_max_kg, asked.clearance_m = study.clearance_m;
  const std::string made_by = to_toml(asked), file = dir + "/placements-" + cell_name(geometry_of(s)) + ".json";
  if (const auto there = kept(file, made_by))
    return {there->at("mounts").get<std::vector<std::vector<std::string>>>(),
            there->at("labels").get<std::vector<std::string>>(), there->at("words")};

  const FastCourse course(s, study.fast);
  const std::vector<Candidate> candidates = candidates_of(study, course.hull());
  std::vector<Sight> sights(candidates.size()), fixed;
  RigText all{"candidates", {}};
  for (const Candidate& c : candidates) all.lasers.push_back(c.mount);
  const LaserChoice choice{s.sensors.mode, s.sensors.raster, s.sensors.sensitivity};
  const Rig rig = rig_of(all, s.sensors.baud, choice);
  progress("candidate mounts", 0, static_cast<double>(sights.size()));
  parallel_for(sights.size(), [&](size_t i) { sights[i] = course.course().sight(rig.mounts[i], course.hull()); });
  progress("candidate mounts", static_cast<double>(sights.size()), static_cast<double>(sights.size()));
  Budget budget;
  const Device spent = cost_of(study, fixed_text);
  if (study.price_max > 0) budget.price = study.price_max - spent.price;
  if (study.mass_max_kg > 0) budget.mass_kg = study.mass_max_kg - spent.mass_kg;
  if (!fixed_text.lasers.empty())
    for (const Mount& m : rig_of(fixed_text, s.sensors.baud, choice).mounts)
      fixed.push_back(course.course().sight(m, course.hull()));
  const Search found = search(course.course(), candidates, sights, fixed, static_cast<size_t>(study.mounts.count),
                              budget, study.mounts.apart_m);
  write_placements(dir + "/placements.csv", found, candidates);

  std::set<size_t> taken;  // ranks
  const size_t n = found.scored.size();
  for (size_t i = 0; i < std::min(n, static_cast<size_t>(study.mounts.best)); ++i) taken.insert(i);
  for (int i = 1; i <= study.mounts.spread; ++i)
    taken.insert((n - 1) * static_cast<size_t>(i) / static_cast<size_t>(study.mounts.spread));
  Placements placements;
  for (const size_t rank : taken) {
    std::vector<std::string> changes = off;
    std::string label;
    for (const size_t c : found.scored[rank].candidate) {
      changes.push_back(change_of(candidates[c].mount));
      label += (label.empty() ? "" : ", ") + place_of(rig.mounts[c]);
    }
    placements.mounts.push_back(std::move(changes));
    placements.label.push_back(label);
  }
  placements.words =
      std::to_string(candidates.size()) + " candidate mounts; " + std::to_string(found.looked_at) +
      " sets scored from the true geometry, " + std::to_string(n) + " of them of " +
      std::to_string(study.mounts.count) + " lasers, by greed and exchange; " +
      (found.guarantee
           ? "nothing but their number limited the choice, so that greed alone is within 1 - 1/e of the best"
           : "their number alone did not decide (limits took part, or one laser of a view counts), so that no bound on "
             "the best is claimed");
  keep(file, made_by, {{"mounts", placements.mounts}, {"labels", placements.label}, {"words", placements.words}});
  return placements;
}

}  // namespace adit
