// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/dexels.h"
#include "base/mesh.h"
#include "base/progress.h"
#include "eval/metric_list.h"
#include "eval/observable.h"
#include "eval/passage_map.h"
#include "eval/true_scans.h"

#include <optional>
#include <string>
#include <vector>

namespace adit {

/// The part of space in which the volume of a map is judged, as columns of one grid:
///   swept  void that the noise-free fans of the rig cross between consecutive true scans
///   rock   rock within domain_rock_m of the observable surface: without it no over-claim could be seen
struct VolumeDomain {
  Dexels swept, rock;
  Dexels space = {};  // all of the void; empty: not known beyond `swept`
};

/// Fans are spanned by every beam about domain_beam_deg apart; a cell between four ends is cut back to its nearest end
/// where the ends jump by more than half a metre, and left out where a beam met nothing within range or the scans lie
/// more than domain_step_m apart.
/// @param mesh  closed, else Error
VolumeDomain volume_domain(const Mesh& mesh, const Patches& patches, const Observable& observable,
                           const TrueScans& scans, const ScoreSettings& settings, const Progress& progress);

/// A passage's share of the domain.
struct PassageVolume {
  double observable_m3 = 0, mapped_m3 = 0;  // mapped: NaN without a mapped surface
};

/// true_m3 (all of the void), observable_m3 (void in the domain), and of the mapped void in the domain: mapped_m3,
/// error_percent (signed), overbreak_m3 (mapped rock), underbreak_m3 (void not mapped), iou; extrapolated_m3 (mapped
/// outside of the domain), unseen_void_m3 (what of it is void); claimed_m3, sigma_percent: what the mapper itself says; claim_sigmas: how many of its sigmas
/// its claim lies beside observable_m3 and unseen_void_m3 (signed); claim_holds_95: 1 within 1.96 of them, else 0.
/// @param domain  or none with `why`
/// @param mapped  boundary of the mapped void in W, closed; none with `why_unmapped`
/// @return (passages) the shares of the columns nearest to each passage's centre line; empty without a domain
std::vector<PassageVolume> add_volume(const MetricList& list, double true_m3, const std::optional<VolumeDomain>& domain,
                                      const std::string& why, const std::optional<Mesh>& mapped,
                                      const std::string& why_unmapped, std::optional<double> claimed_m3,
                                      std::optional<double> claimed_sigma_m3, const PassageMap& passages);

}  // namespace adit
