// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/worlds.h"

namespace adit {
namespace {

Fields fields(PanelSettings& s) {
  return {
      {"entries", &s.entries, "parallel entries", 1, 50},
      {"crosscuts", &s.crosscuts, "crosscuts between two entries", 1, 500},
      {"entry_spacing_m", &s.entry_spacing_m, "between the entries' centre lines", 4, 200},
      {"crosscut_spacing_m", &s.crosscut_spacing_m, "between the crosscuts' centre lines", 4, 200},
      {"spacing_sd_m", &s.spacing_sd_m, "scatter of both spacings", 0, 5},
      {"crosscut_angle_deg", &s.crosscut_angle_deg, "of the crosscuts to the entries", 45, 135},
      {"stagger", &s.stagger, "share of the spacing by which every second row of crosscuts is moved", 0, 0.9},
      {"width_m", &s.width_m, "of entries and crosscuts", 1.5, 12},
      {"stub_length_m", &s.stub_length_m, "dead ends by which entries run beyond the last crosscut", 0, 100},
      {"stub_share", &s.stub_share, "share of the entries' ends that have a dead end", 0, 1},
  };
}

Fields fields(RoughnessSettings& s) {
  return {
      {"rms_m", &s.rms_m, "rms of the roughness", 0, 0.15},
      {"correlation_m", &s.correlation_m, "its correlation length", 0.1, 10},
  };
}

}  // namespace

Fields fields(WorldSettings& s) {
  Fields all = {
      {"kind", &s.kind, "how the mine is laid out", {"plan", "panel"}},
      {"plan", &s.plan, "bundled plan, or a JSON file of centre lines with widths"},
      {"passages", &s.passages, "of the plan: those open, or all, those walled off too", {"open", "all"}},
      {"x_min", &s.x_min, "the part of the plan that is made, metres", -1e6, 1e6},
      {"x_max", &s.x_max, "the same", -1e6, 1e6},
      {"y_min", &s.y_min, "the same", -1e6, 1e6},
      {"y_max", &s.y_max, "the same", -1e6, 1e6},
      {"width_scale", &s.width_scale, "factor on the plan's widths", 0.5, 3},
      {"width_sd_m", &s.width_sd_m, "sd of a passage's width about the plan's", 0, 0.6},
      {"wander_m", &s.wander_m, "sd of the centre lines about the plan", 0, 1},
      {"wander_length_m", &s.wander_length_m, "over which centre lines wander", 15, 200},
      {"wall_wander_m", &s.wall_wander_m, "sd of each rib about a straight line, over 8 m", 0, 0.3},
      {"corner_radius_m", &s.corner_radius_m, "of pillar corners", 0.5, 2.5},
      {"height_m", &s.height_m, "mined height", 1, 8},
      {"height_sd_m", &s.height_sd_m, "sd of the height within the mine", 0, 0.3},
      {"height_length_m", &s.height_length_m, "over which the height varies", 10, 500},
      {"grade_percent", &s.grade_percent, "of the floor's plane, in a direction that is drawn", 0, 15},
      {"roll_m", &s.roll_m, "rms of the floor's rolls about its plane", 0, 1.5},
      {"roll_min_m", &s.roll_min_m, "shortest wavelength of the rolls", 20, 1000},
      {"roll_max_m", &s.roll_max_m, "longest wavelength of the rolls", 20, 1000},
      {"reflectivity", &s.reflectivity, "mean, diffuse, at 905 nm", 0.02, 1},
      {"reflectivity_sd", &s.reflectivity_sd, "its smooth variation", 0, 0.3},
      {"mesh_edge_m", &s.mesh_edge_m, "length of the mesh's edges", 0.05, 1},
  };
  append(all, "panel", fields(s.panel));
  append(all, "floor", fields(s.floor));
  append(all, "roof", fields(s.roof));
  append(all, "rib", fields(s.rib));
  return all;
}

Fields fields(RouteSettings& s) {
  return {
      {"mode", &s.mode, "what the route is for", {"loops", "all", "around", "waypoints", "there_and_back"}},
      {"start", &s.start, "junction id, -1: drawn among those on a loop", -1, 1e6},
      {"waypoints", &s.waypoints, "junction ids, for mode waypoints"},
      {"pillars", &s.pillars, "pillar ids, for mode around"},
      {"avoid", &s.avoid, "passage ids that are not driven"},
      {"turn", &s.turn, "where the route runs back on itself: about an arc, or on the spot", {"arc", "in_place"}},
      {"twice_share", &s.twice_share, "least share of the way on passages driven twice or more, for mode loops", 0,
       0.9},
      {"turn_radius_m", &s.turn_radius_m, "of the arcs that round corners, where there is room", 0.8, 10},
  };
}

}  // namespace adit
