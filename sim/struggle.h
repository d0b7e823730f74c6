// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sim/follower.h"
#include "sim/physics.h"
#include "sim/pusher.h"

#include <optional>

namespace adit {

/// What is done with a vehicle that does not get on along its route: it is taken back some way and comes again, a few times,
/// each time from farther off. Before a bump it is given a run; against rock it comes slowly, having turned on meanwhile as
/// one shunts in a narrow turn.
class Struggle {
 public:
  /// It is held up. False: it has been tried often enough here.
  /// @param walk_mps  how fast it usually goes
  /// @param run_mps   how fast it can be made to come; what rolls by its own motors has no more than its usual speed
  bool again(double t_s, double along_m, const Motion& motion, bool against_rock, double walk_mps, double run_mps);
  /// What to do now; none: as usual.
  std::optional<Intent> want(double t_s, double step_s, double along_m, const Guide& guide, const Motion& motion);
  /// To be steered meanwhile, in place of what the route asks.
  double curvature(double asked) const;
  void give_up() { phase_ = Phase::none; }
  int tries() const { return tries_; }

 private:
  enum class Phase { none, back, on };

  Phase phase_ = Phase::none;
  int tries_ = 0;
  double first_m_ = 0;         // along the route, where the tries began
  double along_m_ = 0;         // and where it was held up last
  Vec2 place_ = Vec2::Zero();  // there in plan
  double since_s_ = 0;         // of the present phase
  double back_m_ = 0;          // to be taken back by
  double walk_mps_ = 0, on_mps_ = 0;
  double speed_mps_ = 0;
};

}  // namespace adit
