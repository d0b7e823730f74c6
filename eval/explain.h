// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace adit {

/// What docs/metrics.md says of a metric: its row, and the words about its block.
/// @param name  dotted ("trajectory.se3.ate_rmse_m") or its last part ("ate_rmse_m")
/// @throws Error for a name that the page does not define, with near ones
std::string explain_metric(const std::string& name);

/// Every name that the page defines, with its block: "volume.iou".
std::vector<std::string> defined_metrics();

/// Whether scores hold a metric of this dotted name ("map.se3.p95_m").
bool is_metric(const std::string& name);

}  // namespace adit
