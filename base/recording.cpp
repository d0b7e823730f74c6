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

Log level_scans(const Log& log) {
  Log level{log.rig, {}};
  for (const Scans& scans : log.scans) {
    if (scans.tilt_rad.empty()) {
      level.scans.push_back(scans);
      continue;
    }
    Scans kept;
    kept.beams = scans.beams;
    for (size_t n = 0; n < scans.size(); ++n) {
      if (scans.tilt_rad[n] != 0) continue;
      const auto from = static_cast<std::ptrdiff_t>(n) * scans.beams, to = from + scans.beams;
      kept.stamp_s.push_back(scans.stamp_s[n]);
      kept.tilt_rad.push_back(0);
      kept.range_m.insert(kept.range_m.end(), scans.range_m.begin() + from, scans.range_m.begin() + to);
      if (!scans.code.empty()) kept.code.insert(kept.code.end(), scans.code.begin() + from, scans.code.begin() + to);
    }
    level.scans.push_back(std::move(kept));
  }
  return level;
}

}  // namespace adit
