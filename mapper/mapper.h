// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/estimate.h"
#include "base/progress.h"
#include "base/recording.h"
#include "mapper/align.h"
#include "mapper/graph_map.h"
#include "mapper/occupancy.h"
#include "mapper/odometry.h"
#include "mapper/places.h"
#include "mapper/rematch.h"
#include "mapper/tilt.h"
#include "mapper/volume.h"

#include <string>

namespace adit {

/// How a map is made. Keys stand below [map], those of the parts below [map.odometry], [map.robust] and so on.
struct MapSettings {
  std::string method = "robust";  // of the global alignment
  OdometrySettings odometry;
  SpaceSettings space;  // robust: a second time, with the height, pitch and roll that the first path leads to
  PublishedSettings icra2003;
  RobustSettings robust;
  PlaceSettings places;
  RematchSettings rematch;
  OccupancySettings grid;
  TiltSettings tilt;
  VolumeSettings volume;
  GraphMapSettings graph;  // of a bare graph
};
Fields fields(MapSettings& settings);

/// A map from what the lasers saw and nothing else: scan matching, global alignment, both once more in space where the
/// rig tells height, pitch and roll, a second matching with the aligned poses as prior, occupancy grid; then height, pitch and roll, points, surface and volume from the vertical lasers.
/// What the rig cannot see is left out and noted. Deterministic on any number of threads.
/// Errors: no horizontal laser in the rig; no scans of it.
Estimate make_map(const Log& log, const MapSettings& settings, const Progress& progress = {});

}  // namespace adit
