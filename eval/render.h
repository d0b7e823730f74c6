// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/picture.h"
#include "eval/report.h"

#include <optional>
#include <string>
#include <vector>

namespace adit {

/// Names of the pictures that can be made of a run, in the order of the page.
std::vector<std::string> view_names();

/// One picture of a run.
/// @param viewpoint  for the pictures in space: cutaway, chamber, interior-k
/// @throws Error naming the view where there is none of that name, or where the run lacks what it shows.
Picture render_view(const std::string& view, const ReportInput& input, const ReportSettings& settings,
                    const std::optional<Viewpoint>& viewpoint = {});
/// The same, as the bytes of a PNG; "along" is an animated one.
std::string render_png(const std::string& view, const ReportInput& input, const ReportSettings& settings,
                       const std::optional<Viewpoint>& viewpoint = {});

}  // namespace adit
