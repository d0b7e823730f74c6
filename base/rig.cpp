// SPDX-License-Identifier: BSD-3-Clause
#include "base/rig.h"

#include "base/config.h"
#include "base/error.h"

#include <cmath>
#include <numbers>

namespace adit {

double Tilt::at(double since_s) const {
  // A triangle of two slopes with its middle at 0: the way from 0 to `to`, to `from` and back is 2 (to - from) long.
  const double way = 2 * (to_rad - from_rad), done = std::fmod(since_s / period_s, 1.0) * way;
  if (done < to_rad) return done;
  if (done < 2 * to_rad - from_rad) return 2 * to_rad - done;
  return done - way;
}

Pose Mount::X_BS_at(double tilt_rad) const {
  return tilt_rad == 0 ? X_BS : X_BS * pose_of(Vec3::Zero(), 0, tilt_rad);
}

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

namespace {

constexpr double deg = std::numbers::pi / 180;

// What a rig's file says of a mount that nods.
struct TiltWords {
  std::vector<double> tilt_deg;
  double tilt_s = 10;
  std::string tilt_when = "standing";
};

Tilt tilt_of(const Document& table, const TiltWords& words) {
  if (words.tilt_deg.empty()) return {};
  const std::vector<double>& ends = words.tilt_deg;
  if (ends.size() != 2 || !(ends[0] <= 0 && ends[1] >= 0 && ends[0] < ends[1]) || ends[0] < -90 || ends[1] > 90)
    table.fail("tilt_deg", "must be [from, to] with -90 <= from <= 0 <= to <= 90, from < to; positive looks down");
  return {ends[0] * deg, ends[1] * deg, words.tilt_s, words.tilt_when == "standing"};
}

}  // namespace

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
    TiltWords tilt;
    table.read({{"name", &mount.name, "unique in the rig"},
                {"model", &model, "a bundled laser or a file"},
                {"mode", &own.mode, "range mode of the model"},
                {"raster", &own.raster, "sector and step of the model"},
                {"position_m", &position_m, "x, y, z of the mirror in the body frame"},
                {"yaw_deg", &yaw_deg, "turn about z, first", -360, 360},
                {"pitch_deg", &pitch_deg, "then about y; positive looks down", -360, 360},
                {"roll_deg", &roll_deg, "then about x", -360, 360},
                {"tilt_deg", &tilt.tilt_deg, "the mount nods between these two, positive down"},
                {"tilt_s", &tilt.tilt_s, "there and back", 0.1, 1000},
                {"tilt_when", &tilt.tilt_when, "while it nods, or at all times", {"standing", "always"}}});
    if (mount.name.empty()) table.fail("name", "is missing: every laser of a rig needs one");
    for (const Mount& other : rig.mounts)
      if (other.name == mount.name) table.fail("name", "is '" + mount.name + "' a second time in this rig");
    if (position_m.size() != 3) table.fail("position_m", "must be three numbers, [x, y, z]");
    if (!choice.mode.empty()) own.mode = choice.mode;
    if (!choice.raster.empty()) own.raster = choice.raster;
    mount.laser = load_laser(model, baud, own);
    mount.X_BS = pose_of({position_m[0], position_m[1], position_m[2]}, yaw_deg * deg, pitch_deg * deg, roll_deg * deg);
    mount.tilt = tilt_of(table, tilt);
    rig.mounts.push_back(std::move(mount));
  }
  if (rig.mounts.empty()) throw Error(file.name() + ": no [[laser]] in this rig; it needs one at least");
  return rig;
}

}  // namespace adit
