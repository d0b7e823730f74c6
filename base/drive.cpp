// SPDX-License-Identifier: BSD-3-Clause
#include "base/drive.h"

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
  }
  return "unknown";
}

}  // namespace adit
