// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/config.h"
#include "base/mine_part.h"
#include "base/progress.h"
#include "base/route.h"
#include "base/world.h"

#include <cstdint>
#include <functional>
#include <map>
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
  double stagger = 0.35;           // every second row of crosscuts is moved by this share of the spacing: three-way
                                   // junctions, as most of those in real mines are
  double width_m = 3.7;
  double stub_length_m = 9;   // dead ends by which entries run beyond the last crosscut
  double stub_share = 0.75;   // of the entries' ends that have one
  double missing_share = 0;   // of the crosscuts but the first and last: not driven
  double dead_end_share = 0;  // driven from one side only
  double stopping_share = 0;  // closed by a stopping: a wall with two faces labelled cap
  double stopping_m = 0.4;    // its thickness
  double turnout_share = 0;   // of the junctions with a corner cut off
  bool loop_road = false;     // an oval round from the first entry's end to the last one's
  int retreat_rows = 0;       // rows of pillars at the far end that are split into stumps, gob beyond
  double stump_m = 3.5;       // side of the stumps
};

/// Old workings: rooms driven off butts through narrow necks, joined by breakthroughs.
struct RoomSettings {
  int butts = 2;
  double butt_spacing_m = 14;
  double butt_width_m = 3.5;
  double butt_crosscut_m = 35;  // between the crosscuts that join butts
  int rooms = 6;                // on a side
  bool both_sides = true;
  double spacing_m = 12.5;  // between the rooms' centre lines
  double spacing_sd_m = 0.3;
  double width_m = 6.5;
  double width_sd_m = 0.5;
  double depth_m = 60;
  double depth_sd_m = 8;
  double neck_m = 5;
  double neck_width_m = 3.5;
  double through_spacing_m = 22;  // between breakthroughs from a room to the next
  double through_width_m = 3.2;
  double through_share = 0.8;  // of them that were driven
};

/// A part of a large mine: mains with a panel to either side at each pitch, barrier pillars between; or mains with
/// sub-mains to either side, off which the panels turn.
struct DistrictSettings {
  double length_m = 2000;  // of passages, reached by whole pitches
  int mains = 4;           // entries of the mains
  double main_spacing_m = 20;
  int submain_entries = 0;  // of the sub-mains; 0: panels turn off the mains
  int submain_panels = 2;   // pairs of panels along each sub-main
  int panel_entries = 3;
  double panel_spacing_m = 20;
  int panel_crosscuts = 4;
  double crosscut_spacing_m = 28;
  double spacing_sd_m = 0.5;
  double barrier_m = 25;
  double width_m = 5;
  double stagger = 0.35;       // every second row of crosscuts is moved by this share of their spacing
  double missing_share = 0.1;  // of the crosscuts but the first and last of a panel
  double stopping_share = 0.1;
  double stopping_m = 0.4;
};

/// What a surface's roughness is: self-affine with the Hurst exponent 0.7 below a correlation length.
struct RoughnessSettings {
  double rms_m, correlation_m;
};

/// What time and the cutting machine did to the faces. All are off by default.
struct WearSettings {
  double slough_m = 0;        // depth to which ribs have spalled at mid height, under the roof's brow
  double slough_share = 0.6;  // of the ribs' length
  double slough_length_m = 5;
  double sag_m = 0;      // of the roof in the middle of passages, varying to nothing
  double heave_m = 0;    // of the floor there
  double bedding_m = 0;  // height of the steps where the roof broke to the next bedding plane
  double scallop_m = 0;  // depth of the cutting drum's grooves in the ribs
  double scallop_pitch_m = 0.45;
  double cleat_m = 0;     // depth of the steps in which ribs break along the coal's two sets of upright joints
  double cleat_deg = 25;  // bearing of the first set, from x; the second stands at right angles to it
};

/// What the rock is and what lies on it; reflectivities are diffuse, at 905 nm.
struct RockSettings {
  double dust_share = 1;   // of the surfaces under rock dust, whose reflectivity is world.reflectivity
  double coal = 0.07;      // ribs where bare
  double shale = 0.22;     // roof where bare
  double fireclay = 0.15;  // floor where bare
  double wet_share = 0;    // of the surfaces that are wet, the floor first
  double patch_m = 3;      // size of the patches of dust and water
};

