// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/frames.h"
#include "base/route.h"

#include <limits>
#include <vector>

namespace adit {

/// What the route asks of a vehicle where it is.
struct Guide {
  double along_m = 0;          // of the route's length, at the foot of the axle; below 0 before its start
  double cross_m = 0;          // axle left of the route
  double ahead_m = 0;          // axle ahead of its foot on the route, as the end that leads points
  double curvature = 0;        // 1/m, to steer now; > 0 turns left
  double bearing_rad = 0;      // of the point that is steered for, from straight ahead; > 0 on the left
  double curvature_ahead = 0;  // 1/m, greatest to be steered from here to a metre and a half ahead, without sign
  bool backward = false;       // the route is driven tail first here: bearing and curvature are those of the tail
  double shift_in_m = std::numeric_limits<double>::infinity();  // way to where forward and backward change
};

/// A turn on the spot, where the way on lies behind. Near the opposite direction every jolt changes the side on which the
/// way on lies: the side that the turn began to is kept until that is plain.
class SpotTurn {
 public:
  bool on() const { return on_; }
  /// @return  whether it turns now
  bool look(const Guide& guide);
  double side() const { return left_ ? 1 : -1; }  // to turn to; 1: left
  /// Speed along its nose that brings it back to its place, off which slipping tyres move it while it turns.
  double creep_mps(const Guide& guide) const;

 private:
  bool on_ = false, left_ = false;
};

/// Keeps a vehicle on its route by pure pursuit of a point ahead (Coulter, "Implementation of the pure pursuit path
/// tracking algorithm", CMU-RI-TR-92-01). The foot on the route only moves on, by small steps, so that a route may
/// cross itself or run back along itself. Where forward and backward change it waits at that point for shift().
class Follower {
 public:
  /// @param route  at least two points; else Error
  explicit Follower(const Route& route);

  double length_m() const { return length_m_; }
  /// The line at a distance along it; straight on beyond its ends.
  Vec2 point(double along_m) const;
  double heading_rad(double along_m) const;
  /// @param X_WF  the axle in plan, x forward
  /// @param lookahead_m  to the point steered for; between the changes of a manoeuvre less, down to 0.4 m
  Guide look(const Pose2& X_WF, double lookahead_m);
  /// It stands where forward and backward change: on to the next stretch.
  void shift();

 private:
  double shift_m() const;
  size_t segment(double along_m) const;
  Vec2 goal(double lookahead_m) const;

  std::vector<Vec2> line_;
  std::vector<double> at_m_;      // of each point
  std::vector<double> turns_m_;   // where it runs back on itself
  std::vector<double> shifts_m_;  // where forward and backward change, forward first
  size_t shifted_ = 0;            // of them behind
  double length_m_ = 0;
  double foot_m_ = 0;
  bool found_ = false;
};

}  // namespace adit
