// SPDX-License-Identifier: BSD-3-Clause
// Densities of what decays and of what is built in, by the state that a mine is in. Roof falls: 0-1 in 500 m where a mine is
// kept up, 1-3 in 100 m where it is not; the rest are practice and judgement, to be overruled by keys.
#include "worlds/decay.h"

#include <algorithm>
#include <map>

namespace adit {
namespace {

struct Condition {
  double falls, skins, cleared;  // in 100 m; share of the falls whose rubble was loaded out
  double slough, talus, sag, heave, bedding;
  double posts, crossbars, cribs, bolts, track, belt, pipes, cables;
  double stoppings, cars, beams, blocks, pools, sludge;
};

const std::map<std::string, Condition>& conditions() {
  static const std::map<std::string, Condition> all{
      {"bare", {}},
      {"active", {0.03, 0.07, 1.0, 0.05, 0.0,  0.03, 0.02, 0.0,  //
                  0.10, 0.05, 0.1, 1.0,  0.25, 0.2,  0.4,  0.5,  //
                  0.05, 0.1,  0.0, 0.5,  0.1,  0.0}},
      {"research", {0.04, 0.1,  0.9, 0.1, 0.15, 0.05, 0.03, 0.02,  //
                    0.15, 0.10, 0.2, 0.8, 0.4,  0.0,  0.3,  0.4,   //
                    0.08, 0.1,  0.0, 1.0, 0.2,  0.1}},
      {"abandoned", {0.6,  1.4,  0.1, 0.45, 0.5, 0.12, 0.2, 0.08,  //
                     0.35, 0.15, 0.6, 0.3,  0.3, 0.05, 0.2, 0.2,   //
                     0.08, 0.15, 0.4, 6.0,  0.8, 0.35}},
      {"retreat", {1.0,  1.5,  0.1, 0.4, 0.4, 0.15, 0.15, 0.06,  //
                   0.45, 0.10, 2.0, 0.6, 0.0, 0.1,  0.1,  0.3,   //
                   0.03, 0.05, 0.3, 5.0, 0.2, 0.0}},
  };
  return all;
}

// A setting below 0 is left to the condition.
void settle(double& value, double usual) {
  if (value < 0) value = usual;
}

}  // namespace

WorldSettings in_condition(const WorldSettings& settings) {
  WorldSettings s = settings;
  const Condition& c = conditions().at(s.condition);
  settle(s.decay.falls_per_100m, c.falls);
  settle(s.decay.skins_per_100m, c.skins);
  settle(s.decay.cleared_share, c.cleared);
  settle(s.decay.talus_m, c.talus);
  s.wear.slough_m = std::max(s.wear.slough_m, c.slough);
  s.wear.sag_m = std::max(s.wear.sag_m, c.sag);
  s.wear.heave_m = std::max(s.wear.heave_m, c.heave);
  s.wear.bedding_m = std::max(s.wear.bedding_m, c.bedding);
  FurnitureSettings& f = s.furniture;
  settle(f.post_share, c.posts);
  settle(f.crossbar_share, c.crossbars);
  settle(f.cribs_per_100m, c.cribs);
  settle(f.bolt_share, c.bolts);
  settle(f.track_share, c.track);
  settle(f.belt_share, c.belt);
  settle(f.pipe_share, c.pipes);
  settle(f.cable_share, c.cables);
  settle(f.stopping_share, c.stoppings);
  settle(f.cars_per_100m, c.cars);
  settle(f.beams_per_100m, c.beams);
  settle(f.blocks_per_100m, c.blocks);
  settle(f.pools_per_100m, c.pools);
  settle(f.sludge_share, c.sludge);
  return s;
}

}  // namespace adit