/// What came down. Below 0: as world.condition has it.
struct DecaySettings {
  double falls_per_100m = -1;  // of passages: major falls, most at junctions
  double skins_per_100m = -1;  // slabs that dropped off the roof
  double cleared_share = -1;   // of the major falls whose rubble was loaded out
  double fall_height_m = 1.8;  // median height of their cavities
  double talus_m = -1;         // height of what spalled from the ribs, at their foot
  bool may_cut = false;        // falls and what stands across may leave a mine without loops
};

/// What was built in. Shares are those of the passages that have it; below 0: as world.condition has it.
struct FurnitureSettings {
  double lane_m = 1.6;  // about the centre line, kept clear but for what blocks a passage
  double post_share = -1, post_spacing_m = 1.4;
  double crossbar_share = -1, crossbar_spacing_m = 1.4;
  double cribs_per_100m = -1;
  double bolt_share = -1, bolt_spacing_m = 1.2;
  double track_share = -1;
  double belt_share = -1;
  double pipe_share = -1, cable_share = -1;
  double stopping_share = -1;  // of the passages that are no dead ends: a block wall with a man door
  double cars_per_100m = -1;   // standing on their track
  double beams_per_100m = -1;  // fallen across the way
  double blocks_per_100m = -1;
  double pools_per_100m = -1, pool_depth_m = 0.25, pool_reach_m = 15;
  double sludge_share = -1;  // of the floor
};

/// A mine before chance: the keys of [world].
struct WorldSettings {
  std::string kind = "plan";      // plan | panel | rooms | district
  std::string plan = "bruceton";  // bundled name, a JSON file of centre lines, or a GeoJSON file of
                                  // polygons with pillars as holes
  std::string passages = "open";  // of the plan: open | all (those walled off too)
  double x_min = -1e5, x_max = 1e5, y_min = -1e5, y_max = 1e5;  // the part of the plan that is made
  PanelSettings panel;
  RoomSettings rooms;
  DistrictSettings district;

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

  std::string condition = "bare";  // bare | active | research | abandoned | retreat
  DecaySettings decay;
  FurnitureSettings furniture;
  WearSettings wear;
  RockSettings rock;
  double reflectivity = 0.45;  // diffuse, at 905 nm; rock-dusted
  double reflectivity_sd = 0.06;
  double mesh_edge_m = 0.2;
  double tile_m = 0;  // side of the squares in which the mine is made, one after the other; 0: in one piece
};
Fields fields(WorldSettings& settings);

/// Makes a mine.
/// @return  a closed, oriented mesh without self-intersections, every face labelled, with the truth about it; the same
///          bytes for the same settings and seed
/// @throws  Error naming the key where no mine can be made: unknown plan, a width <= 0, parts that are not connected,
///          entries wider than their spacing, a mesh edge beyond what the widths allow
World make_world(const WorldSettings& settings, std::uint64_t seed, const Progress& progress = {});

/// The same mine part by part, each a tile of world.tile_m, in memory that does not grow with the mine but for its truth.
/// @param take  gets each part once it is made
/// @return      the mine without its mesh
World make_parts(const WorldSettings& settings, std::uint64_t seed, const std::function<void(MinePart&&)>& take,
                 const Progress& progress = {});

/// How a vehicle goes through a mine: the keys of [route].
struct RouteSettings {
  std::string mode = "loops";   // loops | all | around | waypoints | there_and_back
  int start = -1;               // junction id; -1: drawn among those on a loop
  std::vector<int> waypoints;   // junction ids, for mode waypoints
  std::vector<int> pillars;     // pillar ids, for mode around
  std::vector<int> avoid;       // passage ids that are not driven: blocked, or full of things
  std::string turn = "arc";     // where the route runs back on itself: arc | three_point | in_place
  double twice_share = 0.25;    // for mode loops: least share of the way on passages that are driven twice or more
  double turn_radius_m = 1.75;  // of the arcs that round corners, where there is room
};
Fields fields(RouteSettings& settings);

