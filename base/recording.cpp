// SPDX-License-Identifier: BSD-3-Clause
#include "base/recording.h"

#include "base/error.h"

#include <algorithm>

namespace adit {
namespace {

template <class T>
void put_behind(std::vector<T>& row, const std::vector<T>& later) {
  row.insert(row.end(), later.begin(), later.end());
}

}  // namespace

void append(Log& log, const Log& later) {
  ADIT_CHECK(log.scans.size() == later.scans.size());
  for (size_t i = 0; i < log.scans.size(); ++i) {
    put_behind(log.scans[i].stamp_s, later.scans[i].stamp_s);
    put_behind(log.scans[i].range_m, later.scans[i].range_m);
    put_behind(log.scans[i].code, later.scans[i].code);
    put_behind(log.scans[i].tilt_rad, later.scans[i].tilt_rad);
  }
}

void append(Truth& truth, const Truth& later) {
  ADIT_CHECK(truth.scans.size() == later.scans.size());
  append(truth.drive, later.drive);
  for (size_t i = 0; i < truth.scans.size(); ++i) {
    ScanTruth& to = truth.scans[i];
    const ScanTruth& from = later.scans[i];
    put_behind(to.stamp_s, from.stamp_s);
    put_behind(to.range_m, from.range_m);
    put_behind(to.label, from.label);
    put_behind(to.part, from.part);
    put_behind(to.incidence_rad, from.incidence_rad);
    put_behind(to.face, from.face);
    put_behind(to.passage, from.passage);
    put_behind(to.surfaces, from.surfaces);
    put_behind(to.fault, from.fault);
    put_behind(to.tilt_rad, from.tilt_rad);
  }
}

Scans chosen(const Scans& scans, const std::vector<size_t>& numbers) {
  Scans some;
  some.beams = scans.beams;
  for (const size_t n : numbers) {
    const auto from = static_cast<std::ptrdiff_t>(n) * scans.beams, to = from + scans.beams;
    some.stamp_s.push_back(scans.stamp_s[n]);
    some.range_m.insert(some.range_m.end(), scans.range_m.begin() + from, scans.range_m.begin() + to);
    if (!scans.code.empty()) some.code.insert(some.code.end(), scans.code.begin() + from, scans.code.begin() + to);
    if (!scans.tilt_rad.empty()) some.tilt_rad.push_back(scans.tilt_rad[n]);
  }
  return some;
}

Log level_scans(const Log& log) {
  Log level{log.rig, {}};
  for (const Scans& scans : log.scans) {
    std::vector<size_t> numbers;
    for (size_t n = 0; n < scans.size(); ++n)
      if (scans.tilt_rad.empty() || scans.tilt_rad[n] == 0) numbers.push_back(n);
    level.scans.push_back(chosen(scans, numbers));
    level.scans.back().tilt_rad.clear();
  }
  return level;
}

}  // namespace adit
