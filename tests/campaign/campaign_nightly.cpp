// SPDX-License-Identifier: BSD-3-Clause
// What the verdict of `adit nightly` is worth on real scores: small faults are put into lasers and mapper, seed by seed.
//   campaign_nightly FILE [SEEDS [MORE]]   every variant of SEEDS seeds (16), the sound one of MORE besides (24); rows are
//                                          appended to FILE, one a score; what stands there is not made again
// Then the bundled suite `nightly` judges: 200 times two halves of the sound runs against each other, where every alarm is
// false; and 100 times each fault with seeds drawn with replacement, for several numbers of seeds.
// Exit code 1: more than 5 % false alarms.
#include "base/error.h"
#include "base/rng.h"
#include "cli/suite.h"

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
      {"matcher iterations cut to 3", {"map.odometry.match.iterations=3"}},
      {"loops not verified", {"map.robust.agree_share=0", "map.robust.drop_weight=0"}}};
  return all;
}

const std::vector<std::string> panel{"world.panel.crosscuts=2"};

Scenario scenario_of(const Variant& v, int seed) {
  std::vector<std::string> assignments = panel;
  assignments.insert(assignments.end(), v.assignments.begin(), v.assignments.end());
  Scenario s = load_scenario("mini", assignments);
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
    n.cells.push_back({"panel", "adit", static_cast<int>(k), "the same", "", "", 0, scores[drawn[k]]});
  return n;
}

Verdict verdict_of(const Night& before, const Night& now) {
  static const Suite suite = load_suite("nightly");
  std::vector<Night> past{before};
  past[0].verdict = "first";
  return judge(now, past, suite.rules);
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

int tell(const std::string& file, int seeds, int more) {
  const Table table = read_rows(file, seeds + more);
  if (!table.contains("sound")) return 1;
  const std::vector<Values>& sound = table.at("sound");
  const size_t half = std::min<size_t>(16, sound.size() / 2);
  const double alarms = false_alarms(sound, half);
  std::printf("false alarms: %.1f %% of 200 resamples of %zu sound runs, %zu against %zu\n", 100 * alarms, sound.size(),
              half, half);
  for (const Variant& v : variants()) {
    if (v.name == "sound" || !table.contains(v.name)) continue;
    std::printf("%-30s %2zu seeds made; power", v.name.c_str(), table.at(v.name).size());
    std::string best;
    for (const size_t n : {11, 12, 16}) {
      const auto [share, metric] = power(sound, table.at(v.name), n);
      std::printf("  %.2f at %zu", share, n);
      best = metric;
    }
    std::printf("  by %s\n", best.c_str());
  }
  return alarms <= 0.05 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: campaign_nightly FILE [SEEDS [MORE]]\n");
    return 2;
  }
  const int seeds = argc > 2 ? std::atoi(argv[2]) : 16, more = argc > 3 ? std::atoi(argv[3]) : 24;
  std::set<std::string> done = known(argv[1]);
  for (int seed = 1; seed <= seeds + more; ++seed)
    make_rows(argv[1], seed, seed <= seeds ? variants().size() : 1, done);
  return tell(argv[1], seeds, more);
}
