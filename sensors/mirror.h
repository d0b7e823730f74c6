// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "rays/caster.h"
#include "sensors/beam.h"

#include <optional>

namespace adit {

/// Share of unpolarised light that still water reflects (Fresnel, refractive index 1.33); cosine of the incidence.
double water_reflectance(double cosine);

/// Whether meshes of this program tell water apart, and as what.
std::optional<Label> water_label();

/// What a laser sees in a mirror of water: nothing of the surface itself beyond 15 degrees from its normal, but what the
/// mirrored ray meets, at the length of the whole way, dimmed by two reflections. Label, part and face stay the water's;
/// `met` is what the ray itself meets there. Nearer to the normal `met` as it is.
Meeting seen_in_water(const Caster& caster, const Ray& ray, const Meeting& met, double default_reflectivity);

}  // namespace adit
