// SPDX-License-Identifier: BSD-3-Clause
#include "cli/scores.h"

#include <cmath>
#include <cstdio>

namespace adit {

const std::vector<std::string>& headline_metrics() {
  static const std::vector<std::string> names = {"trajectory.se3.ate_xy_rmse_m",
                                                 "trajectory.se3.ate_z_rmse_m",
                                                 "trajectory.open_loop.se3.ate_xy_rmse_m",
                                                 "closures.loops_closed",
                                                 "closures.loops_true",
                                                 "closures.wrong",
                                                 "map.se3.mae_m",
                                                 "map.local_5m.mae_m",
                                                 "grid.iou_free",
                                                 "grid.passages_found",
                                                 "grid.false_connections",
                                                 "volume.observable_m3",
                                                 "volume.mapped_m3",
                                                 "volume.error_percent",
                                                 "bound.relative_efficiency",
                                                 "relations.translation_m",
                                                 "relations.translation_sd_m",
                                                 "relations.rotation_deg",
                                                 "relations.rotation_sd_deg"};
  return names;
}

void print_scores(const Score& score, Console& console) {
  for (const std::string& name : headline_metrics()) {
    const Metric* m = score.find(name);
    if (!m) continue;
    char line[160];
    if (std::isfinite(m->value))
      std::snprintf(line, sizeof line, "  %-42s %12.4g %s", name.c_str(), m->value, m->unit.c_str());
    else
      std::snprintf(line, sizeof line, "  %-42s %12s", name.c_str(), "-");
    console.result(line);
  }
}

}  // namespace adit
