// SPDX-License-Identifier: BSD-3-Clause
#include "base/drive.h"

#include <utility>

namespace adit {

std::string drive_end_name(DriveEnd end) {
  switch (end) {
    case DriveEnd::finished:
      return "finished";
    case DriveEnd::stuck:
      return "stuck";
    case DriveEnd::tipped:
      return "tipped";
    case DriveEnd::fell:
      return "fell";
    case DriveEnd::blocked:
      return "blocked";
    case DriveEnd::underway:
      return "under way";
  }
  return "unknown";
}

void append(Drive& drive, const Drive& later) {
  Trajectory path = std::move(drive.path);
  path.stamp_s.insert(path.stamp_s.end(), later.path.stamp_s.begin(), later.path.stamp_s.end());
  path.X_WB.insert(path.X_WB.end(), later.path.X_WB.begin(), later.path.X_WB.end());
  drive = {later.route, std::move(path), later.end, later.cause, later.driven_m, later.ground};
}

}  // namespace adit
