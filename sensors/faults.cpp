// SPDX-License-Identifier: BSD-3-Clause
#include "sensors/faults.h"

#include "base/error.h"
#include "base/rng.h"
#include "sensors/noise.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <sstream>

namespace adit {
namespace {

using Kind = FaultPlan::Kind;
constexpr double degree = std::numbers::pi / 180;

const std::map<std::string, Kind> kinds{{"dies", Kind::dies},   {"freezes", Kind::freezes}, {"slips", Kind::slips},
                                        {"loses", Kind::loses}, {"drifts", Kind::drifts},   {"lags", Kind::lags}};

bool for_good(Kind kind) {
  return kind == Kind::slips || kind == Kind::drifts || kind == Kind::lags;
}

struct Key {
  double* value;
  double unit, min, max;
};

std::map<std::string, Key> keys_of(FaultPlan& f) {
  std::map<std::string, Key> keys{{"from_s", {&f.from_s, 1, 0, 1e9}}};
  if (!for_good(f.kind)) keys["to_s"] = {&f.to_s, 1, 0, 1e9};
  if (f.kind == Kind::slips)
    for (const auto& [name, value] :
         {std::pair{"yaw_deg", &f.yaw_rad}, {"pitch_deg", &f.pitch_rad}, {"roll_deg", &f.roll_rad}})
      keys[name] = {value, degree, -180, 180};
  if (f.kind == Kind::loses) keys["share"] = {&f.share, 1, 0, 1};
  // Faster clocks than these would need stamps that go backwards between two scans of the fast link.
  if (f.kind == Kind::drifts) keys["ppm"] = {&f.ppm, 1, -10000, 10000};
  if (f.kind == Kind::lags) keys["lag_s"] = {&f.lag_s, 1, 0, 10};
  return keys;
}

std::string names_of(const auto& map) {
  std::string names;
  for (const auto& [name, value] : map) names += (names.empty() ? "" : ", ") + name;
  return names;
}

FaultPlan parse_fault(const std::string& text, const Rig& rig) {
  const auto fail = [&](const std::string& what) { throw Error("sensors.faults: \"" + text + "\": " + what); };
  std::istringstream words(text);
  FaultPlan f;
  std::string kind;
  words >> f.laser >> kind;
  std::map<std::string, int> lasers;
  for (const Mount& mount : rig.mounts) lasers[mount.name] = 0;
  if (!lasers.contains(f.laser)) fail("the rig has no laser '" + f.laser + "'; it has " + names_of(lasers));
  if (!kinds.contains(kind)) fail("'" + kind + "' is no fault; there are " + names_of(kinds));
  f.kind = kinds.at(kind);
  const std::map<std::string, Key> keys = keys_of(f);
  for (std::string word; words >> word;) {
    const size_t equals = std::min(word.find('='), word.size());
    const auto key = keys.find(word.substr(0, equals));
    if (key == keys.end()) fail("'" + word.substr(0, equals) + "' does not belong here; there are " + names_of(keys));
    const std::string number = word.substr(std::min(equals + 1, word.size()));
    char* end = nullptr;
    const double value = std::strtod(number.c_str(), &end);
    const Key& k = key->second;
    if (number.empty() || *end || !(value >= k.min && value <= k.max))
      fail("'" + word + "' must be a number from " + std::to_string(k.min) + " to " + std::to_string(k.max));
    *k.value = value * k.unit;
  }
  if (!(f.to_s > f.from_s)) fail("to_s must be greater than from_s");
  return f;
}

}  // namespace

std::vector<FaultPlan> parse_faults(const std::vector<std::string>& faults, const Rig& rig) {
  std::vector<FaultPlan> all;
  for (const std::string& text : faults) all.push_back(parse_fault(text, rig));
  return all;
}

std::vector<FaultPlan> faults_of(const std::vector<FaultPlan>& all, const std::string& laser) {
  std::vector<FaultPlan> own;
  for (const FaultPlan& f : all)
    if (f.laser == laser) own.push_back(f);
  return own;
}

bool survives(double time_s, size_t number, const std::vector<FaultPlan>& faults, double begin_s, size_t mount,
              std::uint64_t seed) {
  for (size_t i = 0; i < faults.size(); ++i) {
    const FaultPlan& f = faults[i];
    if (!f.covers(time_s - begin_s)) continue;
    if (f.kind == Kind::dies) return false;
    if (f.kind == Kind::loses && uniform(seed, Draw::fault_loss, scan_address(mount, number), i) < f.share)
      return false;
  }
  return true;
}

double clock_error_s(double time_s, const std::vector<FaultPlan>& faults, double begin_s) {
  double late_s = 0;
  for (const FaultPlan& f : faults) {
    const double since_s = time_s - begin_s;
    if (!f.covers(since_s)) continue;
    if (f.kind == Kind::drifts) late_s += 1e-6 * f.ppm * (since_s - f.from_s);
    if (f.kind == Kind::lags) late_s += f.lag_s;
  }
  return late_s;
}

Pose slipped_mount(const Pose& X_BS, double time_s, const std::vector<FaultPlan>& faults, double begin_s) {
  Pose X = X_BS;
  for (const FaultPlan& f : faults)
    if (f.kind == Kind::slips && f.covers(time_s - begin_s))
      X = X * pose_of(Vec3::Zero(), f.yaw_rad, f.pitch_rad, f.roll_rad);
  return X;
}

void freeze_and_mark(Scans& scans, ScanTruth& truth, const Scans& before, const std::vector<FaultPlan>& faults,
                     double begin_s) {
  const auto beams = static_cast<std::ptrdiff_t>(scans.beams);
  for (size_t n = 0; n < scans.size(); ++n) {
    std::uint8_t mark = 0;
    bool frozen = false;
    for (const FaultPlan& f : faults) {
      if (!f.covers(truth.stamp_s[n] - begin_s)) continue;
      frozen = frozen || f.kind == Kind::freezes;
      if (f.kind == Kind::slips) mark |= trouble::slipped;
      if (f.kind == Kind::drifts || f.kind == Kind::lags) mark |= trouble::clock;
    }
    const auto row = static_cast<std::ptrdiff_t>(n) * beams;
    // A laser that is frozen from its first scan on tells that one.
    if (frozen && (n > 0 || before.size() > 0)) {
      const Scans& from = n > 0 ? scans : before;
      const auto last = n > 0 ? row - beams : 0;
      std::copy_n(from.range_m.begin() + last, beams, scans.range_m.begin() + row);
      std::copy_n(from.code.begin() + last, beams, scans.code.begin() + row);
      mark |= trouble::frozen;
    }
    if (mark)
      for (std::ptrdiff_t k = row; k < row + beams; ++k) truth.fault[static_cast<size_t>(k)] |= mark;
  }
}

}  // namespace adit
