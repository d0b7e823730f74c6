// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/rig_text.h"
#include "eval/sight.h"

#include <cstddef>
#include <vector>

namespace adit {

/// What a placement may take. Infinite: no limit.
struct Budget {
  double price = std::numeric_limits<double>::infinity(), mass_kg = std::numeric_limits<double>::infinity();
};

/// A laser at a place where it could be mounted.
struct Candidate {
  MountText mount;
  double price = 0, mass_kg = 0;
};

/// Points on the boxes of a vehicle's hull, its pusher excepted, spacing_m apart and clearance_m out of the box, at which
/// no other box is nearer than clearance_m; faces that look down are left out.
std::vector<Vec3> hull_points(const Hull& hull, double spacing_m, double clearance_m);

/// The distance between a point and the nearest box, 0 inside.
double clearance_of(const Hull& hull, const Vec3& p_B);

/// Some of the candidates and how well they see together.
struct Placement {
  std::vector<size_t> candidate;  // rising
  FastScore score;                // with directions for those that `search` returns
};

struct Search {
  std::vector<Placement> scored;  // every set of the full number that was looked at, best first; ties by number
  bool guarantee = false;  // the greedy one is within 1 - 1/e of the best: every laser counts, and no budget and no
                           // clearance took part
  size_t looked_at = 0;    // sets of any number
};

/// The k candidates that see best beside lasers that are there in any case: greedily one by one, then by exchanges of
/// one for another as long as that helps. The value is monotone and submodular, so that greed alone reaches at least
/// 1 - 1/e of what the best set adds (Nemhauser, Wolsey and Fisher, Mathematical Programming 14, 1978) as long as
/// nothing but k limits the choice.
/// @param apart_m  least distance of two mirrors
/// @throws Error where no set of k fits the budget
Search search(const Course& course, const std::vector<Candidate>& candidates, const std::vector<Sight>& sights,
              const std::vector<Sight>& fixed, size_t k, const Budget& budget, double apart_m);

}  // namespace adit
