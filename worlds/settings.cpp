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
      {"missing_share", &s.missing_share, "share of the crosscuts that are not driven", 0, 1},
      {"dead_end_share", &s.dead_end_share, "share of the crosscuts driven from one side only", 0, 1},
      {"stopping_share", &s.stopping_share, "share of the crosscuts closed by a stopping", 0, 1},
      {"stopping_m", &s.stopping_m, "thickness of a stopping", 0.3, 2},
      {"turnout_share", &s.turnout_share, "share of the junctions with a corner cut off", 0, 1},
      {"loop_road", &s.loop_road, "an oval round from the first entry's end to the last one's"},
      {"retreat_rows", &s.retreat_rows, "rows of pillars at the far end that are split into stumps, gob beyond", 0,
       100},
      {"stump_m", &s.stump_m, "side of the stumps", 2.6, 20},
  };
}

Fields fields(RoomSettings& s) {
  return {
      {"butts", &s.butts, "parallel butts", 1, 6},
      {"butt_spacing_m", &s.butt_spacing_m, "between the butts' centre lines", 6, 60},
      {"butt_width_m", &s.butt_width_m, "of the butts and their crosscuts", 1.5, 8},
      {"butt_crosscut_m", &s.butt_crosscut_m, "between the crosscuts of the butts", 10, 100},
      {"rooms", &s.rooms, "rooms on a side", 1, 200},
      {"both_sides", &s.both_sides, "rooms to both sides of the butts, or to one"},
      {"spacing_m", &s.spacing_m, "between the rooms' centre lines", 6, 60},
      {"spacing_sd_m", &s.spacing_sd_m, "its scatter", 0, 3},
      {"width_m", &s.width_m, "of a room", 1.5, 12},
      {"width_sd_m", &s.width_sd_m, "its scatter from room to room", 0, 2},
      {"depth_m", &s.depth_m, "of a room from its butt", 15, 200},
      {"depth_sd_m", &s.depth_sd_m, "its scatter", 0, 30},
      {"neck_m", &s.neck_m, "length of the narrow neck through which a room was turned", 3, 15},
      {"neck_width_m", &s.neck_width_m, "its width", 1.5, 8},
      {"through_spacing_m", &s.through_spacing_m, "between the breakthroughs from a room to the next", 8, 100},
      {"through_width_m", &s.through_width_m, "their width", 1.5, 8},
      {"through_share", &s.through_share, "share of them that were driven", 0, 1},
  };
}

Fields fields(DistrictSettings& s) {
  return {
      {"length_m", &s.length_m, "of passages, reached by whole pitches of the mains", 100, 200000},
      {"mains", &s.mains, "entries of the mains", 2, 12},
      {"main_spacing_m", &s.main_spacing_m, "between their centre lines", 6, 100},
      {"submain_entries", &s.submain_entries, "entries of the sub-mains; 0: panels turn off the mains", 0, 8},
      {"submain_panels", &s.submain_panels, "pairs of panels along each sub-main", 1, 50},
      {"panel_entries", &s.panel_entries, "entries of each panel", 2, 12},
      {"panel_spacing_m", &s.panel_spacing_m, "between their centre lines", 6, 100},
      {"panel_crosscuts", &s.panel_crosscuts, "crosscuts of each panel", 1, 90},
      {"crosscut_spacing_m", &s.crosscut_spacing_m, "between crosscuts", 6, 100},
      {"spacing_sd_m", &s.spacing_sd_m, "scatter of all spacings", 0, 3},
      {"barrier_m", &s.barrier_m, "width of the barrier pillars beside mains and between panels", 8, 60},
      {"width_m", &s.width_m, "of entries and crosscuts", 1.5, 9},
      {"stagger", &s.stagger, "share of the spacing by which every second row of crosscuts is moved", 0, 0.9},
      {"missing_share", &s.missing_share, "share of the crosscuts that are not driven", 0, 1},
      {"stopping_share", &s.stopping_share, "share of the crosscuts closed by a stopping", 0, 1},
      {"stopping_m", &s.stopping_m, "thickness of a stopping", 0.3, 2},
  };
}

Fields fields(WearSettings& s) {
  return {
      {"slough_m", &s.slough_m, "depth to which ribs have spalled at mid height", 0, 0.8},
      {"slough_share", &s.slough_share, "share of the ribs' length that has spalled", 0, 1},
      {"slough_length_m", &s.slough_length_m, "of a stretch that has spalled", 1, 50},
      {"sag_m", &s.sag_m, "greatest sag of the roof in the middle of passages", 0, 0.4},
      {"heave_m", &s.heave_m, "greatest heave of the floor in the middle of passages", 0, 0.4},
      {"bedding_m", &s.bedding_m, "height of the roof's steps from one bedding plane to the next", 0, 0.2},
      {"scallop_m", &s.scallop_m, "depth of the cutting drum's grooves in the ribs", 0, 0.05},
      {"scallop_pitch_m", &s.scallop_pitch_m, "height from groove to groove", 0.2, 1},
      {"cleat_m", &s.cleat_m, "depth of the steps in which ribs break along two sets of upright joints", 0, 0.3},
      {"cleat_deg", &s.cleat_deg, "bearing of the first set from x; the second is at right angles to it", 0, 90},
  };
}

