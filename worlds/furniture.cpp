// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/furniture.h"

#include "base/rng.h"
#include "worlds/furnisher.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double junction_m = 1.5;  // kept clear about a junction beyond half its width
// Of a dead end, where routes turn round (route_line.cpp), and the lane there: an arc of 1.75 m and 0.75 m beside it.
constexpr double turn_m = 8, turn_lane_m = 5;

// Things that were there when the roof came down.
bool stood_before(Label label) {
  return label >= Label::post && label <= Label::cable && label != Label::stopping && label != Label::door;
}

}  // namespace

Way::Way(const Drift& d, double clear_a_m, double clear_b_m) : line_(d.line), from_m(clear_a_m) {
  at_.push_back(0.0);
  for (size_t i = 1; i < line_.size(); ++i) at_.push_back(at_.back() + (line_[i] - line_[i - 1]).norm());
  to_m = at_.back() - clear_b_m;
}

Spot Way::at(double s) const {
  const auto next = std::upper_bound(at_.begin(), at_.end(), s);
  const size_t k = std::clamp<size_t>(static_cast<size_t>(next - at_.begin()), 1, line_.size() - 1);
  const double t = std::clamp((s - at_[k - 1]) / (at_[k] - at_[k - 1]), 0.0, 1.0);
  const size_t a = k >= 2 ? k - 2 : 0, b = std::min(k + 1, line_.size() - 1);
  return {line_[k - 1] + t * (line_[k] - line_[k - 1]), (line_[b] - line_[a]).normalized()};
}

double yaw_of(const Vec2& v) {
  return std::atan2(v.y(), v.x());
}

Furnisher::Furnisher(const FurniturePlan& plan, Space& space)
    : plan_(plan), s_(plan.settings.furniture), space_(space), degree_(plan.plan.nodes.size(), 0) {
  for (const PlanPassage& p : plan.plan.passages) ++degree_[p.a], ++degree_[p.b];
  widest_.assign(degree_.size(), 0.0);
  for (const PlanPassage& p : plan.plan.passages)
    for (int n : {p.a, p.b}) widest_[n] = std::max(widest_[n], p.width_m);
}

Asked Furnisher::furnish(const std::vector<size_t>& passages) {
  for (size_t p : passages) {
    passage_ = p;
    const Way way = way_of(p);
    for (const Blocker& b : plan_.decay.blockers)
      if (b.passage == p) add_blocker(b, way);
    if (way.to_m - way.from_m < 2) continue;
    if (has(posts, s_.post_share))
      add_posts(way);
    else if (has(crossbars, s_.crossbar_share / std::max(1e-9, 1 - s_.post_share)))
      add_crossbars(way);
    add_cribs(way);
    add_blocks(way);
  }
  add_stones();
  for (size_t p : passages) {  // water keeps off what stands in it; track under water is not seen, and left out
    passage_ = p;
    add_pools(way_of(p));
  }
  for (size_t p : passages) {
    passage_ = p;
    const Way way = way_of(p);
    if (way.to_m - way.from_m < 2) continue;
    if (has(track, s_.track_share)) add_track(way);
    if (has(belts, s_.belt_share)) add_belt(way);
    if (has(bolts, s_.bolt_share)) add_bolts(way);
    if (has(pipes, s_.pipe_share)) add_line(way, pipes);
    if (has(cables, s_.cable_share)) add_line(way, cables);
  }
  return std::move(asked_);
}

double Furnisher::lot(What what, std::uint64_t k) const {
  return uniform(plan_.seed, Draw::world_furniture, static_cast<std::uint64_t>(what) << 40 | passage_, k);
}

// How many of a density stand here: the whole part, and one more by chance.
int Furnisher::count(What what, double per_100m, const Way& way) const {
  const double expected = std::max(0.0, per_100m) * way.length_m() / 100;
  return static_cast<int>(expected + lot(what, 0));
}

Way Furnisher::way_of(size_t p) const {
  const PlanPassage& passage = plan_.plan.passages[p];
  const auto clear = [&](int node) { return degree_[node] > 1 ? 0.5 * widest_[node] + junction_m : 0.3; };
  Way way{plan_.drifts[p], clear(passage.a), clear(passage.b)};
  way.turn_a_m = degree_[passage.a] > 1 ? 0 : turn_m;
  way.turn_b_m = degree_[passage.b] > 1 ? 0 : turn_m;
  return way;
}

// From the centre line to what may stand beside it.
double Furnisher::lane(const Way& way, double s) const {
  return way.turns(s) ? std::max(lane(), 0.5 * turn_lane_m) : lane();
}

bool Furnisher::put(Label label, Bodies bodies, double yaw, bool blocks) {
  if (stood_before(label))
    for (const Solid& body : bodies)
      for (const Vec3& v : body.vertex)
        for (const Fall& fall : plan_.decay.falls)
          if (fall.buried(v.head<2>())) return false;
  return space_.put(label, static_cast<int>(passage_), std::move(bodies), yaw, blocks);
}

void Furnisher::add_blocker(const Blocker& b, const Way& way) {
  const double s = b.share * way.length_m();
  const Spot spot = way.at(s);
  if (b.label == Label::stopping) add_stopping(spot);
  if (b.label == Label::car) add_car(way, s);
  if (b.label == Label::beam) add_beam(spot);
}

void Furnisher::add_stopping(const Spot& spot) {
  ask(Label::stopping);
  const double door = lot(stones, 1, -0.5, 0.5);
  constexpr double spalled_m = 1.5;  // and wandered: what is further off is no rib of this passage
  const double widest = 0.5 * plan_.plan.passages[passage_].width_m + spalled_m;
  for (double rib_gap : {0.006, 0.02, 0.05, 0.1}) {
    StoppingBodies bodies = stopping(space_, spot, door, rib_gap, widest);
    if (bodies.wall.empty()) continue;
    if (!put(Label::stopping, std::move(bodies.wall), yaw_of(spot.left()), true)) continue;
    put(Label::door, std::move(bodies.door), yaw_of(spot.left()));
    return;
  }
}

Asked furnish(const FurniturePlan& plan, const std::vector<size_t>& passages, Space& space) {
  return Furnisher(plan, space).furnish(passages);
}

}  // namespace adit
