// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/mesh.h"
#include "base/recording.h"

#include <cstddef>
#include <vector>

namespace adit {

/// One noise-free beam in W.
struct TrueBeam {
  Vec3 origin, direction;
  double range_m;  // to what it met
  double incidence_rad;
  std::int32_t face;  // of the world's mesh
  bool met;           // the mine's surface, near and bright enough for an echo; else the vehicle, or nothing to be seen

  Vec3 end() const { return origin + range_m * direction; }
};

/// What the lasers would have told without noise: every beam from the true pose of its true mount. An echo comes back from
/// within the mode's range where reflectivity * cos(incidence) reaches the least that the laser's sheet states there; a mesh
/// that states no reflectivity echoes everywhere. Truth and mesh must outlive it.
class TrueScans {
 public:
  /// Error where the arrays of the truth do not fit each other.
  TrueScans(const Truth& truth, const Mesh& mesh);

  size_t lasers() const { return truth_->scans.size(); }
  size_t scans(size_t laser) const { return truth_->scans[laser].stamp_s.size(); }
  const Mount& mount(size_t laser) const { return truth_->rig.mounts[laser]; }
  const ScanTruth& truth(size_t laser) const { return truth_->scans[laser]; }
  /// Pose of the laser when the scan begins.
  Pose X_WS(size_t laser, size_t scan) const;
  TrueBeam beam(size_t laser, size_t scan, int k) const;
  /// Every step-th beam of a scan, the first one included.
  std::vector<TrueBeam> fan(size_t laser, size_t scan, int step) const;

 private:
  const Truth* truth_;
  const Mesh* mesh_;

  bool echoes(const LaserModel& laser, std::int32_t face, double range_m, double incidence_rad) const;
};

}  // namespace adit