Fields fields(RockSettings& s) {
  return {
      {"dust_share", &s.dust_share, "share of the surfaces under rock dust", 0, 1},
      {"coal", &s.coal, "reflectivity of bare ribs at 905 nm", 0.02, 1},
      {"shale", &s.shale, "reflectivity of bare roof", 0.02, 1},
      {"fireclay", &s.fireclay, "reflectivity of bare floor", 0.02, 1},
      {"wet_share", &s.wet_share, "share of the surfaces that are wet", 0, 1},
      {"patch_m", &s.patch_m, "size of the patches of dust and water", 0.5, 50},
  };
}

Fields fields(DecaySettings& s) {
  return {
      {"falls_per_100m", &s.falls_per_100m, "major roof falls in 100 m of passages; -1: by world.condition", -1, 10},
      {"skins_per_100m", &s.skins_per_100m, "slabs off the roof in 100 m of passages; -1: by world.condition", -1, 20},
      {"cleared_share", &s.cleared_share, "share of the major falls whose rubble was loaded out; -1: by condition", -1,
       1},
      {"fall_height_m", &s.fall_height_m, "median height of the cavities of major falls", 0.3, 4},
      {"talus_m", &s.talus_m, "greatest height of what spalled from ribs, at their foot; -1: by condition", -1, 0.8},
      {"may_cut", &s.may_cut, "whether what blocks passages may leave a mine without loops, or in two"},
  };
}

Fields fields(FurnitureSettings& s) {
  const auto share = [](const char* key, double* value, const char* what) {
    return Field(key, value, std::string("share of the passages with ") + what + "; -1: by world.condition", -1, 1);
  };
  const auto dense = [](const char* key, double* value, const char* what) {
    return Field(key, value, std::string(what) + " in 100 m of passages; -1: by world.condition", -1, 100);
  };
  return {
      {"lane_m", &s.lane_m, "width about the centre line that is kept clear but for what blocks a passage", 0.5, 6},
      share("post_share", &s.post_share, "rows of timber posts"),
      {"post_spacing_m", &s.post_spacing_m, "from post to post", 0.5, 10},
      share("crossbar_share", &s.crossbar_share, "crossbars on legs"),
      {"crossbar_spacing_m", &s.crossbar_spacing_m, "from crossbar to crossbar", 0.8, 10},
      dense("cribs_per_100m", &s.cribs_per_100m, "cribs"),
      share("bolt_share", &s.bolt_share, "roof bolts"),
      {"bolt_spacing_m", &s.bolt_spacing_m, "between bolts, along and across", 0.5, 5},
      share("track_share", &s.track_share, "rails on ties"),
      share("belt_share", &s.belt_share, "a belt conveyor, where they are wide enough"),
      share("pipe_share", &s.pipe_share, "a pipe along a rib"),
      share("cable_share", &s.cable_share, "a cable under the roof's edge"),
      share("stopping_share", &s.stopping_share, "a block wall with a man door, of those that are no dead ends"),
      dense("cars_per_100m", &s.cars_per_100m, "mine cars, which block their passage"),
      dense("beams_per_100m", &s.beams_per_100m, "beams fallen across the way, which block it"),
      dense("blocks_per_100m", &s.blocks_per_100m, "loose blocks beside the lane"),
      dense("pools_per_100m", &s.pools_per_100m, "pools of water"),
      {"pool_depth_m", &s.pool_depth_m, "greatest depth of a pool", 0.02, 1},
      {"pool_reach_m", &s.pool_reach_m, "how far a pool reaches from its deepest place at most", 2, 200},
      {"sludge_share", &s.sludge_share, "share of the floor under sludge; -1: by world.condition", -1, 1},
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
      {"kind", &s.kind, "how the mine is laid out", {"plan", "panel", "rooms", "district"}},
      {"plan", &s.plan,
       "bundled plan, a JSON file of centre lines with widths, or a GeoJSON file of polygons with pillars as holes"},
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
      {"condition",
       &s.condition,
       "state of the mine: how much has come down and what stands in it, where keys do not say",
       {"bare", "active", "research", "abandoned", "retreat"}},
      {"reflectivity", &s.reflectivity, "of rock dust: mean, diffuse, at 905 nm", 0.02, 1},
      {"reflectivity_sd", &s.reflectivity_sd, "its smooth variation", 0, 0.3},
      {"mesh_edge_m", &s.mesh_edge_m, "length of the mesh's edges", 0.05, 1},
      {"tile_m", &s.tile_m, "side of the squares in which the mine is made one after the other; 0: in one piece", 0,
       2000},
  };
  append(all, "panel", fields(s.panel));
  append(all, "rooms", fields(s.rooms));
  append(all, "district", fields(s.district));
  append(all, "decay", fields(s.decay));
  append(all, "furniture", fields(s.furniture));
  append(all, "wear", fields(s.wear));
  append(all, "rock", fields(s.rock));
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
      {"turn",
       &s.turn,
       "where the route runs back on itself: about an arc, forward and back in three arcs, or on the spot",
       {"arc", "three_point", "in_place"}},
      {"twice_share", &s.twice_share, "least share of the way on passages driven twice or more, for mode loops", 0,
       0.9},
      {"turn_radius_m", &s.turn_radius_m, "of the arcs that round corners, where there is room", 0.8, 10},
  };
}

}  // namespace adit
