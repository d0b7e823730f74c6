// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace adit {

/// A file of polygons in any format that GDAL's ogr2ogr reads, as GeoJSON text in the file's own coordinates. The
/// program is asked for when it is needed: Error where it is not installed, or cannot read the file.
std::string as_geojson(const std::string& file);

}  // namespace adit
