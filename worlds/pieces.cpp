// SPDX-License-Identifier: BSD-3-Clause
#include "worlds/pieces.h"

namespace adit {

std::pair<std::vector<MineObject>, std::vector<NumberedFall>> pieces_of(const std::vector<Fall>& falls) {
  std::pair<std::vector<MineObject>, std::vector<NumberedFall>> out;
  auto& [objects, numbered] = out;
  for (const Fall& f : falls) {
    const auto add = [&](Label label, bool blocks) {
      objects.push_back({label, f.passage, {f.middle.x(), f.middle.y(), 0}, Vec3::Zero(), 0, 0, true, blocks});
      return static_cast<int>(objects.size()) - 1;
    };
    const int rubble = f.heap_m > 0 ? add(Label::rubble, true) : -1;
    numbered.push_back({f, rubble, add(f.hollow(), false)});
  }
  return out;
}

std::vector<NumberedFall> falls_in(const std::vector<NumberedFall>& falls, const Frame2& frame) {
  std::vector<NumberedFall> near;
  for (const NumberedFall& n : falls)
    if (frame.meets({n.fall.middle, n.fall.middle}, n.fall.reach_m() + 1)) near.push_back(n);
  return near;
}

void grow(MineObject& object, const Shell::Piece& more) {
  Vec3 low = more.low, high = more.high;
  if (object.size_m.x() > 0) {  // some of it lies elsewhere
    low = low.cwiseMin(object.middle_W - 0.5 * object.size_m);
    high = high.cwiseMax(object.middle_W + 0.5 * object.size_m);
  }
  object.middle_W = 0.5 * (low + high);
  object.size_m = high - low;
  object.volume_m3 += more.volume_m3;
}

}  // namespace adit
