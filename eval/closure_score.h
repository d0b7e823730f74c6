// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/estimate.h"
#include "base/world.h"
#include "eval/metric_list.h"
#include "eval/passage_map.h"
#include "eval/path_error.h"
#include "rays/caster.h"

#include <string>
#include <vector>

namespace adit {

/// Judges the closures of an estimate by the true poses of their scans.
/// A closure with a measured pose is right within closure_m and closure_deg of the true relative pose, in the plane of
/// the first body. One that asserts a place is right where the true poses lie within place_m of each other and their
/// headings differ from the asserted turn (0 or 180 deg) by no more than place_deg.
///   accepted, wrong, precision (right / accepted), ambiguous;
///   recall: the true path is sampled every metre; a sample is revisited if an earlier one, more than revisit_m back
///     along the path, lies within place_m in plain sight, parallel or opposite within place_deg; it is found if a right
///     accepted closure ends within 5 m of it along the path;
///   loops_true: independent cycles of the passages that the path really drove round: each pair of samples that
///     revisits a place, in any heading, makes a cycle, written as how often each passage is followed; the rank of all;
///   loops_closed: the same rank over the pairs that the map lays within loop_m of their true relative position;
///   loops_by_closure: the same rank over the right accepted closures.
/// @param p_BL  the mapping laser's place in the body, from which plain sight is judged
void add_closures(const MetricList& list, const PassageMap& passages, const Caster& caster, const PathMatch& match,
                  const std::vector<Closure>& closures, const Vec3& p_BL, const ScoreSettings& settings,
                  const std::string& why);

}  // namespace adit
