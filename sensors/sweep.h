// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/hull.h"
#include "base/recording.h"
#include "base/rng.h"
#include "rays/caster.h"
#include "sensors/aim.h"
#include "sensors/device.h"
#include "sensors/echo.h"
#include "sensors/fan.h"
#include "sensors/settings.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace adit {

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

  /// Fires scans that start at truth.stamp_s[begin] to truth.stamp_s[end - 1] into those rows of arrays that are large
  /// enough already. Row 0 is scan `first` of the laser's drive. Safe to call from many threads for different rows.
  void fire(size_t begin, size_t end, size_t first, Scans& scans, ScanTruth& truth) const;

 private:
  struct Shot;

  MountFan tilted_fan(double tilt_rad) const;
  void aim(const Aim& aim, double time_s, std::uint64_t scan, size_t at, Motion& motion, Shot& shot) const;
  void spread(size_t at, Shot& shot) const;
  Meeting meeting(const Meeting& own, double range_m, std::int32_t face, double cosine) const;
  bool gather(const MountFan& fan, size_t beam, size_t at, const Meeting& axis, Shot& shot) const;
  bool mirror(const MountFan& fan, size_t beam, size_t at, const Meeting& axis, Shot& shot) const;
  void tell(const MountFan& fan, size_t at, std::uint64_t scan, size_t row, Shot& shot, Scans& scans,
            ScanTruth& truth) const;
  void dazzle(size_t row, Scans& scans, const ScanTruth& truth) const;

  const Caster* caster_;
  const Trajectory* path_;
  const Mount* mount_;
  const Hull* hull_;
  size_t index_;
  const SensorSettings* settings_;
  std::uint64_t seed_;
  Draws draws_;
  Device device_;
  Bundle bundle_;
  struct {
    std::vector<float> x, y, shorter;  // of the rays beside the axis: place in the unit disc; what makes them unit long
  } other_;
  MountFan fan_;  // while the mount is level
  Aim aim_;
  std::optional<Label> water_;  // where the mine has any
};

}  // namespace adit
