// SPDX-License-Identifier: BSD-3-Clause
#include "base/rig.h"

#include "base/config.h"
#include "base/error.h"

#include <cmath>
#include <numbers>

namespace adit {

View view_of(const Mount& mount) {
  constexpr double straight = 0.9;  // cosine: within some 25 degrees of an axis
  const Vec3 normal = mount.X_BS.linear().col(2), ahead = mount.X_BS.linear().col(0);
  if (std::abs(normal.z()) > straight) return View::horizontal;
  if (std::abs(normal.y()) > straight && ahead.x() > straight) return View::forward_vertical;
  if (std::abs(normal.x()) > straight && ahead.z() > straight) return View::up;
  if (std::abs(normal.x()) > straight && ahead.z() < -straight) return View::down;
  return View::other;
}

int find_view(const Rig& rig, View view) {
  for (size_t i = 0; i < rig.mounts.size(); ++i)
    if (view_of(rig.mounts[i]) == view) return static_cast<int>(i);
  return -1;
}

Rig load_rig(const std::string& name_or_file, int baud, const LaserChoice& choice) {
  const Document file = Document::find("sensors/rigs", name_or_file);
  Rig rig;
  file.read({{"name", &rig.name, "how reports call it"}}, {"laser"});
  if (rig.name.empty()) rig.name = name_or_file;
  for (const Document& table : file.tables("laser")) {
    Mount mount;
    std::string model = "lms200";
    std::vector<double> position_m{0, 0, 0};
    double yaw_deg = 0, pitch_deg = 0, roll_deg = 0;
    LaserChoice own;
    table.read({{"name", &mount.name, "unique in the rig"},
                {"model", &model, "a bundled laser or a file"},
                {"mode", &own.mode, "range mode of the model"},
                {"raster", &own.raster, "sector and step of the model"},
                {"position_m", &position_m, "x, y, z of the mirror in the body frame"},
                {"yaw_deg", &yaw_deg, "turn about z, first", -360, 360},
                {"pitch_deg", &pitch_deg, "then about y; positive looks down", -360, 360},
                {"roll_deg", &roll_deg, "then about x", -360, 360}});
    if (mount.name.empty()) table.fail("name", "is missing: every laser of a rig needs one");
    for (const Mount& other : rig.mounts)
      if (other.name == mount.name) table.fail("name", "is '" + mount.name + "' a second time in this rig");
    if (position_m.size() != 3) table.fail("position_m", "must be three numbers, [x, y, z]");
    constexpr double deg = std::numbers::pi / 180;
    if (!choice.mode.empty()) own.mode = choice.mode;
    if (!choice.raster.empty()) own.raster = choice.raster;
    mount.laser = load_laser(model, baud, own);
    mount.X_BS = pose_of({position_m[0], position_m[1], position_m[2]}, yaw_deg * deg, pitch_deg * deg, roll_deg * deg);
    rig.mounts.push_back(std::move(mount));
  }
  if (rig.mounts.empty()) throw Error(file.name() + ": no [[laser]] in this rig; it needs one at least");
  return rig;
}

}  // namespace adit
