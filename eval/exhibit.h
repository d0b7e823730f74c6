// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "eval/plan.h"
#include "eval/ramp.h"
#include "eval/report.h"
#include "rays/caster.h"

#include <optional>
#include <string>
#include <vector>

namespace adit {

/// Where a map is worst.
struct Spot {
  Vec3 p_W;
  double bias_m, mae_m;  // signed (+ into the void) and absolute mean error there
  std::string words;     // "off by 0.42 m on average, into the rock, passage 12"
};

/// What the pictures of one run share, worked out once: the map laid on the world (best rigid fit of the paths), the
/// signed error of everything that is drawn, one range of colours.
struct Exhibit {
  const ReportInput& input;
  ReportSettings settings;
  std::optional<Caster> caster = {};                            // of the true mesh; none where there is no mesh
  std::vector<std::vector<Vec2>> outline = {};                  // of the true floor
  Pose X_WM = Pose::Identity(), X_WM_first = Pose::Identity();  // best rigid fit; by the first pose alone
  std::vector<Vec3> point_W = {};                               // Estimate::points laid by X_WM
  std::vector<float> point_error_m = {};                        // signed, + into the void; NaN = no true surface near
  std::vector<Label> point_label = {};                          // of the true surface that it belongs to
  Mesh surface_W = {};                                          // Estimate::surface laid by X_WM
  std::vector<float> surface_error_m = {};                      // of its vertices
  Trajectory path_W = {};                                       // Estimate::path laid by X_WM
  std::vector<Spot> spots = {};                                 // worst first
  Ramp ramp = {}, size_ramp = {};                               // of signed errors, for every picture
  Vec2 low_W = Vec2::Zero(), high_W = Vec2::Zero();             // of the mine in plan, with a margin
  std::optional<Viewpoint> viewpoint = {};                      // of pictures in space, where one is given

  bool has_points() const { return !point_W.empty(); }
  bool has_surface() const { return !surface_W.face.empty(); }
  bool has_world() const { return !input.world.mesh.face.empty(); }
};

Exhibit make_exhibit(const ReportInput& input, const ReportSettings& settings, const Progress& progress = {});

/// A picture of the page, with what a reader needs to know of it.
struct Figure {
  std::string name = {};     // of the file and for `adit render`
  std::string title = {};    // heading
  std::string caption = {};  // what is seen and how to read it
  std::string alt = {};      // in place of the picture
  Drawing drawing = {};
  std::string missing = {};             // why there is no drawing; empty if there is
  std::optional<PlanFrame> frame = {};  // of a plan on which places are marked by the page's script
};

/// Plans.
Figure error_plan(const Exhibit& exhibit);         // where the map is off: the page's first picture
Figure narrow_error_plan(const Exhibit& exhibit);  // the same for narrow screens
Figure truth_plan(const Exhibit& exhibit);         // Fig. 3: the mine and the path driven
Figure raw_plan(const Exhibit& exhibit);           // Fig. 3: scan matching alone
Figure aligned_plan(const Exhibit& exhibit);       // Fig. 3: after the global alignment
Figure rounds_plan(const Exhibit& exhibit);        // Fig. 2: correspondences by rounds
Figure grid_plan(const Exhibit& exhibit);          // Fig. 4: occupancy grid
Figure closures_plan(const Exhibit& exhibit);      // loop closures over the plan
Figure error_chart(const Exhibit& exhibit);        // error of the path along the way driven
/// In space.
Figure cutaway_view(const Exhibit& exhibit);             // Fig. 5: the mine with its roof lifted off, coloured by error
Figure chamber_view(const Exhibit& exhibit);             // the same near the worst place, closer
Figure interior_view(const Exhibit& exhibit, int k);     // Fig. 6: from the path, truth beside map
Figure coverage_view(const Exhibit& exhibit);            // what of the true rock the rig's beams met
Figure mine_view(const Exhibit& exhibit);                // the true mine alone, by a lamp
Figure thing_view(const Exhibit& exhibit, Label label);  // a thing in it, or what fell
/// settings.frames views along the path, truth beside map; none where there is none to take.
struct AlongFrame {
  double along_m = 0;
  std::string png = {};  // its picture
};
std::vector<AlongFrame> along_frames(const Exhibit& exhibit, const Progress& progress = {});
/// The frames as an animated PNG; at least one.
std::string animation_of(const std::vector<AlongFrame>& frames);
/// The same from the path towards a worst place, `width` wide.
Picture spot_interior(const Exhibit& exhibit, const Vec3& place_W, int width);
/// Sections.
Figure tilt_section(const Exhibit& exhibit);      // Fig. 5: with and without correction of pitch and roll
Figure spot_view(const Exhibit& exhibit, int k);  // a worst place: plan and section

}  // namespace adit
