// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/hull.h"
#include "base/world.h"
#include "eval/picture.h"

namespace adit {

/// Where a drive ended early: the place from above at a slant, its roof taken off, the vehicle as it stands, the way that
/// it drove and the route that it should have gone on by, the cause below.
/// @param hull  the vehicle's boxes in B
/// @throws Error for a drive without a path
Picture trouble_picture(const World& world, const Drive& drive, const Hull& hull);

}  // namespace adit
