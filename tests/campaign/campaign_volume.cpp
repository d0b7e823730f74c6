// SPDX-License-Identifier: BSD-3-Clause
// Do the mapper's stated 95 % intervals hold: of the volume, of its parts, of each laser's constant range error?
//   campaign_volume FILE [FIRST [LAST]]   a run of `mini` for each seed from FIRST (1) to LAST (100); a line each is
//                                         appended to FILE, what stands there is not run again
// Exit code 1: the interval of the volume holds in less than 90 % of the runs.
#include "base/error.h"
#include "base/parallel.h"
#include "cli/scenario.h"
#include "eval/path_error.h"
#include "eval/volume_error.h"
#include "mapper/stretches.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

namespace {

using namespace adit;

/// What is claimed, how sure, and what is so.
struct Claim {
  double said, sigma, so;
  double sigmas() const { return (said - so) / sigma; }
};

struct Row {
  double observable_m3 = 0, over_m3 = 0, under_m3 = 0;
  Claim whole{};
  std::vector<Claim> bias, parts;
};

std::ostream& operator<<(std::ostream& out, const Claim& c) {
  return out << c.said << ' ' << c.sigma << ' ' << c.so;
}
std::istream& operator>>(std::istream& in, Claim& c) {
  return in >> c.said >> c.sigma >> c.so;
}

std::string text_of(const Row& row) {
  std::ostringstream out;
  out.precision(9);
  out << row.observable_m3 << ' ' << row.over_m3 << ' ' << row.under_m3 << ' ' << row.whole << ' ' << row.bias.size();
  for (const Claim& c : row.bias) out << ' ' << c;
  out << ' ' << row.parts.size();
  for (const Claim& c : row.parts) out << ' ' << c;
  return out.str();
}

Row row_of(const std::string& text) {
  std::istringstream in(text);
  Row row;
  size_t lasers = 0, parts = 0;
  in >> row.observable_m3 >> row.over_m3 >> row.under_m3 >> row.whole >> lasers;
  row.bias.resize(lasers);
  for (Claim& c : row.bias) in >> c;
  in >> parts;
  row.parts.resize(parts);
  for (Claim& c : row.parts) in >> c;
  if (!in) throw Error("not a line of this campaign: " + text.substr(0, 80));
  return row;
}

/// The mean difference between what a laser told and what it met, ranges on edges left out.
double true_bias_m(const Scans& told, const ScanTruth& met) {
  constexpr double edge_m = 0.05;
  double sum = 0, n = 0;
  for (size_t k = 0; k < told.range_m.size(); ++k)
    if (const double off = told.range_m[k] - met.range_m[k]; std::isfinite(off) && std::abs(off) < edge_m)
      sum += off, ++n;
  return n > 0 ? sum / n : 0;
}

std::vector<Claim> biases_of(const Recording& recording, const Estimate& estimate) {
  std::vector<Claim> claims;
  for (const RangeBias& b : estimate.range_bias)
    for (size_t m = 0; m < recording.log.rig.mounts.size(); ++m)
      if (recording.log.rig.mounts[m].name == b.laser)
        claims.push_back({b.bias_m, b.sigma_m, true_bias_m(recording.log.scans[m], recording.truth.scans[m])});
  return claims;
}

/// Volumes of a solid in W by the stretch of the path in M that is nearest.
std::vector<double> by_stretch(const Dexels& solid, const Stretches& stretches, const Pose& X_MW) {
  std::vector<double> volume_m3(stretches.all().size(), 0);
  for (int j = 0; j < solid.height; ++j)
    for (int i = 0; i < solid.width; ++i) {
      double height_m = 0;
      for (const Interval& s : solid.column(i, j)) height_m += s.high_m - s.low_m;
      if (height_m == 0) continue;
      const Vec2 axis = solid.axis(i, j);
      const Vec3 p_M = X_MW * Vec3(axis.x(), axis.y(), 0);
      volume_m3[stretches.nearest(p_M.head<2>())] += height_m * solid.cell_m * solid.cell_m;
    }
  return volume_m3;
}

Row judged(const World& world, const Recording& recording, const Estimate& estimate, const ScoreSettings& settings) {
  const TrueScans scans(recording.truth, world.mesh);
  const Patches patches(world.mesh, settings.patch_m, recording.truth.drive.path.X_WB.front());
  const Observable observable = observable_surface(patches, scans, world.mesh.face.size(), 80 * std::acos(-1.0) / 180);
  const VolumeDomain domain = volume_domain(world.mesh, patches, observable, scans, settings, {});
  const PathMatch match = associate(recording.truth.drive.path, estimate.path, Pose::Identity(), settings.max_gap_s);
  const Pose X_WM = align_se3(match).X_WM;
  Mesh laid = estimate.surface;
  for (Vec3& v : laid.vertex) v = X_WM * v;
  const Dexels mapped = dexels_of(laid, domain.swept);
  // What is void: all that could be seen, and what the map claims besides.
  const Dexels so = unite(domain.swept, intersect(mapped, domain.space));

  Row row;
  row.observable_m3 = domain.swept.volume_m3();
  row.over_m3 = intersect(mapped, domain.rock).volume_m3();
  row.under_m3 = row.observable_m3 - intersect(mapped, domain.swept).volume_m3();
  row.whole = {*estimate.volume_m3, *estimate.volume_sigma_m3, so.volume_m3()};
  row.bias = biases_of(recording, estimate);
  const Stretches stretches(estimate.path);
  const std::vector<double> of_stretch = by_stretch(so, stretches, X_WM.inverse());
  for (size_t k = 0; k < std::min(of_stretch.size(), estimate.volume_parts.size()); ++k)
    row.parts.push_back({estimate.volume_parts[k].volume_m3, estimate.volume_parts[k].sigma_m3, of_stretch[k]});
  return row;
}

std::string outcome_of(int seed) {
  try {
    Scenario s = load_scenario("mini");
    s.seed = seed;
    const auto address = static_cast<std::uint64_t>(seed);
    const World world = make_world(s.world, address);
    const Vehicle vehicle = load_vehicle(s.vehicle);
    const Drive driven = drive(world, plan_route(world, s.route, address), vehicle, s.drive, address);
    const Recording recording = record(world, driven, load_rig(s.sensors), vehicle.hull, s.sensors, address);
    const Estimate estimate = make_map(recording.log, s.map);
    if (!estimate.volume_m3) return "without a volume";
    return text_of(judged(world, recording, estimate, s.score));
  } catch (const Error& e) {
    return std::string("error: ") + e.what();
  }
}

struct Tally {
  int n = 0, held = 0;
  double squares = 0, off_squares = 0;

