// SPDX-License-Identifier: BSD-3-Clause
// What the verdict of `adit nightly` is worth on real scores: small faults are put into lasers and mapper, seed by seed.
//   campaign_nightly FILE [SEEDS [MORE]]   every variant of SEEDS seeds (16), the sound one of MORE besides (24); rows are
//                                          appended to FILE, one a score; what stands there is not made again
// Then the bundled suite `nightly` judges: 200 times two halves of the sound runs against each other, where every alarm is
// false; and 100 times each fault with seeds drawn with replacement, for several numbers of seeds, up to that with which
// 9 of 10 are caught. A fault that leaves scores as they are says in how many seeds it changed any.
//   campaign_nightly --simulated           the same questions to simulated nights (tests/eval/simulated_nights.h)
// Exit code 1: more than 5 % false alarms.
#include "base/error.h"
#include "base/rng.h"
#include "cli/suite.h"
#include "tests/eval/simulated_nights.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

namespace {

using namespace adit;

struct Variant {
  std::string name;
  std::vector<std::string> assignments;
};

// The first is sound.
const std::vector<Variant>& variants() {
  static const std::vector<Variant> all{
      {"sound", {}},
      {"range + 5 mm", {"sensors.range_offset_m=0.005"}},
      {"noise x 1.1", {"sensors.noise_scale=1.1"}},
      {"front laser yawed by 0.2 deg", {R"(sensors.faults=["front slips from_s=0 yaw_deg=0.2"])"}},
      {"matcher iterations halved", {"map.odometry.match.iterations=10"}},
      {"loops not verified", {"map.robust.agree_share=0", "map.robust.drop_weight=0"}}};
  return all;
}

const Suite& suite() {
  static const Suite nightly = load_suite("nightly");
  return nightly;
}

Scenario scenario_of(const Variant& v, int seed) {
  const Suite::Part& panel = suite().scenario.front();
  std::vector<std::string> assignments = panel.set;
  assignments.insert(assignments.end(), v.assignments.begin(), v.assignments.end());
  Scenario s = load_scenario(panel.scenario, assignments);
  s.seed = seed;
  return s;
}

std::string row_of(const Scenario& s, const World& world, const Drive& driven, const Vehicle& vehicle) {
  const Rig rig = load_rig(s.sensors);
  const Recording recording = record(world, driven, rig, vehicle.hull, s.sensors, static_cast<std::uint64_t>(s.seed));
  const Score score = score_map(world, recording.truth, recording.log.rig, make_map(recording.log, s.map), s.score);
  std::ostringstream row;
  row.precision(9);
  for (const Metric& m : score.metrics)
    if (std::isfinite(m.value))
      row << '\t' << m.name << ' ' << m.unit << ' ' << better_name(m.better) << ' ' << m.value;
  return row.str();
}

std::string key_of(const Variant& v, int seed) {
  return v.name + " seed " + std::to_string(seed);
}

void make_rows(const std::string& file, int seed, size_t count, std::set<std::string>& done) {
  bool missing = false;
  for (size_t k = 0; k < count; ++k) missing |= !done.contains(key_of(variants()[k], seed));
  if (!missing) return;
  const Scenario sound = scenario_of(variants()[0], seed);
  const auto chance = static_cast<std::uint64_t>(seed);
  const World world = make_world(sound.world, chance);
  const Vehicle vehicle = load_vehicle(sound.vehicle);
  const Drive driven = drive(world, plan_route(world, sound.route, chance), vehicle, sound.drive, chance);
  for (size_t k = 0; k < count; ++k) {
    const std::string key = key_of(variants()[k], seed);
    if (!done.insert(key).second) continue;
    std::string row;
    try {
      row = row_of(scenario_of(variants()[k], seed), world, driven, vehicle);
    } catch (const Error& e) {
      row = std::string("\tfailed: ") + e.what();
    }
    std::ofstream(file, std::ios::app) << key << row << std::endl;
    std::fprintf(stderr, "%s\n", key.c_str());
  }
}

std::set<std::string> known(const std::string& file) {
  std::set<std::string> keys;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) keys.insert(line.substr(0, line.find('\t')));
  return keys;
}

