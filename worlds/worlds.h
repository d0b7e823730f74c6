// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/progress.h"
#include "base/route.h"
#include "base/world.h"

#include <cstdint>
#include <string>
#include <vector>

namespace adit {

/// A mine laid out by numbers: parallel entries along x, joined by crosscuts.
struct PanelSettings {
  int entries = 2;
  int crosscuts = 4;
  double entry_spacing_m = 20;     // between centre lines
  double crosscut_spacing_m = 30;  // between centre lines
  double spacing_sd_m = 1;         // scatter of both
  double crosscut_angle_deg = 90;  // to the entries
  double stagger = 0;              // every second row of crosscuts is moved by this share of the spacing
  double width_m = 3.7;
  double stub_length_m = 9;  // dead ends by which entries run beyond the last crosscut
  double stub_share = 0.75;  // of the entries' ends that have one
};

/// What a surface's roughness is: self-affine with the Hurst exponent 0.7 below a correlation length.
struct RoughnessSettings {
  double rms_m, correlation_m;
};

/// A mine before chance: the keys of [world].
struct WorldSettings {
  std::string kind = "plan";                                    // plan | panel
  std::string plan = "bruceton";                                // bundled name, or a JSON file of centre lines
  std::string passages = "open";                                // of the plan: open | all (those walled off too)
  double x_min = -1e5, x_max = 1e5, y_min = -1e5, y_max = 1e5;  // the part of the plan that is made
  PanelSettings panel;

  double width_scale = 1;        // on the widths that the plan tells
  double width_sd_m = 0.1;       // of a passage's width, drawn for each passage
  double wander_m = 0.3;         // sd of a centre line about the plan
  double wander_length_m = 30;   // over which it wanders
  double wall_wander_m = 0.12;   // sd of each rib about that, over 8 m
  double corner_radius_m = 1.2;  // of pillar corners

  double height_m = 1.9;     // mined height
  double height_sd_m = 0.1;  // over height_length_m
  double height_length_m = 50;
  double grade_percent = 0.8;                // of the floor's plane, in a direction that is drawn
  double roll_m = 0.3;                       // rms of the rolls about that plane
  double roll_min_m = 40, roll_max_m = 150;  // their wavelengths
  RoughnessSettings floor{0.02, 0.5}, roof{0.02, 1.0}, rib{0.055, 0.55};

  double reflectivity = 0.45;  // diffuse, at 905 nm; rock-dusted
  double reflectivity_sd = 0.06;
  double mesh_edge_m = 0.2;
};
Fields fields(WorldSettings& settings);

/// Makes a mine.
/// @return  a closed, oriented mesh without self-intersections, every face labelled, with the truth about it; the same
///          bytes for the same settings and seed
/// @throws  Error naming the key where no mine can be made: unknown plan, a width <= 0, parts that are not connected,
///          entries wider than their spacing, a mesh edge beyond what the widths allow
World make_world(const WorldSettings& settings, std::uint64_t seed, const Progress& progress = {});

/// How a vehicle goes through a mine: the keys of [route].
struct RouteSettings {
  std::string mode = "loops";   // loops | all | around | waypoints | there_and_back
  int start = -1;               // junction id; -1: drawn among those on a loop
  std::vector<int> waypoints;   // junction ids, for mode waypoints
  std::vector<int> pillars;     // pillar ids, for mode around
  std::vector<int> avoid;       // passage ids that are not driven: blocked, or full of things
  std::string turn = "arc";     // where the route runs back on itself: arc | in_place
  double twice_share = 0.25;    // for mode loops: least share of the way on passages that are driven twice or more
  double turn_radius_m = 1.75;  // of the arcs that round corners, where there is room
};
Fields fields(RouteSettings& settings);

/// A line to drive, following passages' centre lines, corners rounded by arcs, a point every 0.25 m.
///   loops           every passage that lies on a loop or between loops once at least, dead ends left out; twice_share
///   of
///                   the way is driven twice, some of it in the same and some in the opposite direction; no U-turn
///   all             every passage once at least, dead ends too, by a short closed tour; as many U-turns as dead ends
///   around          the loops about the pillars named, one after the other, joined by shortest ways
///   waypoints       shortest ways between the junctions given
///   there_and_back  from the start to the junction farthest from it, round, and back
/// A turn is an arc within the passage, or the line runs back on itself for a vehicle that turns on the spot. Passages
/// to avoid are left out, with what cannot be reached without them.
/// @throws Error for a junction, pillar or passage that is not there, two waypoints that are equal, a mine without loops in mode loops
Route plan_route(const World& world, const RouteSettings& settings, std::uint64_t seed);

/// What a mesh is found to be, by CGAL: nothing of it follows from how it was made.
struct WorldCheck {
  bool closed = false;
  bool oriented = false;          // consistently, normals out of the enclosed volume
  size_t self_intersections = 0;  // pairs of faces
  size_t degenerate_faces = 0;    // corners on one line
  size_t unlabelled = 0;
  double volume_m3 = 0;

  bool ok() const { return closed && oriented && self_intersections + degenerate_faces + unlabelled == 0; }
  /// One sentence.
  std::string what() const;
};
WorldCheck check_world(const World& world);

}  // namespace adit
