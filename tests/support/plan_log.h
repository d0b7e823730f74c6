// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// A mine in the plane and what a horizontal laser records on a tour of it, with the exact truth: enough to test
// everything that works on planar scans, in milliseconds and with no mesh.

#include "base/frames.h"
#include "base/recording.h"
#include "base/rig.h"

#include <cstdint>
#include <vector>

namespace adit {

struct Segment {
  Vec2 a, b;
};

/// Ribs of a planar mine as many short segments.
struct Plan {
  std::vector<Segment> ribs;
};

struct PlanShape {
  double width_m = 3.7;        // of the passages
  double rough_rms_m = 0.05;   // of the ribs about the smooth line; 0 = smooth
  double rough_scale_m = 0.5;  // lattice of the roughness, about its correlation length
};

/// The ribs around centre lines: where the distance to the nearest line is width / 2 plus the roughness.
Plan plan_along(const std::vector<Segment>& centre_lines, const PlanShape& shape, std::uint64_t seed);

/// Centre lines of a room-and-pillar panel: entries along x at y = 0, pitch, ...; crosscuts along y at x = 0, pitch,
/// ...
std::vector<Segment> panel_lines(int entries, int crosscuts, double pitch_m);

/// A tour of `line` (corners are rounded), pushed at a walking speed that varies, with scans taken on the way.
struct TourSettings {
  double speed_m_s = 0.7, speed_swing = 0.2;  // speed * (1 + swing * sin(...)) with a period of 9 s
  double sway_m = 0.08;                       // from the line to either side, wave length about 7 m
  double corner_m = 1.8;                      // where a corner begins to be rounded
  double noise_m = 0.01;
  double stop_at_m = -1, stop_s = 0;  // stands here for so long
  double drop_share = 0.01;           // of the beams, that come back as NaN
  int beams = 361;
  double interval_s = 0.2131;
  bool moving_beams = true;  // each beam from where the laser is when it leaves
};

struct PlanLog {
  Mount mount;
  Scans scans;
  std::vector<Pose2> X_WB;  // (scans) truth at the stamps

  /// Truth in the frame of the first pose.
  Pose2 X_MB(size_t i) const { return X_WB[0].inverse() * X_WB[i]; }
};

PlanLog drive_plan(const Plan& plan, const std::vector<Vec2>& line, const TourSettings& settings, std::uint64_t seed);

/// The mount that drive_plan uses, for `beams` over 180 degrees.
Mount plan_mount(int beams, double interval_s, double noise_m);

/// Three loops of a 3 x 3 panel with passages driven twice in the same and in the opposite direction, about 270 m.
PlanLog loop_tour(const PlanShape& shape, const TourSettings& settings, std::uint64_t seed);

}  // namespace adit