using Values = std::map<std::string, double>;
using Table = std::map<std::string, std::vector<Values>>;  // by variant: its scores, seed by seed

Table read_rows(const std::string& file, int seeds) {
  Table table;
  std::map<std::string, Values> rows;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream cells(line);
    std::string key, cell;
    std::getline(cells, key, '\t');
    while (std::getline(cells, cell, '\t')) {
      std::istringstream words(cell);
      std::string name, unit, better;
      if (double value = 0; words >> name >> unit >> better >> value) rows[key][name] = value;
    }
  }
  for (const Variant& v : variants())
    for (int seed = 1; seed <= seeds; ++seed)
      if (const auto row = rows.find(key_of(v, seed)); row != rows.end()) table[v.name].push_back(row->second);
  return table;
}

Night night_of(const std::vector<Values>& scores, const std::vector<size_t>& drawn) {
  Night n;
  for (size_t k = 0; k < drawn.size(); ++k)
    n.cells.push_back(
        {suite().scenario.front().name, "adit", static_cast<int>(k), "the same", "", "", 0, scores[drawn[k]]});
  return n;
}

Verdict verdict_of(const Night& before, const Night& now) {
  std::vector<Night> past{before};
  past[0].verdict = "first";
  return judge(now, past, suite().rules);
}

double false_alarms(const std::vector<Values>& sound, size_t seeds) {
  int alarms = 0;
  for (std::uint64_t t = 0; t < 200; ++t) {
    std::vector<size_t> order(sound.size());
    for (size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
      return random_bits(t, Draw::bootstrap, a) < random_bits(t, Draw::bootstrap, b);
    });
    const auto middle = order.begin() + static_cast<std::ptrdiff_t>(seeds);
    alarms += verdict_of(night_of(sound, {order.begin(), middle}),
                         night_of(sound, {middle, middle + static_cast<std::ptrdiff_t>(seeds)}))
                  .exit_code == 1;
  }
  return alarms / 200.0;
}

// Share of 100 draws of so many seeds that raise an alarm, and the metric that does so most often.
std::pair<double, std::string> power(const std::vector<Values>& sound, const std::vector<Values>& faulty,
                                     size_t seeds) {
  int caught = 0;
  std::map<std::string, int> by;
  for (std::uint64_t t = 0; t < 100; ++t) {
    std::vector<size_t> drawn;
    for (size_t k = 0; k < seeds; ++k)
      drawn.push_back(static_cast<size_t>(uniform(t, Draw::bootstrap, k) * static_cast<double>(faulty.size())));
    const Verdict v = verdict_of(night_of(sound, drawn), night_of(faulty, drawn));
    caught += v.exit_code == 1;
    for (const Claim& c : v.claims)
      if (c.kind == "regressed") ++by[c.metric];
  }
  std::string best = "-";
  for (const auto& [metric, count] : by)
    if (best == "-" || count > by[best]) best = metric;
  return {caught / 100.0, best};
}

// Seeds in which a variant changed anything at all that the suite watches.
size_t changed(const std::vector<Values>& sound, const std::vector<Values>& faulty) {
  size_t n = 0;
  for (size_t k = 0; k < std::min(sound.size(), faulty.size()); ++k)
    n += std::any_of(suite().rules.metric.begin(), suite().rules.metric.end(), [&](const SuiteMetric& m) {
      const auto a = sound[k].find(m.name), b = faulty[k].find(m.name);
      return (a == sound[k].end()) != (b == faulty[k].end()) || (a != sound[k].end() && a->second != b->second);
    });
  return n;
}

