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
#include "sensors/noise.h"
#include "sensors/settings.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace adit {

/// When the scans of a mount truly begin: from begin_s + phase, an interval apart, later by whole mirror scans where
/// the link loses some.
class Beat {
 public:
  Beat(const Mount& mount, size_t index, double begin_s, const SensorSettings& settings, std::uint64_t seed);

  size_t number() const { return number_; }
  double time_s() const;
  /// From a scan's begin to its last beam.
  double scan_s() const { return scan_s_; }
  void next();

 private:
  double from_s_, interval_s_, mirror_scan_s_, late_, scan_s_ = 0;
  size_t index_, number_ = 0, lost_ = 0;
  std::uint64_t seed_;
};

/// One laser on its way through a mine: fires whole scans into the arrays of a recording.
class Sweep {
 public:
  /// The mount is the true one, switched on at begin_s; everything given must outlive this.
  Sweep(const Caster& caster, const Trajectory& path, const Mount& mount, size_t index, const Hull& hull,
        const SensorSettings& settings, double begin_s, std::uint64_t seed);

  /// Fires scans that start at truth.stamp_s[begin] to truth.stamp_s[end - 1] into those rows of arrays that are large
  /// enough already. Row 0 is scan `first` of the laser's drive. Safe to call from many threads for different rows.
  void fire(size_t begin, size_t end, size_t first, Scans& scans, ScanTruth& truth) const;

 private:
  struct Shot;

  MountFan tilted_fan(double tilt_rad) const;
  void aim(const Aim& aim, double time_s, std::uint64_t scan, size_t at, const Places& places, Motion& motion,
           Shot& shot) const;
  void spread(const Places& places, Shot& shot) const;
  double reflectivity_of(std::int32_t face) const;
  void look_up(const MountFan& fan, const Places& places, size_t row, Shot& shot, ScanTruth& truth) const;
  Meeting meeting(const Meeting& own, const Hit& hit) const;
  bool gather(const MountFan& fan, size_t beam, size_t at, Shot& shot) const;
  bool mirror(const MountFan& fan, size_t beam, size_t at, Shot& shot) const;
  void read(const MountFan& fan, size_t at, const Places& places, const BeamAddress& first, double on_s,
            Shot& shot) const;
  void tell(const MountFan& fan, size_t at, const Places& places, std::uint64_t scan, size_t row, Shot& shot,
            Scans& scans, ScanTruth& truth) const;
  void dazzle(size_t row, Scans& scans, const ScanTruth& truth) const;

  const Caster* caster_;
  const Trajectory* path_;
  const Mount* mount_;
  const Hull* hull_;
  size_t index_;
  const SensorSettings* settings_;
  double begin_s_;
  std::uint64_t seed_;
  Draws draws_;
  Device device_;
  Bundle bundle_;
  struct {
    std::vector<float> x, y, shorter;  // of the rays beside the axis: place in the unit disc; what makes them unit long
  } other_;
  MountFan fan_;  // while the mount is level
  Aim aim_;
  const float* reflectivity_ = nullptr;  // of the faces, where the mine states any
  std::optional<Label> water_;           // where the mine has any
};

}  // namespace adit