/// A line to drive, following passages' centre lines, corners rounded by arcs, a point every 0.25 m.
///   loops           every passage that lies on a loop or between loops once at least, dead ends left out; twice_share
///                   of the way is driven twice, some of it in the same and some in the opposite direction; no U-turn
///   all             every passage once at least, dead ends too unless they are shorter than wide, by a short closed
///                   tour; as many U-turns as dead ends
///   around          the loops about the pillars named, one after the other, joined by shortest ways
///   waypoints       shortest ways between the junctions given
///   there_and_back  from the start to the junction farthest from it, round, and back
/// A turn is an arc within the passage, a three-point turn whose middle stretch is driven backwards, or the line runs
/// back on itself for a vehicle that turns on the spot. Passages that are blocked or to be avoided are left out, with what
/// cannot be reached without them. At a dead end a route begins and ends 1.3 m off the face.
/// @throws Error for a junction, pillar or passage that is not there, two waypoints that are equal, a mine without loops in mode loops
Route plan_route(const World& world, const RouteSettings& settings, std::uint64_t seed);

/// What a mesh is found to be, by exact predicates: nothing of it follows from how it was made.
struct WorldCheck {
  bool closed = false;
  size_t open_edges = 0;          // that do not join two faces in opposite directions
  size_t pinched_vertices = 0;    // at which the surface only touches itself
  bool oriented = false;          // consistently, normals out of the enclosed volume
  size_t self_intersections = 0;  // pairs of faces
  size_t degenerate_faces = 0;    // corners on one line
  size_t unlabelled = 0;
  double volume_m3 = 0;

  bool ok() const {
    return closed && oriented && self_intersections + degenerate_faces + pinched_vertices + unlabelled == 0;
  }
  /// One sentence.
  std::string what() const;
};
WorldCheck check_world(const World& world);

/// What a mesh tells of itself that its mine's truth tells as well.
struct MeshTally {
  double six_volumes = 0;                      // seen from a point that is the same for all faces
  double rock_six_volumes = 0;                 // of the rock's faces alone: the bodies in the void filled in
  std::vector<double> body_six_volumes = {};   // (objects) of the faces of each body, > 0
  int passages = 0, pillars = 0, objects = 0;  // one more than the highest id that a face names
  size_t nameless = 0;                         // faces that name no passage, floor and roof none as their part

  void add(const Mesh& mesh, const Vec3& origin);
};

/// The same checks part by part: what they hold are the sides that wait for a neighbour and faces near parts to come.
class PartsCheck {
 public:
  void add(const MinePart& part) { add(part.mesh, part.vertex_id, part.index, part.later); }
  void add(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id, size_t index,
           const std::vector<MinePart::Frame>& later);
  /// Once all parts are in.
  WorldCheck finish() const;
  const MeshTally& tally() const { return tally_; }

 private:
  struct Waiting {  // faces of an earlier part that a later one may touch
    Mesh mesh;
    std::vector<std::uint32_t> vertex_id;
  };
  void check_joints(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id);
  void check_crossings(const Mesh& mesh, const std::vector<std::uint32_t>& vertex_id, size_t index,
                       const std::vector<MinePart::Frame>& later);

  WorldCheck check_;
  MeshTally tally_;
  size_t faces_ = 0;
  Vec3 origin_ = Vec3::Zero();
  std::map<std::uint64_t, bool> open_;              // sides, lower and higher vertex: whether their face runs upwards
  std::map<std::uint32_t, int> fans_;               // of the vertices at open sides
  std::map<size_t, std::vector<Waiting>> waiting_;  // by the part that they wait for
};

/// Where a mine's truth does not fit its mesh, a sentence each: volumes, areas, labels, ids, loops, every number that
/// the mesh tells as well. Empty = it fits.
std::vector<std::string> check_truth(const World& world);
std::vector<std::string> check_truth(const World& truth, const MeshTally& mesh);

/// The plan for other programs: DIR/plan.svg, plan.dxf (R12, metres, a layer each for void, pillars, centre lines,
/// junctions), plan.geojson (metres; what world.plan reads again) and the occupancy grid plan.pgm, plan.yaml (ROS
/// map_server; rock beyond the rims is unknown).
void save_plan(const std::string& dir, const World& world);

}  // namespace adit