void tell_fault(const Variant& v, const std::vector<Values>& sound, const std::vector<Values>& faulty) {
  std::printf("%-30s %zu of %zu seeds changed; power", v.name.c_str(), changed(sound, faulty), faulty.size());
  std::string best;
  const auto own =
      static_cast<size_t>(suite().scenario.front().seeds > 0 ? suite().scenario.front().seeds : suite().seeds);
  for (const size_t n : {size_t{11}, size_t{12}, size_t{16}, size_t{20}, size_t{24}, size_t{32}}) {
    const auto [share, metric] = power(sound, faulty, n);
    std::printf("  %.2f at %zu", share, n);
    std::fflush(stdout);
    best = metric;
    if (n >= own && share >= 0.9) break;
  }
  std::printf("  by %s\n", best.c_str());
}

int tell(const std::string& file, int seeds, int more) {
  const Table table = read_rows(file, seeds + more);
  if (!table.contains("sound")) return 1;
  const std::vector<Values>& sound = table.at("sound");
  const size_t half = std::min<size_t>(16, sound.size() / 2);
  const double alarms = false_alarms(sound, half);
  std::printf("false alarms: %.1f %% of 200 resamples of %zu sound runs, %zu against %zu\n", 100 * alarms, sound.size(),
              half, half);
  for (const Variant& v : variants())
    if (v.name != "sound" && table.contains(v.name)) tell_fault(v, sound, table.at(v.name));
  return alarms <= 0.05 ? 0 : 1;
}

// Twenty nights in which nothing happens, and what is said of the last one.
Verdict quiet_night(std::uint64_t chance) {
  Simulation s;
  s.chance = chance;
  std::vector<Night> past;
  for (int k = 1; k <= 20; ++k) {
    past.push_back(s.night(k));
    past.back().verdict = "pass";
  }
  return judge(s.night(21), past, s.rules());
}

// One of ten metrics is worse by `factor` after eight nights.
bool caught(std::uint64_t chance, int seeds, double factor) {
  Simulation s;
  s.chance = chance, s.seeds = seeds;
  s.factor = [&](int metric, int night) { return metric == 3 && night == 9 ? factor : 1.0; };
  std::vector<Night> past;
  for (int k = 1; k <= 8; ++k) {
    past.push_back(s.night(k));
    past.back().verdict = "pass";
  }
  for (const MetricVerdict& m : judge(s.night(9), past, s.rules()).metric)
    if (m.metric.name == "m3") return m.kind == "regressed";
  return false;
}

int tell_simulated() {
  constexpr int quiet = 2000, shifted = 200;
  int alarms = 0, joys = 0;
  for (int t = 0; t < quiet; ++t) {
    const Verdict v = quiet_night(10000 + static_cast<std::uint64_t>(t));
    alarms += v.exit_code == 1, joys += v.verdict == "improved";
  }
  std::printf("%d quiet nights: %.2f %% alarms (5 %% stated), %.2f %% improvements (2.5 %%)\n", quiet,
              100.0 * alarms / quiet, 100.0 * joys / quiet);
  for (const double factor : {1.02, 1.03}) {
    std::printf("one of ten metrics worse by %.0f %%, noise 1 %% with tails: power", 100 * (factor - 1));
    for (const int seeds : {12, 16, 20, 24}) {
      int found = 0;
      for (int t = 0; t < shifted; ++t) found += caught(50000 + static_cast<std::uint64_t>(t), seeds, factor);
      std::printf("  %.2f at %d", static_cast<double>(found) / shifted, seeds);
      std::fflush(stdout);
    }
    std::printf("\n");
  }
  return alarms <= 0.05 * quiet ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string(argv[1]) == "--simulated") return tell_simulated();
  if (argc < 2) {
    std::fprintf(stderr, "usage: campaign_nightly FILE [SEEDS [MORE]] | --simulated\n");
    return 2;
  }
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 16, more = argc > 3 ? std::atoi(argv[3]) : 24;
  std::set<std::string> done = known(argv[1]);
  for (int seed = 1; seed <= seeds + more; ++seed)
    make_rows(argv[1], seed, seed <= seeds ? variants().size() : 1, done);
  return tell(argv[1], seeds, more);
}