  void add(const Claim& c) {
    ++n;
    held += std::abs(c.sigmas()) <= 1.96;
    squares += c.sigmas() * c.sigmas();
    off_squares += std::pow(c.said - c.so, 2);
  }
  void print(const char* what, double unit, const char* unit_name) const {
    std::printf("%s: interval holds in %d of %d (%.1f %%), error in sigmas %.2f rms, error %.3g %s rms\n", what, held,
                n, n ? 100.0 * held / n : 0.0, n ? std::sqrt(squares / n) : 0.0,
                n ? unit * std::sqrt(off_squares / n) : 0.0, unit_name);
  }
};

std::map<int, std::string> known(const std::string& file) {
  std::map<int, std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);)
    if (const size_t tab = line.find('\t'); tab != std::string::npos)
      lines[std::atoi(line.c_str())] = line.substr(tab + 1);
  return lines;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "usage: campaign_volume FILE [FIRST [LAST]]\n");
    return 2;
  }
  const int first = argc > 2 ? std::atoi(argv[2]) : 1, last = argc > 3 ? std::atoi(argv[3]) : 100;
  std::map<int, std::string> done = known(argv[1]);
  Tally whole, bias, parts;
  double net = 0, both = 0;
  int failed = 0;
  for (int seed = first; seed <= last; ++seed) {
    if (!done.count(seed)) {
      done[seed] = outcome_of(seed);
      std::ofstream(argv[1], std::ios::app) << seed << '\t' << done[seed] << std::endl;
    }
    try {
      const Row row = row_of(done[seed]);
      whole.add(row.whole);
      for (const Claim& c : row.bias) bias.add(c);
      for (const Claim& c : row.parts) parts.add(c);
      net += (row.over_m3 - row.under_m3) / row.observable_m3;
      both += (row.over_m3 + row.under_m3) / row.observable_m3;
    } catch (const Error&) {
      std::printf("seed %d: %s\n", seed, done[seed].c_str());
      ++failed;
    }
  }
  whole.print("volume", 1, "m3");
  parts.print("volume of a part", 1, "m3");
  bias.print("range error of a laser", 1000, "mm");
  std::printf("%d runs without a result; net error %.2f %%, over- and under-break %.2f %% on the mean\n", failed,
              whole.n ? 100 * net / whole.n : 0.0, whole.n ? 100 * both / whole.n : 0.0);
  return whole.n > 0 && whole.held >= 0.9 * whole.n ? 0 : 1;
}
