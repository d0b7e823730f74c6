// SPDX-License-Identifier: BSD-3-Clause
#include "cli/rig_command.h"

#include "cli/scenario.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <utility>

namespace adit {
namespace {

// A passage of Bruceton's middle size, straight, its ends closed.
World plain_passage() {
  constexpr double length = 9, half = 3.7 / 2, height = 1.9;
  World world;
  world.name = "passage";
  Mesh& m = world.mesh;
  for (int k = 0; k < 8; ++k) m.vertex.emplace_back(k & 1 ? length : 0, k & 2 ? half : -half, k & 4 ? height : 0);
  m.face = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
            {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  for (const Label label : {Label::floor, Label::roof, Label::rib, Label::rib, Label::cap, Label::cap})
    m.label.insert(m.label.end(), 2, label);
  return world;
}

Drive stand_at(const Pose& X_WB) {
  Drive drive;
  for (int i = 0; i < 60; ++i) {
    drive.path.stamp_s.push_back(0.05 * i);
    drive.path.X_WB.push_back(X_WB);
  }
  return drive;
}

}  // namespace

RigPictures::RigPictures(const Rig& rig, const Vehicle& vehicle, SensorSettings settings)
    : world_(plain_passage()), rig_(rig), hull_(vehicle.hull), X_WB_(pose_of({3.2, 0, 0}, 0)) {
  settings.noise = settings.bias = settings.detection = false;
  settings.beam_angle_deg = settings.drop_out = 0;
  settings.faults.clear();
  const Recording stand = record(world_, stand_at(X_WB_), rig, hull_, settings, 1);
  for (size_t i = 0; i < rig.mounts.size(); ++i) {
    const Mount& mount = stand.truth.rig.mounts[i];
    std::vector<Vec3> ends;
    for (int k = 0; k < mount.laser.beams; ++k) {
      const double a = mount.laser.beam_angle_rad(k), r = stand.truth.scans[i].range_m[static_cast<size_t>(k)];
      ends.push_back(X_WB_ * mount.X_BS * Vec3(r * std::cos(a), r * std::sin(a), 0));
    }
    ends_W_.push_back(std::move(ends));
  }
}

Picture RigPictures::from(RigView view) const {
  return rig_picture({world_.mesh, rig_, hull_, X_WB_, ends_W_}, view);
}

int rig_command(const std::string& name, const Common& common, Console& console) {
  Scenario s;
  s.sensors.rig = name;
  s.sensors.baud = 0;
  for (const std::string& a : common.assignments) set_field(fields(s), a);
  const Rig rig = load_rig(s.sensors);
  const RigPictures shown(rig, load_vehicle(s.vehicle), s.sensors);
  const std::string dir = common.out.empty() ? "out/" + rig.name : common.out;
  nlohmann::ordered_json pictures = nlohmann::ordered_json::array();
  for (const auto& [view, file] : {std::pair{RigView::corner, "corner.png"},
                                   {RigView::side, "side.png"},
                                   {RigView::front, "front.png"},
                                   {RigView::above, "above.png"}}) {
    write_png(dir + "/" + file, shown.from(view));
    console.result("picture: " + dir + "/" + file);
    pictures.push_back(dir + "/" + file);
  }
  console.json(nlohmann::ordered_json{{"rig", rig.name}, {"pictures", pictures}}.dump());
  return 0;
}

}  // namespace adit
