// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.h"
#include "base/rng.h"
#include "worlds/entry_set.h"

#include <algorithm>
#include <cmath>

namespace adit {
namespace {

constexpr double least_pillar_m = 2.6;
enum Address : std::uint64_t { butt_step = 30, room_step, depth_drawn, width_drawn, through_step, through_drawn };

std::string metres(double v) {
  const std::string text = std::to_string(v);
  return text.substr(0, text.find('.') + 3) + " m";
}

void check_rooms(const RoomSettings& s) {
  const double room = s.spacing_m - 4 * s.spacing_sd_m - 2 * s.width_sd_m;
  if (s.width_m + least_pillar_m > room)
    throw Error("world.rooms.width_m = " + metres(s.width_m) + ": rooms must leave pillars of " +
                metres(least_pillar_m) + "; with spacing_m, spacing_sd_m and width_sd_m as they are, at most " +
                metres(room - least_pillar_m) + " wide");
  if (s.butt_width_m + least_pillar_m > s.butt_spacing_m)
    throw Error("world.rooms.butt_width_m = " + metres(s.butt_width_m) + ": at most " +
                metres(s.butt_spacing_m - least_pillar_m) + " between butts of butt_spacing_m");
  if (s.depth_m < s.neck_m + s.width_m + 4)
    throw Error("world.rooms.depth_m = " + metres(s.depth_m) +
                ": at least neck_m + width_m + 4 m = " + metres(s.neck_m + s.width_m + 4));
}

struct Room {
  double x, depth_m, width_m;
  std::vector<EntrySet::Mark> marks;
};

// Rooms on one side of a butt, driven to the side `up`; neighbours are joined by breakthroughs at heights of their own.
class Side {
 public:
  Side(MinePlan& plan, const RoomSettings& s, EntrySet& butts, int up, std::uint64_t seed)
      : plan_(plan), s_(s), seed_(seed), up_(up), which_(up > 0 ? 1000000 : 0) {
    const size_t butt = up > 0 ? butts.offset_m.size() - 1 : 0;
    const std::vector<double> x = scattered(s.rooms, s.spacing_m, s.spacing_sd_m, seed, room_step + 10 * (up > 0));
    y0_ = butts.offset_m[butt];
    for (int k = 0; k < s.rooms; ++k) add_room(butts, butt, x[k] + 0.5 * s.spacing_m, k);
  }

  void drive() {
    for (size_t k = 0; k + 1 < rooms_.size(); ++k) add_breakthroughs(k);
    for (Room& room : rooms_) {
      std::sort(room.marks.begin(), room.marks.end(), [](const auto& a, const auto& b) { return a.s_m < b.s_m; });
      join(plan_, room.marks[0].node, room.marks[1].node, s_.neck_width_m);
      for (size_t i = 2; i < room.marks.size(); ++i)
        join(plan_, room.marks[i - 1].node, room.marks[i].node, room.width_m);
    }
  }

 private:
  Vec2 at(const Room& room, double s) const { return {room.x, y0_ + up_ * s}; }

  void add_room(EntrySet& butts, size_t butt, double x, int k) {
    const std::uint64_t which = which_ + k;
    const double depth =
        s_.depth_m + s_.depth_sd_m * std::clamp(normal(seed_, Draw::world_layout, depth_drawn, which), -2.0, 2.0);
    const double width =
        s_.width_m + s_.width_sd_m * std::clamp(normal(seed_, Draw::world_layout, width_drawn, which), -2.0, 2.0);
    Room room{x, std::max(depth, s_.neck_m + s_.width_m + 4), std::max(width, 1.5), {}};
    const int mouth = node_at(plan_, butts, butt, x);
    room.x = plan_.nodes[mouth].x();
    room.marks = {{0, mouth},
                  {s_.neck_m, add_node(plan_, at(room, s_.neck_m))},
                  {room.depth_m, add_node(plan_, at(room, room.depth_m))}};
    rooms_.push_back(std::move(room));
  }

  int mark(Room& room, double s) {
    for (const EntrySet::Mark& m : room.marks)
      if (std::abs(m.s_m - s) < 0.5 * s_.through_width_m) return m.node;
    room.marks.push_back({s, add_node(plan_, at(room, s))});
    return room.marks.back().node;
  }

  void add_breakthroughs(size_t k) {
    Room &a = rooms_[k], &b = rooms_[k + 1];
    const double reach = std::min(a.depth_m, b.depth_m) - 0.5 * s_.through_width_m;
    double s =
        s_.neck_m + s_.through_spacing_m * (0.3 + 0.6 * uniform(seed_, Draw::world_layout, through_step, which_ + k));
    for (int n = 0; s < reach; ++n, s += s_.through_spacing_m) {
      if (uniform(seed_, Draw::world_layout, through_drawn, 1000 * (which_ + k) + n) >= s_.through_share) continue;
      const int from = mark(a, s), to = mark(b, s);
      join(plan_, from, to, s_.through_width_m);
    }
  }

  MinePlan& plan_;
  const RoomSettings& s_;
  std::uint64_t seed_;
  int up_;
  std::uint64_t which_;
  double y0_ = 0;
  std::vector<Room> rooms_;
};

}  // namespace

MinePlan rooms_plan(const RoomSettings& s, std::uint64_t seed) {
  check_rooms(s);
  MinePlan plan;
  std::vector<double> offset;
  for (int b = 0; b < s.butts; ++b) offset.push_back(b * s.butt_spacing_m);
  EntrySet butts = entry_set({0, 0}, {1, 0}, s.butt_width_m, offset);
  const double length = s.rooms * s.spacing_m;
  const int crosscuts = std::max(2, 1 + static_cast<int>(length / s.butt_crosscut_m));
  for (int b = 0; b + 1 < s.butts; ++b) {
    for (int k = 0; k < crosscuts; ++k) {
      const double x = length * k / (crosscuts - 1);
      join(plan, node_at(plan, butts, b, x), node_at(plan, butts, b + 1, x), s.butt_width_m);
    }
  }
  Side below(plan, s, butts, -1, seed);
  below.drive();
  if (s.both_sides) {
    Side above(plan, s, butts, 1, seed);
    above.drive();
  }
  for (int b = 0; b < s.butts; ++b) {  // one butt runs on to daylight, another is a dead end
    node_at(plan, butts, b, -s.butt_crosscut_m / 2);
  }
  drive_entries(plan, butts);
  return plan;
}

}  // namespace adit
