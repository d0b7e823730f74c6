// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/hull.h"
#include "base/recording.h"
#include "base/rng.h"
#include "rays/caster.h"
#include "sensors/device.h"
#include "sensors/echo.h"
#include "sensors/fan.h"
#include "sensors/settings.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace adit {

class Motion;

/// When the scans of a mount truly begin: from begin_s + phase, an interval apart, later by whole mirror scans where
/// the link loses some. The last one ends before end_s.
std::vector<double> scan_times(const Mount& mount, size_t index, double begin_s, double end_s,
                               const SensorSettings& settings, std::uint64_t seed);

/// One laser on its way through a mine: fires whole scans into the arrays of a recording.
class Sweep {
 public:
  /// The mount is the true one; everything given must outlive this.
  Sweep(const Caster& caster, const Trajectory& path, const Mount& mount, size_t index, const Hull& hull,
        const SensorSettings& settings, std::uint64_t seed);

  /// Fires scans [begin, end), which start at truth.stamp_s, into rows begin to end of arrays that are large enough
  /// already. Safe to call from many threads for different rows.
  void fire(size_t begin, size_t end, Scans& scans, ScanTruth& truth) const;

 private:
  struct Shot;  // what one scan needs on its way

  void aim(double time_s, std::uint64_t scan, Motion& motion, Shot& shot) const;
  void cast(Shot& shot) const;
  Meeting axis_meeting(size_t beam, const Shot& shot) const;
  bool gather(size_t beam, const Meeting& axis, Shot& shot) const;
  void tell(size_t beam, size_t scan, Shot& shot, Scans& scans, ScanTruth& truth) const;
  void dazzle(size_t scan, Scans& scans, const ScanTruth& truth) const;

  const Caster* caster_;
  const Trajectory* path_;
  const Mount* mount_;
  size_t index_;
  const SensorSettings* settings_;
  std::uint64_t seed_;
  Draws draws_;
  Device device_;
  Bundle bundle_;
  MountFan fan_;
  std::optional<Label> water_;
};

}  // namespace adit
