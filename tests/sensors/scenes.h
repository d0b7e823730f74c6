// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/drive.h"
#include "base/rig.h"
#include "sensors/sensors.h"

#include <functional>

namespace adit {

/// A drive whose pose is known in closed form, at 120 Hz from 0 to duration_s.
Drive drive_of(double duration_s, const std::function<Pose(double t_s)>& X_WB);

/// One laser called "laser", of a bundled model at 500 kBd.
Rig one_laser(const std::string& model, const Pose& X_BS);

/// Every effect switched off: what geometry alone does.
SensorSettings exact();

}  // namespace adit
