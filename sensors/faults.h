// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/recording.h"
#include "base/rig.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace adit {

/// One thing that goes wrong with one laser, by the drive's clock.
struct FaultPlan {
  enum class Kind {
    dies,     // no scans
    freezes,  // the scan before from_s is told again and again
    slips,    // the mount turns in its own frame, for good
    loses,    // a share of the scans is lost
    drifts,   // the stamps run away, for good
    lags,     // the stamps are late, for good
  };
  std::string laser;
  Kind kind = Kind::dies;
  double from_s = 0, to_s = std::numeric_limits<double>::infinity();  // seconds after the drive's begin
  double yaw_rad = 0, pitch_rad = 0, roll_rad = 0;                    // slips
  double share = 0.5;                                                 // loses
  double ppm = 0;                                                     // drifts
  double lag_s = 0;                                                   // lags

  bool covers(double since_begin_s) const { return since_begin_s >= from_s && since_begin_s < to_s; }
};

/// Reads "LASER KIND from_s=A [to_s=B] key=value ..." with kinds and keys (slips: yaw_deg, pitch_deg, roll_deg; loses:
/// share; drifts: ppm; lags: lag_s) of FaultPlan. Errors name the words and what would be right.
std::vector<FaultPlan> parse_faults(const std::vector<std::string>& faults, const Rig& rig);

/// Those of one laser.
std::vector<FaultPlan> faults_of(const std::vector<FaultPlan>& all, const std::string& laser);

/// Whether a scan reaches the log: not those of a dead laser and those that are lost.
/// @param number  of the beat that it begins on
bool survives(double time_s, size_t number, const std::vector<FaultPlan>& faults, double begin_s, size_t mount,
              std::uint64_t seed);
/// How much later than the truth a scan is stamped.
double clock_error_s(double time_s, const std::vector<FaultPlan>& faults, double begin_s);
/// The mount at a time.
Pose slipped_mount(const Pose& X_BS, double time_s, const std::vector<FaultPlan>& faults, double begin_s);
/// Tells the scan before it again wherever a laser is frozen, and marks scans that are frozen, slipped or badly stamped.
/// @param before  the scan before the first of these; empty where there is none
void freeze_and_mark(Scans& scans, ScanTruth& truth, const Scans& before, const std::vector<FaultPlan>& faults,
                     double begin_s);

}  // namespace adit
